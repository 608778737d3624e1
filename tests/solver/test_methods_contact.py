"""Events at the contact: kinks, falls, release and return; laws; what an iteration costs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.arrays import FloatArray
from solver.contact.laws import ContactLaw, LinearHertz, NonlinearHertz, RigidContact
from solver.contact.path import rigid_path
from solver.errors import ConvergenceError, InputError
from solver.factorisation.blocks import FirstBlock
from solver.integrators.hht import HHT
from solver.irregularities import RailIrregularity
from solver.irregularities.harmonic import HarmonicIrregularity
from solver.methods import DirectMethod, PrescribedSpeed, Problem, Settings, StepState, Wheels
from solver.methods.vehicles import sprung_masses
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.models.subsystem import Subsystem

MASS, GRAVITY, SPEED = 1000.0, 9.81, 20.0
WEIGHT = MASS * GRAVITY


@dataclass(frozen=True)
class Kink:
    """The rail turns up by ``rate`` / speed at ``place``, and keeps a curvature after it."""

    rate: float
    place: float = 2.003
    bend: float = 0.0

    def elevation(self, position: FloatArray) -> FloatArray:
        past = np.maximum(np.asarray(position) - self.place, 0.0)
        return self.rate / SPEED * past + 0.5 * self.bend * past**2

    def slope(self, position: FloatArray) -> FloatArray:
        past = np.asarray(position) - self.place
        return np.where(past > 0.0, self.rate / SPEED + self.bend * past, 0.0)

    def curvature(self, position: FloatArray) -> FloatArray:
        return np.where(np.asarray(position) > self.place, self.bend, 0.0)


def _ground() -> Subsystem:
    empty = sparse.csr_array((0, 0))
    return Subsystem(
        name="the structure", mass=empty, damping=empty, stiffness=empty, load=np.zeros(0)
    )


def _mass_on_rigid_path(
    irregularity: RailIrregularity, law: ContactLaw, height: float | None = None
) -> Problem:
    """One mass that rolls, or is let fall from a height."""
    one, none = sparse.csr_array([[1.0]]), sparse.csr_array((1, 1))
    vehicle = Subsystem(
        name="the vehicle", mass=MASS * one, damping=none, stiffness=none,
        load=np.array([-WEIGHT]),
    )  # fmt: skip
    return Problem(
        structure=_ground(), vehicle=vehicle, law=law, irregularity=irregularity,
        wheels=Wheels(names=("wheel 1",), rows=(none, none, one), chainage=np.zeros(1)),
        path=rigid_path(np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]), 0),
        drive=PrescribedSpeed(speed=SPEED), start="static" if height is None else "consistent",
        displacement=None if height is None else np.array([height]),
    )  # fmt: skip


def _run(
    problem: Problem, alpha: float, n_step: int, dt: float = 1e-3
) -> tuple[DirectMethod, np.ndarray, np.ndarray]:
    method = DirectMethod(problem, Settings(method=HHT(alpha, dt), n_step=n_step))
    rows = [(s.contact_forces[0], s.displacement[-1]) for s in method.states()]
    force, height = np.array(rows).T
    return method, force, height


@pytest.mark.parametrize("alpha", [0.0, -0.1])
@pytest.mark.parametrize("bend", [0.0, 0.02])
def test_rigid_contact_after_a_kink(alpha: float, bend: float) -> None:
    """The force is m (g + v^2 r'') again from the third step, where Newmark would alternate."""
    method, force, _ = _run(_mass_on_rigid_path(Kink(0.05, bend=bend), RigidContact()), alpha, 200)
    kink = 101
    expected = MASS * (GRAVITY + SPEED**2 * bend)
    np.testing.assert_allclose(force[:kink], WEIGHT, rtol=1e-6)
    np.testing.assert_allclose(force[kink + 2 :], expected, rtol=0.02)
    assert method.state.status_changes == 0


@pytest.mark.parametrize("alpha", [0.0, -0.1])
def test_a_kink_that_falls_away_lets_the_wheel_fly_and_land(alpha: float) -> None:
    """It leaves at 0.05 m/s relative to the rail and lands after 2 x 0.05 / g."""
    method, force, _ = _run(_mass_on_rigid_path(Kink(-0.05), RigidContact()), alpha, 200)
    airborne = np.flatnonzero(force == 0.0)
    assert method.state.status_changes == 2
    assert airborne.size == pytest.approx(2 * 0.05 / GRAVITY / 1e-3, abs=2)
    np.testing.assert_allclose(force[airborne[-1] + 3 :], WEIGHT, rtol=0.02)


@pytest.mark.parametrize("alpha", [0.0, -0.1])
def test_a_rigid_mass_lands_once(alpha: float) -> None:
    flat = Kink(0.0)
    method, force, height = _run(_mass_on_rigid_path(flat, RigidContact(), 1e-3), alpha, 60)
    landing = int(np.argmax(force > 0.0))
    # The exact time of the fall, to the end of the step in which it ends.
    assert landing == int(np.ceil(np.sqrt(2 * 1e-3 / GRAVITY) / 1e-3))
    np.testing.assert_allclose(force[landing + 2 :], WEIGHT, rtol=0.02)
    np.testing.assert_allclose(height[landing:], 0.0, atol=1e-9)
    assert method.state.status_changes == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "law",
    [
        LinearHertz(stiffness=1e7),
        NonlinearHertz(coefficient=2e9, reference_force=WEIGHT),
    ],
)
def test_an_elastic_fall_bounces_back_to_its_height(law: ContactLaw) -> None:
    """Nothing is lost in a Hertz spring: alpha = 0, steps that resolve the impact."""
    height = 5e-3
    method, force, heights = _run(_mass_on_rigid_path(Kink(0.0), law, height), 0.0, 2600, 5e-5)
    hit = int(np.argmax(force > 0.0))
    left = hit + int(np.argmax(force[hit:] == 0.0))
    assert heights[left:].max() == pytest.approx(height, rel=0.01)
    assert method.state.status_changes <= 4


def test_bilateral_contact_holds_on() -> None:
    problem = _mass_on_rigid_path(Kink(-0.05, bend=-0.05), RigidContact())
    held = Problem(**{**problem.__dict__, "unilateral": False})
    method, force, _ = _run(held, -0.1, 200)
    np.testing.assert_allclose(force[-20:], MASS * (GRAVITY - SPEED**2 * 0.05), rtol=0.02)
    assert method.state.closed.all()
    assert method.state.status_changes == 0


# -- the nonlinear loop ---------------------------------------------------------------------


def _two_spans(law: ContactLaw) -> Problem:
    """Section 5.3.1 in small: the later masses leave the second span and return."""
    beam = plane_beams(
        PlaneBeams(spans=(20.0, 20.0), rigidity=25e9 * 3, mass_per_length=30e3,
                   elements_per_span=20),
        before=70.0, after=110.0,
    )  # fmt: skip
    places = -20.0 * np.arange(4)
    vehicle = sprung_masses(places, mass=30e3, stiffness=156.55e6)
    return Problem(
        structure=beam.structure, vehicle=vehicle.subsystem, wheels=vehicle.wheels, path=beam.path,
        law=law, drive=PrescribedSpeed(speed=115.0),
    )  # fmt: skip


HERTZ = NonlinearHertz(coefficient=7.958e10, reference_force=294300.0)


@pytest.mark.parametrize("law", [LinearHertz(stiffness=1.846e9), HERTZ])
def test_iterations_never_touch_the_large_factor(
    law: ContactLaw, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One forward and one backward pass a step, one factorisation a run, contact changing."""
    calls = {"forward": 0, "backward": 0}
    for name in calls:
        whole = getattr(FirstBlock, name)

        def counted(self: FirstBlock, *values: object, name: str = name, whole: object = whole):
            calls[name] += 1
            return whole(self, *values)  # type: ignore[operator]

        monkeypatch.setattr(FirstBlock, name, counted)
    method = DirectMethod(_two_spans(law), Settings(method=HHT(-0.1, 1e-3), n_step=850))
    states = [(s.iterations, s.status_changes) for s in method.states()]
    assert calls == {"forward": 850, "backward": 850}
    assert method.n_factorisation == 1
    assert states[-1][1] > 4
    assert max(row[0] for row in states) > 1


