"""Package data: every file says where it comes from, and no name reaches outside the package."""

from __future__ import annotations

import pytest

from solver.data import available, load
from solver.errors import InputError
from solver.models.train import build_train, khst


def test_every_file_states_source_and_confidence() -> None:
    assert {"khst", "rail_60E1", "standards"} <= set(available())
    for name in available():
        data = load(name)
        assert data["title"]
        entries = [data] if "source" in data else [v for v in data.values() if "clause" in v]
        assert entries
        for entry in entries:
            assert entry["source"], name
            assert entry["confidence"], name


@pytest.mark.parametrize("name", ["../errors", "khst.json", "", "__init__"])
def test_unknown_names_are_refused(name: str) -> None:
    with pytest.raises(InputError):
        load(name)


def test_stated_checks_hold() -> None:
    checks, train = load("khst")["checks"], build_train(khst())
    assert len(train.axle_offsets) == checks["axles"]
    assert train.total_mass == pytest.approx(checks["total_mass"])
    assert train.length == pytest.approx(checks["first_to_last_axle"])
