"""The iterative method: the two springs of section 2.2.6, its predicted and actual convergence."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from solver.contact.laws import LinearHertz, NonlinearHertz
from solver.errors import ConvergenceError, InputError
from solver.methods.integrate import integrate
from solver.methods.iterative import DivergenceError, predict_convergence
from solver.methods.problem import FreeDrive
from tests.solver.methods_case import (
    crossing,
    difference,
    histories,
    sprung_wheels,
    steps,
    two_springs,
)

STIFF, SOFT = 8e7, 2e7


def gauss_seidel_radius(matrix: np.ndarray) -> float:
    """Spectral radius of M^-1 N with M = D + L, N = -U (2.29, 2.30)."""
    sweep = np.linalg.solve(np.tril(matrix), -np.triu(matrix, 1))
    return float(np.abs(np.linalg.eigvals(sweep)).max())


def test_two_springs_by_their_equations() -> None:
    """Equations 2.40 and 2.42: the order of rows and columns alone decides on convergence."""
    converging = np.array([[1.0, 0.0, -1.0], [SOFT, -1.0, 0.0], [0.0, 1.0, STIFF]])
    permuted = np.array([[1.0, 0.0, -1.0], [STIFF, 1.0, 0.0], [0.0, -1.0, SOFT]])
    assert gauss_seidel_radius(converging) == pytest.approx(0.25, rel=1e-12)
    assert gauss_seidel_radius(permuted) == pytest.approx(4.0, rel=1e-12)
    solution = np.linalg.solve(converging, [0.0, 100e3, 100e3])
    assert solution == pytest.approx([2e-3, -60e3, 2e-3], rel=1e-12)


def test_two_springs_converge_in_ten_sweeps() -> None:
    """Section 2.2.6 prints ten for the tolerance 1e-5, from zero displacements."""
    problem, settings = two_springs(STIFF, SOFT), steps(1)
    assert predict_convergence(problem, settings).radius == pytest.approx(0.25, rel=1e-12)
    displacement, forces, sweeps = histories(
        problem, settings, "iterative", tolerance=1e-5, start="displacements"
    )
    assert sweeps.tolist() == [10]
    # The error left is 0.25^10 of the whole displacement.
    assert displacement[-1] == pytest.approx([2e-3, 2e-3], rel=1e-5)
    assert forces[-1] == pytest.approx([-60e3], rel=1e-5)


def test_exchanged_springs_diverge_and_say_so() -> None:
    problem, settings = two_springs(SOFT, STIFF), steps(1)
    assert predict_convergence(problem, settings).radius == pytest.approx(4.0, rel=1e-12)
    states = integrate(problem, settings, "iterative")
    assert next(states).step == 0
    with pytest.raises(DivergenceError, match="the joint") as caught:
        next(states)
    error = caught.value
    assert isinstance(error, ConvergenceError)
    assert (error.time, error.wheel) == (settings.time_step, "the joint")
    assert error.radius == pytest.approx(4.0, rel=1e-12)
    assert "0.4" in str(error)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize(
    ("options", "most"),
    [
        # One unknown: Aitken's formula is exact after two sweeps, the third confirms.
        ({"acceleration": "aitken"}, 3),
        # w = 1 / (1 + 4) is exact at once.
        ({"relaxation": 0.2}, 2),
        ({"relaxation": 0.39, "most_iterations": 1000}, 1000),
    ],
)
def test_relaxation_and_aitken_rescue_the_exchanged_springs(
    options: dict[str, object], most: int
) -> None:
    displacement, forces, sweeps = histories(
        two_springs(SOFT, STIFF), steps(1), "iterative", start="displacements", **options
    )
    assert sweeps[0] <= most
    assert displacement[-1] == pytest.approx([2e-3, 2e-3], rel=1e-7)
    # The vehicle's spring is four times the structure's: its force is as much less exact.
    assert forces[-1] == pytest.approx([60e3], rel=1e-6)


def test_relaxation_has_the_predicted_limit() -> None:
    """2 / (1 + 4) = 0.4: beyond it the sweeps diverge again."""
    problem = two_springs(SOFT, STIFF)
    prediction = predict_convergence(problem, steps(1))
    assert prediction.greatest_relaxation == pytest.approx(0.4)
    with pytest.raises(DivergenceError):
        histories(problem, steps(1), "iterative", relaxation=0.42, most_iterations=1000)


@pytest.mark.parametrize("solution", ["full", "interface"])
@pytest.mark.parametrize("unsprung", [300.0, 1500.0, 4000.0])
def test_sweeps_of_a_crossing_are_those_predicted(unsprung: float, solution: str) -> None:
    """From 1e-6 to 1e-11 takes ln(1e-5) / ln(radius) sweeps more, one being whole."""
    problem, settings = crossing(*sprung_wheels(1, unsprung=unsprung)), steps(1)
    prediction = predict_convergence(problem, settings, np.array([settings.time_step]))
    loose, tight = (
        histories(
            problem, settings, "iterative", tolerance=tolerance, solution=solution,
            start="displacements",
        )[2][0]
        for tolerance in (1e-6, 1e-11)
    )  # fmt: skip
    assert abs(tight - loose - prediction.iterations(1e-5)) <= 1.0


def test_shorter_steps_may_diverge_where_longer_ones_converge() -> None:
    """A wheel's inertia over the structure's that it moves within a step: the latter shrinks.

    Infinitely short steps leave the ratio of the wheel's mass to the mass of the mesh under it.
    """
    problem = crossing(*sprung_wheels(1, unsprung=2500.0))
    radii = [predict_convergence(problem, steps(800, h)).radius for h in (1e-3, 2e-4, 5e-5)]
    assert radii[0] < 0.6 < radii[1] < radii[2]
    assert radii[2] > 1.0
    with pytest.raises(DivergenceError):
        histories(problem, steps(8000, 5e-5), "iterative")


def test_aitken_follows_the_direct_method_where_gauss_seidel_diverges() -> None:
    problem, settings = crossing(*sprung_wheels(3, unsprung=8000.0)), steps(800)
    assert predict_convergence(problem, settings).radius > 1.5
    reference, forces, _ = histories(problem, settings)
    ours, our_forces, sweeps = histories(
        problem, settings, "iterative", acceleration="aitken", tolerance=1e-12
    )
    assert sweeps.max() < 40
    # The tolerance is one of displacements: forces are m / (beta dt^2) times less exact.
    assert difference(ours, reference) < 1e-8
    assert difference(our_forces, forces) < 1e-5


def test_a_heavy_mesh_needs_no_iteration() -> None:
    """Without mass at the wheels the radius is that of the springs: two sweeps do."""
    problem, settings = crossing(*sprung_wheels(3)), steps(400)
    assert predict_convergence(problem, settings).radius < 1e-3
    assert histories(problem, settings, "iterative")[2].max() <= 4


def test_the_last_forces_are_a_better_start_than_the_last_displacements() -> None:
    problem, settings = crossing(*sprung_wheels(2, unsprung=1000.0)), steps(400)
    from_forces = histories(problem, settings, "iterative")[2]
    from_displacements = histories(problem, settings, "iterative", start="displacements")[2]
    assert from_forces.mean() < from_displacements.mean()


@pytest.mark.parametrize("method", ["iterative", "penalty", "condensation"])
@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("unilateral", {"unilateral": True}),
        ("law", {"law": NonlinearHertz(coefficient=8e10, reference_force=6e4)}),
        ("drive", {"drive": FreeDrive()}),
    ],
)
def test_what_only_the_direct_method_can_do_is_refused(
    method: str, field: str, change: dict[str, object]
) -> None:
    problem = crossing(*sprung_wheels(1), **change)
    with pytest.raises(InputError, match=f"^{field} .*{method}"):
        integrate(problem, steps(1), method)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("method", "options", "field"),
    [
        ("iterative", {"tolerance": 0.0}, "iterative.tolerance"),
        ("iterative", {"relaxation": 2.5}, "iterative.relaxation"),
        ("iterative", {"acceleration": "Aitken"}, "iterative.acceleration"),
        ("iterative", {"penalty": 1.0}, "iterative.penalty"),
        ("penalty", {"penalty": -1.0}, "penalty.penalty"),
        ("penalty", {"solution": "once"}, "penalty.solution"),
        ("condensation", {"tolerance": 1e-8}, "condensation.tolerance"),
        ("direct", {"tolerance": 1e-8}, "direct.tolerance"),
        ("implicit", {}, "method"),
    ],
)
def test_bad_options_name_their_field(method: str, options: dict[str, object], field: str) -> None:
    problem = crossing(*sprung_wheels(1), law=LinearHertz(stiffness=1.2e9))
    with pytest.raises(InputError) as caught:
        integrate(problem, steps(1), method, **options)  # type: ignore[arg-type]
    assert caught.value.field == field
