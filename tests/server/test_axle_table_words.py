"""Tables of axles in reports and in the library: what was not given is no number."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from server.library.parts import read_part
from server.reports.basis import data_section
from server.reports.inputs import inputs
from server.reports.material import Material
from server.reports.words import shown
from solver import studies
from solver.models.hslm import hslm_a
from solver.models.train import Axle, AxleTable


@pytest.mark.parametrize("count", [2, 50])
def test_a_report_tells_what_an_axle_s_suspension_follows_from(count: int) -> None:
    """Of few rows each cell is read, of many the column."""
    axles = tuple(Axle(position=3.0 * row, load=170e3) for row in range(count))
    study = replace(studies.template("khst-alverca").study, train=AxleTable(axles=axles))
    texts = {
        at: shown(item.value, item.unit, at)
        for at, item in inputs(study).items()
        if at.startswith("/train/axles")
    }
    assert len(texts) == (5 if count > 4 else 5 * count)
    stiffness = {text for at, text in texts.items() if at.endswith("/stiffness")}
    assert stiffness == {"follows from the bounce frequency"}
    damping = {text for at, text in texts.items() if at.endswith("/damping")}
    assert damping == {"follows from the damping ratio"}


@pytest.mark.parametrize("missing", ["position", "load"])
def test_a_row_without_place_or_load_is_refused(missing: str) -> None:
    """A load that somebody forgot must not become one of 170 kN."""
    rows = [{"position": 3.0 * row, "load": 170e3} for row in range(4)]
    assert read_part("trains", {"type": "axle_table", "axles": rows})[1] == []
    del rows[2][missing]
    value, (wrong,) = read_part("trains", {"type": "axle_table", "axles": rows}, ("value",))
    assert value == {}
    assert wrong.pointer == f"/value/axles/2/{missing}"
    assert "missing" in wrong.reason, wrong


def remarks_on(train: AxleTable) -> list[Any]:
    """What a report says of the train's single figures."""
    study = replace(studies.template("khst-alverca").study, train=train)
    material = SimpleNamespace(study=study, modal=False, deciding=SimpleNamespace(facts={}))
    blocks: list[Any] = list(data_section(cast(Material, material)).blocks)
    rows = [row for block in blocks for row in getattr(block, "rows", ())]
    return [
        row for row in rows if row[0] == "Train" and row[1] in ("bounce frequency", "damping ratio")
    ]


def test_remarks_on_universal_trains_are_not_said_of_other_tables() -> None:
    own = AxleTable(axles=(Axle(position=0.0, load=170e3),), bounce_frequency=0.1)
    assert remarks_on(own) == []
    train = hslm_a("A2")
    shorter = replace(train, axles=train.axles[:10])
    for known in (train, shorter):
        assert [row[2] for row in remarks_on(known)] == ["assumed", "assumed"]
