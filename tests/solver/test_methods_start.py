"""How a run starts, what it refuses to start from, and wheels on freedoms without mass."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.arrays import IntVector, Matrix, Vector
from solver.contact.laws import ContactLaw, LinearHertz, NonlinearHertz, RigidContact
from solver.contact.path import rigid_path
from solver.errors import InputError, SingularSystemError, UnstableError
from solver.integrators.hht import HHT
from solver.irregularities.harmonic import HarmonicIrregularity
from solver.methods import (
    DirectMethod,
    FreeDrive,
    PrescribedSpeed,
    Problem,
    Settings,
    StepState,
    Wheels,
)
from solver.methods.vehicles import plane_masses
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.models.subsystem import Subsystem
from tests.solver import platform_case as case

SETTINGS = Settings(method=HHT(0.0, 1e-3), n_step=20)


def _ground() -> Subsystem:
    empty = sparse.csr_array((0, 0))
    return Subsystem(
        name="the structure", mass=empty, damping=empty, stiffness=empty, load=np.zeros(0)
    )


def _flat(length: float = 100.0) -> object:
    return rigid_path(np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]]), 0)


def _body(law: ContactLaw, unilateral: bool, eccentricity: float = 0.0) -> Problem:
    """A rigid body (bounce, pitch) on three wheels 2 m apart, its weight off the middle."""
    mass, inertia, weight = 9300.0, 4e4, 91233.0
    arms = np.array([-2.0, 0.0, 2.0])
    rows = sparse.csr_array(np.stack([np.ones(3), arms], axis=1))
    none2, none3 = sparse.csr_array((2, 2)), sparse.csr_array((3, 2))
    vehicle = Subsystem(
        name="the vehicle", mass=sparse.csr_array(np.diag([mass, inertia])), damping=none2,
        stiffness=none2, load=np.array([-weight, -weight * eccentricity]),
    )  # fmt: skip
    return Problem(
        structure=_ground(), vehicle=vehicle, path=_flat(), law=law, unilateral=unilateral,  # type: ignore[arg-type]
        wheels=Wheels(names=("a", "b", "c"), rows=(none3, none3, rows), chainage=10.0 + arms),
        drive=PrescribedSpeed(speed=0.0),
    )  # fmt: skip


@pytest.mark.parametrize("reference", [1e3, 3e4, 1e5])
@pytest.mark.parametrize(("eccentricity", "unilateral"), [(0.9, True), (1.7, False)])
def test_the_nonlinear_start_does_not_depend_on_the_guess(
    reference: float, eccentricity: float, unilateral: bool
) -> None:
    law = NonlinearHertz(coefficient=7.958e10, reference_force=reference)
    state = DirectMethod(_body(law, unilateral, eccentricity), SETTINGS).state
    forces, arms = state.contact_forces, np.array([-2.0, 0.0, 2.0])
    assert forces.sum() == pytest.approx(91233.0, rel=1e-9)
    assert forces @ arms == pytest.approx(91233.0 * eccentricity, rel=1e-9)
    depth = -(state.displacement[0] + arms * state.displacement[1])
    np.testing.assert_allclose(forces, 7.958e10 * np.sign(depth) * np.abs(depth) ** 1.5, rtol=1e-8)
    assert (forces.min() > 0.0) == unilateral


def test_rigid_wheels_that_share_a_load_in_no_one_way_are_refused() -> None:
    with pytest.raises(SingularSystemError):
        DirectMethod(_body(RigidContact(), True), SETTINGS)
    consistent = replace(_body(RigidContact(), True), start="consistent")
    with pytest.raises(SingularSystemError, match="need a spring"):
        list(DirectMethod(consistent, SETTINGS).states())


def test_a_free_wheel_finds_its_place_of_rest() -> None:
    """Tied by a horizontal spring on a wavy path: the start stays where it is."""
    free = plane_masses(np.array([20.4]), mass=40.0, load=np.array([0.0, -40.0 * 9.81]))
    tied = replace(free.subsystem, stiffness=sparse.csr_array(np.diag([2e3, 0.0])))
    problem = Problem(
        structure=_ground(), vehicle=tied, wheels=free.wheels, path=_flat(),  # type: ignore[arg-type]
        drive=FreeDrive(), start="static",
        irregularity=HarmonicIrregularity(amplitude=2e-2, wavelength=3.0),
    )  # fmt: skip
    method = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=300))
    start = method.state.displacement.copy()
    assert abs(start[0]) > 1e-3
    for state in method.states():
        np.testing.assert_allclose(state.displacement, start, rtol=0, atol=1e-9)


def test_a_rigid_wheel_inside_its_path_is_refused() -> None:
    problem = case.problem(RigidContact())
    assert problem.displacement is not None
    inside = problem.displacement - np.array([0.0, 5e-3, 0.0])
    with pytest.raises(InputError, match="gap"):
        DirectMethod(replace(problem, displacement=inside), SETTINGS)


def test_a_spring_that_may_pull_starts_closed() -> None:
    problem = case.problem(LinearHertz(stiffness=3e7))
    assert problem.displacement is not None
    lifted = replace(
        problem, unilateral=False, displacement=problem.displacement + np.array([0.0, 2e-3, 0.0])
    )
    method = DirectMethod(lifted, SETTINGS)
    assert method.state.closed.all()
    assert method.state.contact_forces[0] < 0.0
    assert list(method.states())[-1].status_changes == 0


def test_a_run_goes_on_from_where_it_stands() -> None:
    method = DirectMethod(case.problem(RigidContact()), SETTINGS)
    first: list[StepState] = []
    for state in method.states():
        first.append(state)
        if state.step == 5:
            break
    rest = list(method.states())
    assert [s.step for s in rest] == list(range(5, 21))
    whole = list(DirectMethod(case.problem(RigidContact()), SETTINGS).states())
    np.testing.assert_array_equal(rest[-1].displacement, whole[-1].displacement)


# -- freedoms without mass, and prescribed ones ------------------------------------------------


@pytest.mark.parametrize("alpha", [0.0, -0.05])
def test_a_wheel_with_mass_on_a_rail_without_is_of_order_two(alpha: float) -> None:
    errors = []
    for n_step in (200, 400):
        ours = case.integrate(RigidContact(), alpha, 0.4 / n_step, n_step, platform=0.0)
        exact = case.exact(RigidContact(), ours.time, platform_mass=0.0)
        errors.append(np.abs(ours.displacement - exact.displacement).max())
    # Half the step, a quarter of the error.
    assert errors[0] / errors[1] > 3.6


def test_a_driven_wheel_on_a_platform_with_mass_does_not_make_its_force_alternate() -> None:
    """The wheel's height is given; the platform must follow it from below."""
    omega, size = 20.0, 1e-3

    def driven(time: float) -> tuple[Vector, Vector, Vector]:
        # Smooth from rest: the platform can follow it from the start.
        angle = omega * time
        rise = 1.0 - np.cos(angle)
        start = -case.WEIGHT / case.GROUND
        return (
            np.array([start + size * rise**2]),
            np.array([2 * size * omega * rise * np.sin(angle)]),
            np.array([2 * size * omega**2 * (np.sin(angle) ** 2 + rise * np.cos(angle))]),
        )

    base = case.problem(RigidContact())
    one = sparse.csr_array([[1.0]])
    none = sparse.csr_array((1, 1))
    vehicle = Subsystem(
        name="the vehicle", mass=one, damping=none, stiffness=none, load=np.zeros(1),
        prescribed=np.array([0]), support_motion=driven,
    )  # fmt: skip
    flat = HarmonicIrregularity(amplitude=0.0, wavelength=1.0)
    problem = replace(
        base, vehicle=vehicle, irregularity=flat, unilateral=False, velocity=None,
        wheels=Wheels(names=("w",), rows=(none, none, one), chainage=np.zeros(1)),
        displacement=np.full(2, -case.WEIGHT / case.GROUND),
    )  # fmt: skip
    method = DirectMethod(problem, Settings(method=HHT(0.0, 1e-3), n_step=200))
    for state in method.states():
        height, rate, bend = driven(state.time)
        pushed = case.PLATFORM * bend + case.GROUND_DAMPER * rate + case.GROUND * height
        # The force on the wheel is what the platform takes, with its sign: below 1 % of the peak.
        assert state.contact_forces[0] == pytest.approx(-float(pushed[0]), abs=2e2)


