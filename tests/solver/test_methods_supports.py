"""Prescribed freedoms: supports that move, and their reactions (4.13)."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.integrate import solve_ivp

from solver.arrays import Vector
from solver.contact.path import rigid_path
from solver.errors import InputError
from solver.integrators.hht import HHT
from solver.methods import DirectMethod, PrescribedSpeed, Problem, Settings, Wheels
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.models.subsystem import Subsystem

OMEGA, AMPLITUDE = 25.0, 2e-3


def _shake(time: float) -> tuple[Vector, Vector, Vector]:
    """Both supports of one span move differently, smoothly from rest."""
    phase = OMEGA * time
    shape = np.array([1.0, -0.4]) * AMPLITUDE
    rise = 1.0 - np.cos(phase)
    return (
        shape * rise**2,
        shape * OMEGA * 2.0 * rise * np.sin(phase),
        shape * OMEGA**2 * 2.0 * (np.sin(phase) ** 2 + rise * np.cos(phase)),
    )


def _nothing() -> Subsystem:
    empty = sparse.csr_array((0, 0))
    return Subsystem(
        name="the vehicle", mass=empty, damping=empty, stiffness=empty, load=np.zeros(0)
    )


def _no_wheels(n_dof: int) -> Wheels:
    rows = sparse.csr_array((0, n_dof))
    return Wheels(names=(), rows=(rows, rows, rows), chainage=np.zeros(0))


def _beam_problem(elements: int = 3) -> Problem:
    beam = plane_beams(
        PlaneBeams(
            spans=(10.0,), rigidity=2e8, mass_per_length=2000.0, elements_per_span=elements,
            mass_damping=0.6, stiffness_damping=1e-3,
        )
    )  # fmt: skip
    structure = beam.structure
    moving = Subsystem(
        name="the structure", mass=structure.mass, damping=structure.damping,
        stiffness=structure.stiffness, load=structure.load, prescribed=structure.prescribed,
        support_motion=_shake,
    )  # fmt: skip
    return Problem(
        structure=moving, vehicle=_nothing(), wheels=_no_wheels(0), path=beam.path,
        drive=PrescribedSpeed(speed=0.0), start="consistent",
    )  # fmt: skip


def _exact(problem: Problem, times: Vector) -> tuple[np.ndarray, np.ndarray]:
    """Free displacements and reactions by DOP853 on the partitioned equations."""
    part = problem.structure
    mass, damping = part.mass.toarray(), part.damping.toarray()
    stiffness, held = part.stiffness.toarray(), part.prescribed
    free = np.setdiff1d(np.arange(part.n_dof), held)
    ff, fp = np.ix_(free, free), np.ix_(free, held)
    inverse = np.linalg.inv(mass[ff])

    def acceleration(t: float, state: Vector) -> Vector:
        a, v = np.split(state, 2)
        d, dv, ddv = _shake(t)
        load = -(mass[fp] @ ddv + damping[fp] @ dv + stiffness[fp] @ d)
        return inverse @ (load - damping[ff] @ v - stiffness[ff] @ a)

    found = solve_ivp(
        lambda t, state: np.concatenate([state[free.size :], acceleration(t, state)]),
        (0.0, float(times[-1])), np.zeros(2 * free.size), method="DOP853", rtol=1e-11, atol=1e-14,
        t_eval=times,
    )  # fmt: skip
    reactions = []
    for t, state in zip(times, found.y.T, strict=True):
        whole = np.zeros((3, part.n_dof))
        whole[:, held] = _shake(t)
        whole[0, free], whole[1, free] = np.split(state, 2)
        whole[2, free] = acceleration(t, state)
        reactions.append((mass @ whole[2] + damping @ whole[1] + stiffness @ whole[0])[held])
    return found.y[: free.size].T, np.array(reactions)


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.0, -0.1])
def test_moving_supports_and_their_reactions_are_of_order_two(alpha: float) -> None:
    problem = _beam_problem()
    errors = []
    for n_step in (400, 800):
        method = DirectMethod(problem, Settings(method=HHT(alpha, 0.4 / n_step), n_step=n_step))
        ours = [(s.time, s.displacement.copy(), s.reactions.copy()) for s in method.states()]
        times = np.array([row[0] for row in ours])
        displacement, reactions = _exact(problem, times)
        free = method.stacked.free
        found = np.array([row[1][free] for row in ours])
        forces = np.array([row[2] for row in ours])
        assert np.array_equal(
            [row[1][problem.structure.prescribed] for row in ours], [_shake(t)[0] for t in times]
        )
        errors.append(
            [np.abs(found - displacement).max() / np.abs(displacement).max(),
             np.abs(forces - reactions).max() / np.abs(reactions).max()]
        )  # fmt: skip
    orders = np.log2(np.array(errors[0]) / np.array(errors[1]))
    # Half the step, a quarter of the error; the highest mode is still settling in.
    assert orders.min() > 1.8, (orders, errors)
    assert max(errors[-1]) < 0.01


def _plain_hht(problem: Problem, alpha: float, n_step: int, weighted: bool) -> np.ndarray:
    """(4.12) to (4.14) written out with dense matrices; displacements of F at every step."""
    part, method = problem.structure, HHT(alpha, 0.4 / n_step)
    held = part.prescribed
    free = np.setdiff1d(np.arange(part.n_dof), held)
    ff, fp = np.ix_(free, free), np.ix_(free, held)
    m, c, k = part.mass.toarray(), part.damping.toarray(), part.stiffness.toarray()
    f, dt = 1.0 + alpha, method.time_step
    effective = method.a0 * m[ff] + f * (method.a1 * c[ff] + k[ff])
    a, v = np.zeros(free.size), np.zeros(free.size)
    w = np.linalg.solve(m[ff], -m[fp] @ _shake(0.0)[2])
    history = [a]
    for step in range(1, n_step + 1):
        (d0, v0, w0), (d1, v1, w1) = _shake((step - 1) * dt), _shake(step * dt)
        inertia = f * w1 - alpha * w0 if weighted else w1
        load = -m[fp] @ inertia - f * (c[fp] @ v1 + k[fp] @ d1)
        load = load + alpha * (c[ff] @ v + c[fp] @ v0 + k[ff] @ a + k[fp] @ d0)
        load = load + m[ff] @ (method.a0 * a + method.a2 * v + method.a3 * w)
        load = load + f * c[ff] @ (method.a1 * a + method.a4 * v + method.a5 * w)
        new = np.linalg.solve(effective, load)
        v, w, a = (
            method.a1 * (new - a) - method.a4 * v - method.a5 * w,
            method.a0 * (new - a) - method.a2 * v - method.a3 * w,
            new,
        )
        history.append(a)
    return np.array(history)


def test_the_thesis_takes_the_supports_acceleration_at_another_time() -> None:
    """(4.14) as printed is of order one with alpha < 0; ours, weighted, of order two."""
    problem = _beam_problem()
    exact = _exact(problem, np.linspace(0.0, 0.4, 801))[0]
    orders = {}
    for weighted in (False, True):
        errors = [
            np.abs(_plain_hht(problem, -0.1, n_step, weighted) - exact[:: 800 // n_step]).max()
            for n_step in (400, 800)
        ]
        orders[weighted] = np.log2(errors[0] / errors[1])
    assert orders[False] < 1.2
    assert orders[True] > 1.8
    method = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=400))
    last = list(method.states())[-1].displacement[method.stacked.free]
    np.testing.assert_allclose(
        last, _plain_hht(problem, -0.1, 400, True)[-1], rtol=0, atol=1e-9 * np.abs(last).max()
    )


def test_reactions_hold_up_a_wheel_at_rest() -> None:
    """A wheel at a quarter of the span: three quarters of its weight on the nearer support."""
    beam = plane_beams(PlaneBeams(spans=(10.0,), rigidity=2e8, mass_per_length=2000.0))
    vehicle = Subsystem(
        name="the vehicle", mass=sparse.csr_array([[1000.0]]), damping=sparse.csr_array((1, 1)),
        stiffness=sparse.csr_array((1, 1)), load=np.array([-9810.0]),
    )  # fmt: skip
    row, none = sparse.csr_array([[1.0]]), sparse.csr_array((1, 1))
    problem = Problem(
        structure=beam.structure, vehicle=vehicle, path=beam.path,
        wheels=Wheels(names=("wheel 1",), rows=(none, none, row), chainage=np.array([2.5])),
        drive=PrescribedSpeed(speed=0.0),
    )  # fmt: skip
    method = DirectMethod(problem, Settings(method=HHT(-0.1, 1e-3), n_step=5))
    states = list(method.states())
    np.testing.assert_allclose(states[0].reactions, [7357.5, 2452.5], rtol=1e-9)
    # Nothing moves: the start was in equilibrium.
    np.testing.assert_allclose(states[-1].reactions, [7357.5, 2452.5], rtol=1e-7)
    assert states[-1].contact_forces[0] == pytest.approx(9810.0, rel=1e-8)


def test_a_settlement_of_a_statically_determinate_beam_costs_no_force() -> None:
    beam = plane_beams(PlaneBeams(spans=(10.0,), rigidity=2e8, mass_per_length=2000.0))
    part = beam.structure

    def settled(time: float) -> tuple[Vector, Vector, Vector]:
        return np.array([0.0, -0.02]), np.zeros(2), np.zeros(2)

    structure = Subsystem(
        name="the structure", mass=part.mass, damping=part.damping, stiffness=part.stiffness,
        load=part.load, prescribed=part.prescribed, support_motion=settled,
    )  # fmt: skip
    problem = Problem(
        structure=structure, vehicle=_nothing(), wheels=_no_wheels(0), path=beam.path,
        drive=PrescribedSpeed(speed=0.0),
    )  # fmt: skip
    start = DirectMethod(problem, Settings(method=HHT(0.0, 1e-3), n_step=1)).state
    # A hinged bar turns rigidly: 1e-6 of the force that a clamped one would need.
    assert np.abs(start.reactions).max() < 1e-6 * 12 * 2e8 * 0.02 / 10.0**3
    assert (beam.mid_spans @ start.displacement[: part.n_dof])[0] == pytest.approx(-0.01)


def _with(**changes: object) -> Subsystem:
    values: dict[str, object] = {
        "name": "the structure", "mass": sparse.eye_array(2), "damping": sparse.csr_array((2, 2)),
        "stiffness": sparse.eye_array(2), "load": np.zeros(2), **changes,
    }  # fmt: skip
    return Subsystem(**values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"mass": sparse.csr_array(np.diag([1.0, -2.0]))}, "mass"),
        ({"stiffness": sparse.csr_array(np.array([[1.0, 0.5], [0.0, 1.0]]))}, "stiffness"),
        ({"damping": sparse.csr_array(np.diag([np.nan, 0.0]))}, "damping"),
        ({"stiffness": sparse.eye_array(3)}, "stiffness"),
        ({"prescribed": np.array([0, 0])}, "prescribed"),
        ({"prescribed": np.array([2])}, "prescribed"),
        ({"load": np.zeros(3)}, "load"),
    ],
)
def test_subsystems_that_cannot_be_are_refused(changes: dict[str, object], field: str) -> None:
    with pytest.raises(InputError) as caught:
        _with(**changes)
    assert caught.value.field == f"the structure.{field}"
    assert caught.value.remedy


def test_a_path_over_other_freedoms_is_refused() -> None:
    with pytest.raises(InputError, match="structure has 2"):
        Problem(
            structure=_with(), vehicle=_nothing(), wheels=_no_wheels(0),
            path=rigid_path(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), 3),
            drive=PrescribedSpeed(speed=0.0),
        )  # fmt: skip
