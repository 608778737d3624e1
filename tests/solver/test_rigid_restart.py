"""Rigid contact of wheels that have mass: kinks, flights, landings, a mass on a beam."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from solver.integrators import HHT, HHTIntegrator, Motion
from solver.models.beam_bridge import BeamBridge, beam_bridge_line
from solver.models.beam_line import BeamLine
from solver.reference import Crossing, SimplySupportedBeam, moving_masses
from solver.simulation import effective_coefficients
from solver.system import EffectiveSystem, System
from solver.system.energy import EnergyBalance
from solver.system.statics import static_state
from solver.system.system import TrainMatrices

GRAVITY = 9.81
SPEED, STEP, KINK, PLACE = 50.0, 2.5e-4, 0.05, 0.303
"""Speed [m/s], time step [s], rate of the kink [m/s] and its place [m]."""

Profile = Callable[[np.ndarray, np.ndarray], np.ndarray]


def train(mass: np.ndarray, rows: np.ndarray, offsets: list[float], spring=None) -> TrainMatrices:
    """Bodies on wheels; gravity pulls at every freedom that rows or springs lift upright."""
    n_dof = mass.shape[0]
    stiffness = np.zeros((n_dof, n_dof)) if spring is None else spring
    return TrainMatrices(
        mass=mass,
        damping=np.zeros((n_dof, n_dof)),
        stiffness=stiffness,
        weight=-GRAVITY * mass.diagonal(),
        wheel_rows=rows,
        wheel_offsets=np.array(offsets),
        wheel_lines=np.zeros(len(offsets), dtype=np.int64),
        wheel_rest=np.zeros(len(offsets)),
    )


def spring_between(n_dof: int, first: int, second: int, stiffness: float) -> np.ndarray:
    row = np.zeros(n_dof)
    row[first], row[second] = 1.0, -1.0
    return stiffness * np.outer(row, row)


def rigid_path(start: float, end: float) -> BeamLine:
    """Ground: a line whose every freedom is fixed."""
    return BeamLine.build(
        positions=np.array([start, end]),
        rigidity=np.array([1e9]),
        mass_per_length=np.array([1e3]),
        free=np.zeros((2, 2), dtype=bool),
        n_line=1,
    )


def system(line: BeamLine, vehicle: TrainMatrices, profile: Profile, speed: float) -> System:
    return System(
        line=line,
        seat_nodes=np.zeros(0, dtype=np.int64),
        structure=None,
        train=vehicle,
        contact_compliance=0.0,
        unilateral=True,
        irregularity=profile,
        start_position=0.0,
        speed=speed,
    )


@dataclass
class Run:
    """Histories of a run, one row a step."""

    effective: EffectiveSystem
    balance: EnergyBalance
    times: np.ndarray
    forces: np.ndarray
    closed: np.ndarray
    lines: np.ndarray
    wheels: np.ndarray


def run(whole: System, alpha: float, step: float, n_step: int) -> Run:
    static, method = static_state(whole), HHT(alpha, step)
    whole = replace(whole, train=whole.train.from_rest(static.train))
    effective = EffectiveSystem(whole, effective_coefficients(method))
    motions = [Motion.at_rest(static.lines), Motion.at_rest(np.zeros_like(static.train))]
    integrator = HHTIntegrator(method, effective, motions)
    effective.stand(static.contact_forces, static.pad_forces, static.compression)
    balance = EnergyBalance(effective, motions, step)
    forces, closed, lines, wheels = [], [], [], []
    for number in range(1, n_step + 1):
        integrator.advance(number * step)
        effective.settle(motions)
        balance.record(number * step)
        forces.append(effective.state.contact_forces.copy())
        closed.append(effective.state.closed.copy())
        lines.append(motions[0].displacement[:, 0].copy())
        wheels.append(whole.train.wheel_rest + whole.train.wheel_rows @ motions[1].displacement)
    return Run(
        effective=effective,
        balance=balance,
        times=step * np.arange(1, n_step + 1),
        forces=np.array(forces),
        closed=np.array(closed),
        lines=np.array(lines),
        wheels=np.array(wheels),
    )


def flat(lines: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.zeros_like(x)


def kink(rate: float, place: float = PLACE) -> Profile:
    return lambda lines, x: rate / SPEED * np.maximum(x - place, 0.0)


def quarter_car() -> TrainMatrices:
    """An unsprung wheel of 900 kg under 7.5 t."""
    mass = np.diag([900.0, 7500.0])
    return train(mass, np.array([[1.0, 0.0]]), [0.0], spring_between(2, 0, 1, 1e6))


# -- one wheel ---------------------------------------------------------------------------------


@pytest.mark.parametrize("alpha", [0.0, -0.1])
@pytest.mark.parametrize("place", [0.303, 0.30625, 0.3125, 0.312499], ids=str)
def test_after_a_kink_the_force_is_the_analytical_one(place: float, alpha: float) -> None:
    """Wherever in its step the wheel meets the kink, half a step included, where Newmark's
    velocity happens to be right and only its acceleration is not."""
    found = run(system(rigid_path(-1.0, 20.0), quarter_car(), kink(KINK, place), SPEED),
                alpha, STEP, 400)  # fmt: skip
    since = np.maximum(found.times - place / SPEED, 0.0)
    omega = np.sqrt(1e6 / 7500.0)
    wanted = 8400.0 * GRAVITY + 1e6 * KINK * np.sin(omega * since) / omega
    third = int(np.ceil(place / SPEED / STEP)) + 2
    # The issue allows 2 percent from the third step; without the restart it is out by 8000.
    assert np.abs(found.forces[third:, 0] / wanted[third:] - 1.0).max() < 1e-6
    assert np.abs(found.forces[:, 0] / wanted - 1.0).max() < 2e-3
    state = found.effective.state
    assert state.status_changes == 0
    assert state.restarts <= 2
    # A kink within a difference's reach of the step's end is taken in two parts.
    if place != 0.312499:
        assert state.impact_loss == pytest.approx(0.5 * 900.0 * KINK**2, rel=1e-3)


@pytest.mark.parametrize("alpha", [0.0, -0.1])
def test_over_a_kink_downwards_the_wheel_flies_and_lands_once(alpha: float) -> None:
    """Free fall over a falling path: away for 2 c / g, then the blow of m c."""
    mass = train(np.array([[900.0]]), np.eye(1), [0.0])
    found = run(system(rigid_path(-1.0, 20.0), mass, kink(-KINK), SPEED), alpha, STEP, 200)
    away = np.flatnonzero(~found.closed[:, 0])
    assert found.effective.state.status_changes == 2
    assert away.size * STEP == pytest.approx(2.0 * KINK / GRAVITY, abs=2 * STEP)
    assert np.all(found.forces[away] == 0.0)
    landed = found.forces[away[-1] + 1 :, 0]
    np.testing.assert_allclose(landed, 900.0 * GRAVITY, rtol=1e-5)
    # First order in the step: gravity acts on during the step of the blow.
    assert found.effective.state.impact_loss == pytest.approx(0.5 * 900.0 * KINK**2, rel=0.05)
    assert abs(found.balance.terms.gap) < 0.05 * found.balance.terms.exchange


def test_a_wheel_on_a_massless_contact_point_is_left_alone() -> None:
    """A mixed train: the massless wheel's forces are those of a train without the other one."""
    mass = np.diag([900.0, 0.0, 5750.0])
    rows = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    mixed = train(mass, rows, [0.0, -3.0], spring_between(3, 1, 2, 1.6e6))
    alone = train(mass[1:, 1:], rows[1:, 1:], [-3.0], spring_between(2, 0, 1, 1.6e6))
    both = run(system(rigid_path(-5.0, 20.0), mixed, kink(KINK), SPEED), 0.0, STEP, 400)
    single = run(system(rigid_path(-5.0, 20.0), alone, kink(KINK), SPEED), 0.0, STEP, 400)
    np.testing.assert_allclose(both.forces[:, 1], single.forces[:, 0], rtol=1e-9)
    np.testing.assert_allclose(both.forces[:, 0], 900.0 * GRAVITY, rtol=1e-4)
    assert both.effective.state.restarts <= 2
    assert single.effective.state.restarts == 0


