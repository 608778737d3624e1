"""The rails' compliance along a bay, and the approach track that continues it."""

from __future__ import annotations

import numpy as np
import pytest

from solver.errors import InputError
from solver.integrators import HHT
from solver.models.ballasted_track import TrackProperties
from solver.models.rails import ELEMENTS_PER_BAY, ApproachTrack
from solver.simulation import effective_coefficients
from solver.system.parts import Coefficients
from solver.system.track_compliance import (
    approach_deflections,
    matched_approach,
    track_deflections,
)

PLACES = (np.arange(16) + 0.5) / 16
STANDARD_STEP = 2.5e-4


@pytest.mark.parametrize(
    ("coefficients", "tolerance"),
    [
        (Coefficients.static(), 0.01),
        (effective_coefficients(HHT(-0.05, STANDARD_STEP)), 0.03),
    ],
    ids=["static", "effective"],
)
def test_compliance_along_a_bay_agrees_with_an_eightfold_mesh(
    coefficients: Coefficients, tolerance: float
) -> None:
    """One element a bay would reverse its variation (the modelling decisions' first trap)."""
    track = TrackProperties()
    found = track_deflections(track, "standard", PLACES, coefficients)
    fine = 8 * ELEMENTS_PER_BAY["standard"]
    wanted = track_deflections(track, "standard", PLACES, coefficients, fine)
    assert np.abs(found / wanted - 1.0).max() < tolerance


def test_a_bay_is_softest_in_its_middle() -> None:
    track, static = TrackProperties(), Coefficients.static()
    over, middle = track_deflections(track, "standard", np.array([0.0, 0.5]), static)
    assert middle > over


@pytest.mark.parametrize("level", ["coarse", "standard"])
def test_matched_approach_deflects_like_the_three_dimensional_track(level: str) -> None:
    track, static, middle = TrackProperties(), Coefficients.static(), np.array([0.5])
    approach = matched_approach(track, ApproachTrack(), level)
    found = approach_deflections(track, approach, level, middle, static)[0]
    assert found == pytest.approx(track_deflections(track, level, middle, static)[0], rel=0.02)


def test_a_track_that_no_bed_can_match_is_an_error() -> None:
    """Not the root finder's own complaint: the field, the deflection, what to do."""
    mud = TrackProperties(ballast_young_modulus=1e6, ballast_depth=2.0, sleeper_spacing=0.4)
    with pytest.raises(InputError, match=r"approach\.bed_stiffness .* deflects like .* nm/N"):
        matched_approach(mud, ApproachTrack(), "coarse")


def test_a_bed_stiffness_given_by_hand_is_kept() -> None:
    given = ApproachTrack(bed_stiffness=1.87e8)
    assert matched_approach(TrackProperties(), given, "coarse") is given
