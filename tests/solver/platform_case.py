"""A wheel on a sprung platform with a wavy surface: two or three freedoms, solved by DOP853.

The platform (mass, spring, dashpot) is the structure; every point of the path moves with it. The
vehicle is a wheel with mass under a sprung, damped body. Shared by the tests of the direct method.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from scipy.integrate import solve_ivp

from solver.contact.laws import ContactLaw, LinearHertz, NonlinearHertz, RigidContact
from solver.contact.path import Path, beam_path
from solver.integrators.hht import HHT
from solver.irregularities.harmonic import HarmonicIrregularity
from solver.methods import DirectMethod, PrescribedSpeed, Problem, Settings, StepState, Wheels
from solver.models.subsystem import Subsystem

PLATFORM, WHEEL, BODY = 2000.0, 400.0, 1500.0
GROUND, SUSPENSION = 4.0e6, 6.0e5
GROUND_DAMPER, DAMPER = 6.0e3, 4.0e3
GRAVITY, SPEED = 9.81, 10.0
SURFACE = HarmonicIrregularity(amplitude=1e-3, wavelength=5.0)
WEIGHT = (WHEEL + BODY) * GRAVITY


@dataclass(frozen=True)
class History:
    """Platform, wheel, body: displacement, velocity, acceleration (n, 3); contact force (n,)."""

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    force: np.ndarray


def one(value: float) -> sparse.csr_array:
    return sparse.csr_array(np.array([[value]]))


def level_path(length: float) -> Path:
    """A path of which every point moves with freedom 0."""
    x = np.linspace(0.0, length, 4)
    points = np.stack([x, 0.0 * x, 0.0 * x], axis=1)
    return beam_path(points, sparse.csr_array(np.ones((4, 1))), sparse.csr_array((4, 1)))


def problem(law: ContactLaw, length: float = 100.0, platform: float = PLATFORM) -> Problem:
    """Starts level, in static equilibrium but for the slope of the surface."""
    suspension = np.array([[1.0, -1.0], [-1.0, 1.0]])
    vehicle = Subsystem(
        name="the vehicle",
        mass=sparse.csr_array(np.diag([WHEEL, BODY])),
        damping=sparse.csr_array(DAMPER * suspension),
        stiffness=sparse.csr_array(SUSPENSION * suspension),
        load=np.array([-WHEEL * GRAVITY, -BODY * GRAVITY]),
    )
    structure = Subsystem(
        name="the structure",
        mass=one(platform),
        damping=one(GROUND_DAMPER),
        stiffness=one(GROUND),
        load=np.zeros(1),
    )
    nothing = sparse.csr_array((1, 2))
    start = start_displacement(law)
    slope = float(SURFACE.slope(np.zeros(1))[0])
    rate = SPEED * slope if isinstance(law, RigidContact) else 0.0
    return Problem(
        structure=structure,
        vehicle=vehicle,
        wheels=Wheels(
            names=("wheel 1",),
            rows=(nothing, nothing, sparse.csr_array(np.array([[1.0, 0.0]]))),
            chainage=np.zeros(1),
        ),
        path=level_path(length),
        law=law,
        drive=PrescribedSpeed(speed=SPEED),
        irregularity=SURFACE,
        start="consistent",
        displacement=start,
        velocity=np.array([0.0, rate, 0.0]),
    )


def compression(law: ContactLaw, force: float) -> float:
    """Compression of the contact under a force."""
    if isinstance(law, LinearHertz):
        return force / law.stiffness
    if isinstance(law, NonlinearHertz):
        return (force / law.coefficient) ** (2.0 / 3.0)
    return 0.0


def start_displacement(law: ContactLaw) -> np.ndarray:
    """Static equilibrium: platform, wheel, body."""
    platform = -WEIGHT / GROUND
    wheel = platform - compression(law, WEIGHT)
    return np.array([platform, wheel, wheel - BODY * GRAVITY / SUSPENSION])


def integrate(
    law: ContactLaw, alpha: float, time_step: float, n_step: int, platform: float = PLATFORM
) -> History:
    """By the direct method."""
    method = DirectMethod(
        problem(law, platform=platform), Settings(method=HHT(alpha, time_step), n_step=n_step)
    )
    return collect(replace(state) for state in method.states())


def collect(states: object) -> History:
    """Histories from states."""
    rows: list[tuple[float, np.ndarray, np.ndarray, np.ndarray, float]] = []
    for state in states:  # type: ignore[attr-defined]
        assert isinstance(state, StepState)
        rows.append(
            (state.time, state.displacement.copy(), state.velocity.copy(),
             state.acceleration.copy(), float(state.contact_forces[0]))
        )  # fmt: skip
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return History(*columns)


def exact(law: ContactLaw, times: np.ndarray, platform_mass: float = PLATFORM) -> History:
    """By DOP853; a rigid wheel follows platform and surface, the other laws have three freedoms."""
    start = start_displacement(law)
    rigid = isinstance(law, RigidContact)

    def surface(t: float) -> tuple[float, float, float]:
        x = np.array([SPEED * t])
        return (
            float(SURFACE.elevation(x)[0]),
            SPEED * float(SURFACE.slope(x)[0]),
            SPEED**2 * float(SURFACE.curvature(x)[0]),
        )

    def motion(t: float, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        r, rate, bend = surface(t)
        if rigid:
            u, z = state[:2]
            du, dz = state[2:]
            a, v = np.array([u, u + r, z]), np.array([du, du + rate, dz])
        else:
            a, v = state[:3], state[3:]
        pull = SUSPENSION * (a[2] - a[1]) + DAMPER * (v[2] - v[1])
        body = -GRAVITY - pull / BODY
        ground = -GROUND * a[0] - GROUND_DAMPER * v[0]
        if rigid:
            platform = (ground - WHEEL * GRAVITY + pull - WHEEL * bend) / (platform_mass + WHEEL)
            wheel = platform + bend
            force = WHEEL * (wheel + GRAVITY) - pull
        else:
            force = _force(law, a[0] + r - a[1])
            platform, wheel = (ground - force) / platform_mass, (force + pull) / WHEEL - GRAVITY
        return a, v, np.array([platform, wheel, body]), force

    def derivative(t: float, state: np.ndarray) -> np.ndarray:
        _, v, w, _ = motion(t, state)
        return np.concatenate([v[[0, 2]], w[[0, 2]]]) if rigid else np.concatenate([v, w])

    kept = [0, 2] if rigid else [0, 1, 2]
    first = np.concatenate([start[kept], np.zeros(len(kept))])
    # Accelerations are asked for at t + alpha dt, before zero at the first step.
    found = solve_ivp(
        derivative, (0.0, float(times.max())), first, method="DOP853", rtol=1e-12, atol=1e-14,
        dense_output=True,
    )  # fmt: skip
    parts = [motion(float(t), found.sol(max(float(t), 0.0))) for t in times]
    columns = [np.array(column) for column in zip(*parts, strict=True)]
    return History(times, *columns)


def _force(law: ContactLaw, depth: float) -> float:
    if isinstance(law, LinearHertz):
        return law.stiffness * depth
    assert isinstance(law, NonlinearHertz)
    return law.coefficient * max(depth, 0.0) ** 1.5
