"""Condensation of the vehicle at the element level."""

from __future__ import annotations

import numpy as np
import pytest

from solver.methods.integrate import make_method
from solver.methods.partitioned import CondensedVehicle, EffectiveParts
from tests.solver.methods_case import (
    crossing,
    histories,
    pitching_car,
    sprung_wheels,
    steps,
    two_springs,
)


def test_two_springs_in_one_solution() -> None:
    for pair in ((8e7, 2e7), (2e7, 8e7)):
        displacement, forces, iterations = histories(two_springs(*pair), steps(1), "condensation")
        assert displacement[-1] == pytest.approx([2e-3, 2e-3], rel=1e-12)
        assert abs(forces[-1, 0]) == pytest.approx(60e3, rel=1e-12)
        assert iterations.tolist() == [1]


def condensed(problem: object) -> tuple[CondensedVehicle, EffectiveParts]:
    run = make_method(problem, steps(1))  # type: ignore[arg-type]
    parts = EffectiveParts(run.stacked, run.settings.method)
    return CondensedVehicle(run.stacked, run.borders, parts), parts


def test_the_contact_stiffness_is_the_schur_complement_of_2_34() -> None:
    """(1 + alpha) S = K_XX - K_XI K_II^-1 K_IX where the wheels are freedoms of the vehicle."""
    vehicle, parts = condensed(crossing(*sprung_wheels(3, unsprung=800.0)))
    full = parts.vehicle_matrix.toarray()
    wheel, inner = np.arange(0, 6, 2), np.arange(1, 6, 2)
    complement = full[np.ix_(wheel, wheel)] - full[np.ix_(wheel, inner)] @ np.linalg.solve(
        full[np.ix_(inner, inner)], full[np.ix_(inner, wheel)]
    )
    assert parts.factor * vehicle.stiffness == pytest.approx(complement, rel=1e-10, abs=1e-3)


def test_only_wheels_of_one_vehicle_are_joined() -> None:
    """Else every element under the train would be coupled with every other."""
    separate = condensed(crossing(*sprung_wheels(3, unsprung=800.0)))[0].stiffness
    assert np.count_nonzero(separate - np.diag(separate.diagonal())) == 0
    joined = condensed(crossing(*pitching_car()))[0].stiffness
    assert abs(joined[0, 1]) > 1e-3 * joined[0, 0]


def test_the_bridge_is_factorised_at_every_step_without_the_vehicle() -> None:
    """The matrix has the structure's freedoms only; the vehicle's follow from the contact."""
    problem = crossing(*pitching_car())
    displacement, forces, _ = histories(problem, steps(200), "condensation")
    reference, direct, _ = histories(problem, steps(200))
    n_structure = problem.structure.n_dof
    ours, theirs = displacement[:, n_structure:], reference[:, n_structure:]
    # Rounding alone: 200 steps, each a factorisation of condition 1e5 or so.
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()
    assert np.abs(forces - direct).max() < 1e-7 * np.abs(direct).max()
