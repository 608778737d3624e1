"""The penalty method: its error, the cure, and what too large a factor costs."""

from __future__ import annotations

import numpy as np
import pytest

from solver.contact.laws import LinearHertz
from solver.errors import InputError
from solver.methods.integrate import make_method
from solver.methods.penalty import default_penalty
from tests.solver.methods_case import (
    crossing,
    difference,
    histories,
    sprung_wheels,
    steps,
    two_springs,
)


@pytest.mark.parametrize("solution", ["refactorise", "update"])
def test_two_springs_with_a_penalty_are_three_springs(solution: str) -> None:
    """Closed form: the penalty in series; X = -60 kN less p / (p + k k' / (k + k'))."""
    stiff, soft, penalty = 8e7, 2e7, 1e9
    # Equal loads: apart, the ends would move F / k; X closes the difference over all springs.
    force = -(100e3 / soft - 100e3 / stiff) / (1.0 / stiff + 1.0 / soft + 1.0 / penalty)
    _, forces, _ = histories(
        two_springs(stiff, soft), steps(1), "penalty", penalty=penalty, solution=solution
    )
    assert forces[-1] == pytest.approx([force], rel=1e-10)
    assert force == pytest.approx(-60e3, rel=0.02)


@pytest.mark.parametrize("unsprung", [0.0, 1000.0])
def test_the_error_falls_as_one_over_the_penalty(unsprung: float) -> None:
    problem, settings = crossing(*sprung_wheels(2, unsprung=unsprung)), steps(300)
    _, reference, _ = histories(problem, settings)
    penalties = np.array([1e12, 1e13, 1e14]) if unsprung else np.array([1e10, 1e11, 1e12])
    errors = [
        difference(
            histories(problem, settings, "penalty", penalty=p, solution="update")[1], reference
        )
        for p in penalties
    ]
    order = -np.polyfit(np.log(penalties), np.log(errors), 1)[0]
    # Exactly 1 as the penalty grows; the smallest one is still 1 percent away from that.
    assert order == pytest.approx(1.0, abs=0.03)


def test_refactorising_loses_what_updating_keeps() -> None:
    """Rounding grows with the penalty in the matrix itself, not in the flexibility."""
    problem, settings = crossing(*sprung_wheels(2)), steps(200)
    _, reference, _ = histories(problem, settings)
    error = {
        (solution, factor): difference(
            histories(problem, settings, "penalty", factor=factor, solution=solution)[1],
            reference,
        )
        for solution in ("refactorise", "update")
        for factor in (1e4, 1e8)
    }
    assert error["update", 1e4] < 1e-7
    assert error["update", 1e8] < 1e-7
    assert error["refactorise", 1e4] < 1e-5
    assert error["refactorise", 1e8] > 100.0 * error["refactorise", 1e4]


def test_the_default_is_far_above_the_stiffness_and_far_below_rounding() -> None:
    for unsprung in (0.0, 1800.0):
        problem, settings = crossing(*sprung_wheels(2, unsprung=unsprung)), steps(300)
        _, reference, _ = histories(problem, settings)
        _, forces, _ = histories(problem, settings, "penalty")
        assert difference(forces, reference) < 1e-4


def test_the_default_follows_the_stiffest_freedom_at_the_contact() -> None:
    problem, settings = crossing(*sprung_wheels(1, unsprung=1e5)), steps(1)
    run = make_method(problem, settings, "penalty")
    inertia = settings.method.a0 * 1e5
    penalty = default_penalty(run.stacked, run.borders, settings.method, 10.0)
    # The wheel's spring and dashpot add less than a thousandth to its inertia.
    assert penalty == pytest.approx(10.0 * inertia, rel=1e-3)


def test_a_hertz_spring_is_its_own_penalty() -> None:
    """Nothing is approximated then: only rounding differs from the direct method."""
    problem = crossing(*sprung_wheels(2, unsprung=1000.0), law=LinearHertz(stiffness=1.2e9))
    settings = steps(300)
    _, reference, _ = histories(problem, settings)
    for solution in ("refactorise", "update"):
        _, forces, _ = histories(problem, settings, "penalty", solution=solution)
        assert difference(forces, reference) < 1e-8


def test_a_penalty_beside_a_hertz_spring_is_refused() -> None:
    problem = crossing(*sprung_wheels(2, unsprung=1000.0), law=LinearHertz(stiffness=1.2e9))
    with pytest.raises(InputError, match="brings its own stiffness"):
        histories(problem, steps(10), "penalty", penalty=1e5)
