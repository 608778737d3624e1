"""Where MKL is not to be had, SuperLU takes over: slower, same numbers, and it says so."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from solver.factorisation import sparse as back_ends
from solver.studies import Study, check, prepare, template


def forces(study: Study) -> np.ndarray:
    simulation = prepare(study)
    for _ in islice(simulation.samples(), 20):
        pass
    return simulation.effective.state.contact_forces


def test_superlu_gives_the_same_contact_forces(
    small_study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = forces(small_study)
    monkeypatch.setattr(back_ends, "_pardiso", lambda: None)
    # Two factorisations of one matrix: rounding only.
    np.testing.assert_allclose(forces(small_study), wanted, rtol=1e-8)


def test_standard_mesh_warns_and_offers_the_coarse_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(back_ends, "_pardiso", lambda: None)
    (warning,) = check(template("khst-alverca-standard").study).warnings
    assert warning.path == ("mesh_level",)
    assert "SuperLU" in warning.reason
    assert "coarse" in warning.remedy