def test_laws_agree_where_the_spring_is_stiff() -> None:
    """A contact 1e4 times stiffer than the suspension is rigid to 1e-3 of the displacement."""
    rigid = [s.displacement[20] for s in _states(_two_spans(RigidContact()))]
    stiff = [s.displacement[20] for s in _states(_two_spans(LinearHertz(stiffness=1.5e12)))]
    hertz = NonlinearHertz(coefficient=1e15, reference_force=294300.0)
    hard = [s.displacement[20] for s in _states(_two_spans(hertz))]
    scale = np.abs(rigid).max()
    assert np.abs(np.subtract(rigid, stiff)).max() < 1e-3 * scale
    assert np.abs(np.subtract(rigid, hard)).max() < 1e-3 * scale


def _states(problem: Problem) -> list[StepState]:
    method = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=200))
    found = []
    for state in method.states():
        state.displacement = state.displacement.copy()
        found.append(state)
    return found


def test_a_step_that_does_not_settle_is_halved_and_then_reported() -> None:
    problem = _two_spans(HERTZ)
    strict = Settings(method=HHT(-0.1, 1e-3), n_step=500, most_iterations=2, most_halvings=0)
    method = DirectMethod(problem, strict)
    times: list[float] = []
    with pytest.raises(ConvergenceError) as caught:
        times.extend(state.time for state in method.states())
    assert times
    assert caught.value.wheel in problem.wheels.names
    assert caught.value.time > times[-1]
    assert "shorter time step" in str(caught.value)