@dataclass(frozen=True)
class _Spring:
    freedoms: IntVector

    def force(self, displacement: Vector) -> Vector:
        return displacement

    def tangent(self, displacement: Vector) -> Matrix:
        return np.eye(self.freedoms.size)


@pytest.mark.parametrize("freedoms", [[0], [1, 1], [5]])
def test_nonlinear_elements_on_freedoms_that_cannot_be_are_refused(freedoms: list[int]) -> None:
    one = sparse.eye_array(3)
    with pytest.raises(InputError) as caught:
        Subsystem(
            name="the structure", mass=one, damping=one, stiffness=one, load=np.zeros(3),
            prescribed=np.array([0]), nonlinear=_Spring(np.array(freedoms)),
        )  # fmt: skip
    assert caught.value.field == "the structure.nonlinear"


# -- values that are none ------------------------------------------------------------------------


def test_values_that_are_not_finite_are_named() -> None:
    problem = case.problem(RigidContact())
    with pytest.raises(InputError, match="displacement"):
        DirectMethod(replace(problem, displacement=np.array([np.nan, 0.0, 0.0])), SETTINGS)
    with pytest.raises(InputError, match=r"the vehicle\.load"):
        replace(problem.vehicle, load=np.array([np.inf, 0.0]))


def test_a_load_that_changes_its_shape_on_the_way_is_named() -> None:
    problem = case.problem(RigidContact())

    def load(time: float) -> Vector:
        return np.zeros(2) if time < 0.01 else np.zeros(3)

    moving = replace(problem, vehicle=replace(problem.vehicle, load=load))
    with pytest.raises(InputError, match=r"finite forces at t = 0\.01"):
        list(DirectMethod(moving, SETTINGS).states())


