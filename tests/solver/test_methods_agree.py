"""All four methods solve the same equations: bilateral contact, one problem, four ways.

Tolerances: condensation differs from the direct method by rounding alone; the penalty of 1e4 times
the stiffest freedom leaves 1e-4 of the contact force or so; the iterative method stops at 1e-11
of the displacement, which a wheel with mass turns into up to 1e-5 of its force.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.arrays import Vector
from solver.contact.laws import LinearHertz, RigidContact
from solver.methods.integrate import integrate
from solver.methods.problem import Problem
from tests.solver.methods_case import (
    crossing,
    difference,
    histories,
    pitching_car,
    sprung_wheels,
    steps,
)

METHODS: list[tuple[str, dict[str, Any], float, float]] = [
    ("iterative", {"tolerance": 1e-11}, 1e-8, 1e-5),
    ("iterative", {"tolerance": 1e-11, "solution": "interface"}, 1e-8, 1e-5),
    ("iterative", {"tolerance": 1e-11, "acceleration": "aitken"}, 1e-8, 1e-5),
    ("iterative", {"tolerance": 1e-11, "relaxation": 0.7}, 1e-8, 1e-4),
    ("penalty", {}, 1e-6, 3e-4),
    ("penalty", {"solution": "update"}, 1e-6, 3e-4),
    ("condensation", {}, 1e-9, 1e-8),
]


@pytest.mark.parametrize(
    "law", [RigidContact(), LinearHertz(stiffness=1.2e9)], ids=["rigid", "k_h"]
)
@pytest.mark.parametrize("alpha", [0.0, -0.1])
@pytest.mark.parametrize("vehicle", ["one mass", "four masses", "four wheels with mass", "car"])
def test_all_methods_agree_with_the_direct_method(
    vehicle: str, alpha: float, law: RigidContact | LinearHertz
) -> None:
    """A crossing with irregular rail; displacements of structure and vehicle, contact forces."""
    parts = {
        "one mass": sprung_wheels(1),
        "four masses": sprung_wheels(4),
        "four wheels with mass": sprung_wheels(4, unsprung=500.0),
        "car": pitching_car(),
    }[vehicle]
    problem, settings = crossing(*parts, law=law), steps(100, 1e-3, alpha)
    reference, forces, _ = histories(problem, settings)
    assert np.ptp(forces) > 0.03 * np.abs(forces).max()
    for method, options, of_displacement, of_force in METHODS:
        ours, our_forces, _ = histories(problem, settings, method, **options)
        assert difference(ours, reference) < of_displacement, (method, options)
        assert difference(our_forces, forces) < of_force, (method, options)


def shaken(problem: Problem) -> Problem:
    """The same with the beam's supports moving up and down together."""
    amplitude, rate = 5e-3, 2.0 * np.pi * 3.0
    count = problem.structure.prescribed.size

    def motion(time: float) -> tuple[Vector, Vector, Vector]:
        phase = rate * time
        return (
            np.full(count, amplitude * (1.0 - np.cos(phase))),
            np.full(count, amplitude * rate * np.sin(phase)),
            np.full(count, amplitude * rate**2 * np.cos(phase)),
        )

    return replace(problem, structure=replace(problem.structure, support_motion=motion))


@pytest.mark.parametrize(("method", "options", "of_displacement", "of_force"), METHODS)
def test_moving_supports_enter_every_method_alike(
    method: str, options: dict[str, Any], of_displacement: float, of_force: float
) -> None:
    """The path's rows reach prescribed freedoms near the ends of the beam."""
    problem, settings = shaken(crossing(*sprung_wheels(2))), steps(100, 1e-3)
    reference, forces, _ = histories(problem, settings)
    still, _, _ = histories(crossing(*sprung_wheels(2)), settings)
    assert difference(still, reference) > 0.1
    ours, our_forces, _ = histories(problem, settings, method, **options)
    assert difference(ours, reference) < of_displacement
    assert difference(our_forces, forces) < of_force


def test_reactions_balance_in_every_method() -> None:
    """Vertical equilibrium of the beam: reactions less contact forces are its inertia force."""
    problem, settings = crossing(*sprung_wheels(2)), steps(100, alpha=0.0)
    up = np.zeros(problem.structure.n_dof)
    up[0::2] = 1.0
    for method in ("direct", "iterative", "penalty", "condensation"):
        for state in integrate(problem, settings, method):
            acceleration = state.acceleration[: problem.structure.n_dof]
            inertia = up @ (problem.structure.mass @ acceleration)
            on_beam = (state.chainage >= 0.0) & (state.chainage <= 25.0)
            push = state.contact_forces[on_beam].sum()
            balance = state.reactions.sum() - push - inertia
            # Rounding of displacements times 8e11 N/m, the beam's greatest stiffness.
            assert abs(balance) < 1.0