# -- two wheels under a frame ------------------------------------------------------------------


def frame(inertia_ratio: float) -> TrainMatrices:
    """A rigid frame on two wheels 3 m apart, its inertia the ratio times m a^2."""
    mass, half = 3000.0, 1.5
    vehicle = train(
        np.diag([mass, inertia_ratio * mass * half**2]),
        np.array([[1.0, half], [1.0, -half]]),
        [0.0, -2.0 * half],
    )
    return replace(vehicle, weight=np.array([-mass * GRAVITY, 0.0]))


def test_a_short_frame_stays_on_its_path() -> None:
    """J < m a^2: a blow under one wheel presses the other down."""
    found = run(system(rigid_path(-5.0, 20.0), frame(0.5), kink(KINK), SPEED), 0.0, STEP, 160)
    assert found.effective.state.status_changes == 0
    np.testing.assert_allclose(found.forces, 1500.0 * GRAVITY, rtol=1e-6)


def test_a_long_frame_lifts_its_other_wheel_which_comes_back() -> None:
    """J = 2 m a^2: the blow throws the other wheel up at a third of the kink's rate."""
    found = run(system(rigid_path(-5.0, 20.0), frame(2.0), kink(KINK), SPEED), 0.0, STEP, 160)
    first = int(np.ceil(PLACE / SPEED / STEP)) - 1
    rise = found.wheels[first + 3 :, 1] - found.wheels[first, 1]
    thrown, fall = KINK / 3.0, GRAVITY * 2.0 / 3.0
    since = STEP * np.arange(3, 12)
    np.testing.assert_allclose(rise[:9], thrown * since - 0.5 * fall * since**2, atol=4e-6)
    # While it flies the other wheel carries what turns the frame: m g J / (J + m a^2).
    np.testing.assert_allclose(found.forces[first + 3 : first + 12, 0], 2000.0 * GRAVITY, rtol=1e-6)
    # It rocks from wheel to wheel, a third of the rate each time, and comes to rest.
    np.testing.assert_allclose(found.forces[-20:], 1500.0 * GRAVITY, rtol=1e-4)
    assert found.effective.state.status_changes <= 12