@pytest.mark.slow
def test_halved_steps_lead_to_the_same_place() -> None:
    """With few iterations allowed some steps are halved; the run goes on and agrees."""
    problem = _two_spans(HERTZ)
    free = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=300))
    tight = DirectMethod(
        problem, Settings(method=HHT(-0.1, 1e-3), n_step=300, most_iterations=2, most_halvings=6)
    )
    ours = np.array([s.displacement[20] for s in free.states()])
    halved = np.array([s.displacement[20] for s in tight.states()])
    assert tight.state.halvings > 0
    assert tight.n_factorisation > 1
    assert tight.state.time == pytest.approx(0.3)
    # Shorter steps are more accurate ones: they differ by the time step's own error.
    assert np.abs(ours - halved).max() < 0.02 * np.abs(ours).max()


# -- input that cannot be --------------------------------------------------------------------


def test_runs_that_leave_the_path_are_refused_before_they_start() -> None:
    with pytest.raises(InputError, match=r"wheel 1 would end outside"):
        DirectMethod(_two_spans(HERTZ), Settings(method=HHT(0.0, 1e-3), n_step=2000))


def test_a_step_over_a_whole_element_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        DirectMethod(_two_spans(HERTZ), Settings(method=HHT(0.0, 1e-2), n_step=10))
    assert caught.value.field == "integration.time_step"
    assert "elements of 1 m" in caught.value.reason


def test_a_wheel_that_starts_outside_is_refused() -> None:
    problem = _mass_on_rigid_path(HarmonicIrregularity(amplitude=1e-3, wavelength=1.0), HERTZ)
    outside = Wheels(names=("wheel 7",), rows=problem.wheels.rows, chainage=np.array([-1.0]))
    with pytest.raises(InputError, match=r"wheel 7 would start outside its path \(0 to 100 m\)"):
        Problem(**{**problem.__dict__, "wheels": outside})


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_springs_that_are_none_are_refused(value: float) -> None:
    with pytest.raises(InputError, match=r"contact\.stiffness"):
        LinearHertz(stiffness=value)
    with pytest.raises(InputError, match=r"contact\.coefficient"):
        NonlinearHertz(coefficient=value, reference_force=1.0)
