"""Modal analysis of plain beams as plain JSON, against the closed form."""

from __future__ import annotations

import json
from dataclasses import replace
from math import pi, sqrt

import pytest

from solver.errors import InputError
from solver.models.beam_bridge import BeamBridge
from solver.studies import modal_analysis, template
from solver.studies.study import NoTrack

BEAM = template("sprung-mass-beam").study


def test_frequencies_and_damping_of_a_beam() -> None:
    """f_n = (n pi / L)^2 sqrt(EI / m) / 2 pi; zeta_n = a0 / (4 pi f_n) + a1 pi f_n."""
    bridge = BeamBridge(mass_damping=0.3, stiffness_damping=2e-4)
    found = modal_analysis(replace(BEAM, viaduct=bridge))
    json.dumps(found, allow_nan=False)
    scale = sqrt(bridge.young_modulus * bridge.second_moment / bridge.mass_per_length)
    for number in range(1, 5):
        mode = found["modes"][number - 1]
        wanted = (number * pi / 25.0) ** 2 * scale / (2.0 * pi)
        assert mode["number"] == number
        # 50 elements leave (4 pi / 50)^4 / 1440 = 3e-6 in the fourth mode.
        assert mode["frequency"] == pytest.approx(wanted, rel=5e-6)
        damping = 0.3 / (4.0 * pi * wanted) + 2e-4 * pi * wanted
        assert mode["damping"] == pytest.approx(damping, rel=1e-5)


def test_equal_spans_share_their_frequencies() -> None:
    found = modal_analysis(replace(BEAM, viaduct=BeamBridge(spans=(20.0, 20.0))))["modes"]
    assert found[0]["frequency"] == pytest.approx(found[1]["frequency"], rel=1e-9)
    assert found[2]["frequency"] == pytest.approx(4.0 * found[0]["frequency"], rel=1e-4)


def test_parts_that_do_not_fit_are_refused() -> None:
    study = template("khst-alverca").study
    with pytest.raises(InputError, match="ballasted"):
        modal_analysis(replace(study, track=NoTrack()))