def test_supports_that_move_by_too_many_numbers_are_named() -> None:
    problem = case.problem(RigidContact())
    vehicle = replace(
        problem.vehicle, prescribed=np.array([1]),
        support_motion=lambda t: (np.zeros(2), np.zeros(1), np.zeros(1)),
    )  # fmt: skip
    with pytest.raises(InputError, match=r"support_motion\.displacement"):
        DirectMethod(replace(problem, vehicle=vehicle), SETTINGS)


@pytest.mark.parametrize("chainage", [[1.0, 2.0], [], [np.nan]])
def test_wheels_want_one_place_each(chainage: list[float]) -> None:
    rows = case.problem(RigidContact()).wheels.rows
    with pytest.raises(InputError, match=r"wheels\.chainage"):
        Wheels(names=("1",), rows=rows, chainage=np.array(chainage))


def test_a_response_that_is_no_number_is_reported() -> None:
    method = DirectMethod(case.problem(LinearHertz(stiffness=3e7)), SETTINGS)
    states = method.states()
    next(states).displacement[:] = np.inf
    with pytest.raises(UnstableError, match=r"t = 0\.001 s"), np.errstate(invalid="ignore"):
        next(states)


def test_a_free_wheel_may_not_step_over_a_whole_element() -> None:
    beam = plane_beams(PlaneBeams(spans=(10.0,), rigidity=2e8, mass_per_length=2000.0,
                                  elements_per_span=20))  # fmt: skip
    vehicle = plane_masses(np.array([1.0]), mass=40.0, load=np.array([0.0, -40.0 * 9.81]))
    n_dof = beam.structure.n_dof
    problem = Problem(
        structure=beam.structure, vehicle=vehicle.subsystem, wheels=vehicle.wheels,
        path=beam.path, drive=FreeDrive(), start="consistent",
        velocity=np.concatenate([np.zeros(n_dof), [200.0, 0.0]]),
    )  # fmt: skip
    with pytest.raises(InputError, match=r"mass 1 advances 2 m a step, over elements of 0\.5 m"):
        list(DirectMethod(problem, Settings(method=HHT(-0.1, 1e-2), n_step=3)).states())


def test_free_drive_wants_a_path_without_kinks() -> None:
    points = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [20.0, 0.0, 0.5]])
    vehicle = plane_masses(np.array([1.0]), mass=40.0, load=np.array([0.0, -392.4]))
    with pytest.raises(InputError, match=r"smooth=True"):
        Problem(
            structure=_ground(), vehicle=vehicle.subsystem, wheels=vehicle.wheels,
            path=rigid_path(points, 0), drive=FreeDrive(),
        )  # fmt: skip


def test_a_weightless_wheel_flies_off_without_a_convergence_error() -> None:
    """No load at all: the residual is judged against its own rounding."""
    law = NonlinearHertz(coefficient=1e9, reference_force=1e3)
    vehicle = plane_masses(np.array([10.0]), mass=40.0, load=np.zeros(2))
    problem = Problem(
        structure=_ground(), vehicle=vehicle.subsystem, wheels=vehicle.wheels, law=law,
        path=_flat(), drive=FreeDrive(), start="consistent", velocity=np.array([1.0, 0.5]),  # type: ignore[arg-type]
    )  # fmt: skip
    last = list(DirectMethod(problem, Settings(method=HHT(-0.05, 1e-3), n_step=50)).states())[-1]
    np.testing.assert_allclose(last.displacement, [0.05, 0.025], atol=1e-9)
    assert last.contact_forces[0] == 0.0