# -- on a beam ---------------------------------------------------------------------------------

BEAM = BeamBridge(
    spans=(20.0,), young_modulus=25e9, second_moment=3.0, mass_per_length=30e3, elements_per_span=40
)


def mass_on_beam(mass: float, speed: float, alpha: float, step: float) -> Run:
    line = beam_bridge_line(BEAM, -5.0, 40.0)
    vehicle = train(np.array([[mass]]), np.eye(1), [0.0])
    return run(system(line, vehicle, flat, speed), alpha, step, int(19.5 / speed / step))


@cache
def expected_mass_on_beam(mass: float, speed: float, step: float):
    """Modal equations (4.58), 20 modes, from the steps of ``mass_on_beam``."""
    beam = SimplySupportedBeam(
        length=20.0, rigidity=7.5e10, mass_per_length=30e3, n_mode=20, n_span=1
    )
    crossing = Crossing(
        beam=beam,
        speed=speed,
        offsets=np.zeros(1),
        times=step * np.arange(int(19.5 / speed / step) + 1),
        points=np.array([10.0]),
    )
    return moving_masses(crossing, np.array([mass]))


@pytest.mark.slow
@pytest.mark.parametrize("speed", [60.0, 100.0])
@pytest.mark.parametrize("alpha", [0.0, -0.1])
def test_a_heavy_mass_on_a_beam_follows_the_semi_analytical_solution(
    speed: float, alpha: float
) -> None:
    """A tenth of the beam's mass on one wheel, against modal equations."""
    found = mass_on_beam(60e3, speed, alpha, STEP)
    expected = expected_mass_on_beam(60e3, speed, STEP)
    middle = found.lines[:, 2 * (2 + 20)]
    wanted = expected.displacement[1:, 0]
    assert np.abs(middle - wanted).max() < 5e-4 * np.abs(wanted).max()
    error = (found.forces[:, 0] - expected.contact_force[1:, 0]) / (60e3 * GRAVITY)
    # The modes beyond the twentieth, which only the elements have, are in the force.
    assert np.sqrt(np.mean(error**2)) < 0.015
    assert np.abs(error).max() < 0.05
    assert found.effective.state.status_changes == 0


def test_the_energy_of_a_mass_on_a_beam_is_the_work_of_gravity_and_drive() -> None:
    """Restarts at the elements' ends included: they neither give nor take what is not counted."""
    found = mass_on_beam(60e3, 40.0, 0.0, STEP)
    terms = found.balance.terms
    assert abs(terms.gap) < 2e-3 * terms.exchange
    assert terms.impact >= 0.0
