"""Nonlinear elements other than contact, and free drive on curved and flexible paths."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.integrate import solve_ivp

from solver.arrays import IntVector, Matrix, Vector
from solver.contact.laws import RigidContact
from solver.contact.path import rigid_path
from solver.errors import InputError, SingularSystemError
from solver.integrators.hht import HHT
from solver.irregularities.harmonic import HarmonicIrregularity
from solver.methods import (
    DirectMethod,
    FreeDrive,
    PrescribedSpeed,
    Problem,
    Settings,
    Wheels,
)
from solver.methods.vehicles import plane_masses
from solver.models.subsystem import Subsystem
from tests.solver import platform_case as case


@dataclass(frozen=True)
class CubicSpring:
    """Force k3 u^3 on freedom 0."""

    k3: float
    freedoms: IntVector = field(default_factory=lambda: np.array([0]))

    def force(self, displacement: Vector) -> Vector:
        return self.k3 * displacement**3

    def tangent(self, displacement: Vector) -> Matrix:
        return np.diag(3.0 * self.k3 * displacement**2)


CUBIC = 4.0e10


def _static_platform() -> float:
    """Root of k u + k3 u^3 = -W."""
    roots = np.roots([CUBIC, 0.0, case.GROUND, case.WEIGHT])
    return float(roots[np.abs(roots.imag) < 1e-9].real[0])


def _on_cubic_ground() -> Problem:
    """The platform stands on a stiffening spring, in static equilibrium."""
    problem = case.problem(RigidContact())
    structure = replace(problem.structure, nonlinear=CubicSpring(CUBIC))
    u0 = _static_platform()
    start = np.array([u0, u0, u0 - case.BODY * case.GRAVITY / case.SUSPENSION])
    return replace(problem, structure=structure, displacement=start)


def _exact(times: Vector) -> Vector:
    """Platform by DOP853 from the static state."""
    u0 = _static_platform()
    z0 = u0 - case.BODY * case.GRAVITY / case.SUSPENSION

    def derivative(t: float, state: Vector) -> Vector:
        u, z, du, dz = state
        x = np.array([case.SPEED * t])
        r = float(case.SURFACE.elevation(x)[0])
        rate = case.SPEED * float(case.SURFACE.slope(x)[0])
        bend = case.SPEED**2 * float(case.SURFACE.curvature(x)[0])
        pull = case.SUSPENSION * (z - u - r) + case.DAMPER * (dz - du - rate)
        ground = -case.GROUND * u - CUBIC * u**3 - case.GROUND_DAMPER * du
        load = ground + pull - case.WHEEL * (case.GRAVITY + bend)
        return np.array([du, dz, load / (case.PLATFORM + case.WHEEL),
                         -case.GRAVITY - pull / case.BODY])  # fmt: skip

    found = solve_ivp(
        derivative, (0.0, float(times[-1])), [u0, z0, 0.0, 0.0], method="DOP853",
        rtol=1e-12, atol=1e-14, t_eval=times,
    )  # fmt: skip
    return found.y[0]


def _platform(settings: Settings) -> tuple[Vector, Vector, int]:
    problem = _on_cubic_ground()
    method = DirectMethod(problem, settings)
    rows = [(s.time, s.displacement[0], s.iterations) for s in method.states()]
    times, platform, iterations = (np.array(column) for column in zip(*rows, strict=True))
    return times, platform, int(iterations.sum())


def test_a_stiffening_ground_is_followed_at_order_two() -> None:
    errors = []
    for n_step in (200, 400):
        settings = Settings(method=HHT(-0.05, 0.4 / n_step), n_step=n_step, tolerance=1e-9)
        times, platform, _ = _platform(settings)
        errors.append(np.abs(platform - _exact(times)).max())
    assert errors[-1] < 1e-3 * np.abs(platform).max()
    assert np.log2(errors[0] / errors[1]) > 1.85


def test_the_static_start_follows_nonlinear_elements() -> None:
    problem = replace(_on_cubic_ground(), start="static", displacement=None, velocity=None)
    start = DirectMethod(problem, Settings(method=HHT(0.0, 1e-3), n_step=1)).state
    assert start.displacement[0] == pytest.approx(_static_platform(), rel=1e-12)


def test_a_constant_tangent_takes_more_iterations_to_the_same_place() -> None:
    common = {"method": HHT(-0.05, 1e-3), "n_step": 200, "tolerance": 1e-10}
    _, updated, few = _platform(Settings(**common))  # type: ignore[arg-type]
    _, constant, many = _platform(Settings(**common, tangent="constant"))  # type: ignore[arg-type]
    # Both end at residuals of 1e-10 of the load.
    np.testing.assert_allclose(constant, updated, rtol=0, atol=1e-8 * np.abs(updated).max())
    assert many > few


def test_a_settings_tangent_of_another_name_is_refused() -> None:
    with pytest.raises(InputError, match="neither updated nor constant"):
        Settings(method=HHT(0.0, 1e-3), n_step=1, tangent="secant")


# -- free drive ------------------------------------------------------------------------------


def _rolling(n_step: int, alpha: float) -> tuple[Vector, Vector]:
    """A mass pushed with 20 N over a wavy, sprung platform: energy, and how far it came."""
    problem = case.problem(RigidContact())
    vehicle = plane_masses(np.zeros(1), mass=40.0, load=np.array([20.0, -40.0 * 9.81]))
    free = replace(
        problem, vehicle=vehicle.subsystem, wheels=vehicle.wheels, drive=FreeDrive(),
        irregularity=HarmonicIrregularity(amplitude=5e-3, wavelength=4.0),
        displacement=np.array([-40.0 * 9.81 / case.GROUND, 0.0, -40.0 * 9.81 / case.GROUND]),
        velocity=np.zeros(3),
        structure=replace(problem.structure, damping=case.one(0.0)),
    )  # fmt: skip
    method = DirectMethod(free, Settings(method=HHT(alpha, 6.0 / n_step), n_step=n_step))
    energy, advance = [], []
    mass, stiffness = method.stacked.mass, method.stacked.stiffness
    for state in method.states():
        a, v = state.displacement, state.velocity
        held = 0.5 * v @ (mass @ v) + 0.5 * a @ (stiffness @ a)
        energy.append(held - a @ np.array([0.0, 20.0, -40.0 * 9.81]))
        advance.append(a[1])
    return np.array(energy), np.array(advance)


@pytest.mark.slow
def test_a_wheel_that_rolls_freely_keeps_its_energy_on_a_wavy_flexible_path() -> None:
    """The force stands at right angles to the moving, wavy surface and does no work along it."""
    changes = []
    for n_step in (600, 1200):
        energy, advance = _rolling(n_step, -0.05)
        work = 20.0 * advance[-1]
        changes.append(np.abs(energy - energy[0]).max() / work)
    # 9 m of waves: the energy drifts with the square of the step, measured 6e-7 of the work.
    assert changes[1] < 5e-6
    assert changes[0] / changes[1] > 3.6


def test_a_free_wheel_that_leaves_its_path_is_reported() -> None:
    vehicle = plane_masses(np.zeros(1), mass=40.0, load=np.array([2000.0, -40.0 * 9.81]))
    problem = replace(
        case.problem(RigidContact(), length=5.0), vehicle=vehicle.subsystem,
        wheels=vehicle.wheels, drive=FreeDrive(), displacement=np.zeros(3), velocity=np.zeros(3),
    )  # fmt: skip
    method = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=2000))
    with pytest.raises(InputError, match="outside its path"):
        list(method.states())


def test_a_free_vehicle_cannot_start_from_statics() -> None:
    vehicle = plane_masses(np.zeros(1), mass=40.0, load=np.array([20.0, -40.0 * 9.81]))
    problem = replace(
        case.problem(RigidContact()), vehicle=vehicle.subsystem, wheels=vehicle.wheels,
        drive=FreeDrive(), start="static", displacement=None, velocity=None,
    )  # fmt: skip
    with pytest.raises(SingularSystemError, match="moves without any spring"):
        DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=1))


def test_a_curved_path_wants_a_free_drive() -> None:
    x = np.linspace(0.0, 10.0, 6)
    path = rigid_path(np.stack([x, 0 * x, 0.01 * x**2], axis=1), 0, smooth=True)
    one, none = sparse.csr_array([[1.0]]), sparse.csr_array((1, 1))
    empty = sparse.csr_array((0, 0))
    with pytest.raises(InputError, match="not straight"):
        Problem(
            structure=Subsystem(
                name="the structure", mass=empty, damping=empty, stiffness=empty, load=np.zeros(0)
            ),
            vehicle=Subsystem(
                name="the vehicle", mass=one, damping=none, stiffness=none, load=np.zeros(1)
            ),
            wheels=Wheels(names=("wheel 1",), rows=(none, none, one), chainage=np.zeros(1)),
            path=path, drive=PrescribedSpeed(speed=1.0),
        )  # fmt: skip
