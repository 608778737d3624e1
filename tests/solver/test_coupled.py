"""The coupled system against a second formulation, statics, equilibrium and mirror symmetry."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

from solver.factorisation import chain
from solver.integrators import HHT
from solver.irregularities import IsolatedDefect
from solver.models.train import build_train
from solver.simulation import LINES, STRUCTURE, TRAIN, Simulation
from solver.studies import Study
from solver.system.assembled import assemble_track
from tests.solver.models_case import prepare

GRAVITY = 9.81


@pytest.fixture(scope="module")
def simulation(small_study: Study) -> Simulation:
    return prepare(small_study)


def advance(simulation: Simulation, n_step: int) -> None:
    for _ in islice(simulation.samples(), n_step + 1):
        pass


def test_static_contact_forces_carry_the_weight(simulation: Simulation, small_study: Study) -> None:
    train = build_train(small_study.train)
    forces = simulation.static.contact_forces
    assert forces.sum() == pytest.approx(train.total_mass * GRAVITY, rel=1e-6)


def monolithic_step(simulation: Simulation, times: np.ndarray) -> list[np.ndarray]:
    """Contact forces of the same steps from one sparse matrix with Lagrange rows (4.30)."""
    system, method = simulation.system, simulation.method
    track, train = assemble_track(system), system.train
    n_track, n_train = track.mass.shape[0], train.mass.shape[0]
    mass = sparse.block_diag([track.mass, sparse.csr_array(train.mass)], format="csr")
    damping = sparse.block_diag([track.damping, sparse.csr_array(train.damping)], format="csr")
    stiffness = sparse.block_diag(
        [track.stiffness, sparse.csr_array(train.stiffness)], format="csr"
    )
    factor = method.force_factor
    effective = method.a0 * mass + factor * method.a1 * damping + factor * stiffness
    static = simulation.static
    displacement = np.zeros(n_track + n_train)
    displacement[: track.n_structure] = static.structure
    for number in range(system.line.n_line):
        free = track.line_dofs[number] >= 0
        displacement[track.line_dofs[number, free]] = static.lines[free, number]
    velocity, acceleration = np.zeros_like(displacement), np.zeros_like(displacement)
    weight = np.concatenate([np.zeros(n_track), train.weight])
    rows, forces = contact_rows(simulation, track, 0.0), static.contact_forces
    found = []
    for time in times:
        internal = damping @ velocity + stiffness @ displacement
        old = internal - weight - rows.T @ forces
        inertia = method.a0 * displacement + method.a2 * velocity + method.a3 * acceleration
        viscous = method.a1 * displacement + method.a4 * velocity + method.a5 * acceleration
        load = mass @ inertia + factor * (damping @ viscous) + method.alpha * old + factor * weight
        rows = contact_rows(simulation, track, time)
        n_wheel = rows.shape[0]
        spring = -system.contact_compliance * sparse.eye_array(n_wheel)
        # Rows and columns scaled so that both blocks are of one magnitude.
        scale = 1e9
        matrix = sparse.block_array(
            [[effective / scale, -factor * rows.T], [-factor * rows, factor * spring * scale]],
            format="csc",
        )
        solution = sparse_linalg.splu(matrix).solve(
            np.concatenate([load / scale, factor * train.wheel_rest])
        )
        new, forces = solution[:-n_wheel], solution[-n_wheel:] * scale
        acceleration = method.a0 * new - inertia
        velocity = method.a1 * new - viscous
        displacement = new
        found.append(forces)
    return found


def contact_rows(simulation: Simulation, track, time: float) -> sparse.csr_array:
    """H: wheel less rail, for every wheel."""
    system = simulation.system
    nodes, rows = system.line.locate(system.wheel_positions(time))
    n_wheel = nodes.size
    dofs = 2 * nodes[:, None] + np.arange(4)
    columns = track.line_dofs[system.train.wheel_lines[:, None], dofs]
    index = np.repeat(np.arange(n_wheel), 4)
    rail = sparse.coo_array(
        (rows.ravel(), (index, columns.ravel())), shape=(n_wheel, track.mass.shape[0])
    )
    return sparse.hstack([-rail, sparse.csr_array(system.train.wheel_rows)], format="csr")


def test_partitioned_steps_equal_the_monolithic_ones(small_study: Study) -> None:
    """Pads, rails, chain table, Rayleigh shift and imbalance recursion, all at once."""
    simulation = prepare(small_study)
    step = simulation.plan.time_step
    wanted = monolithic_step(simulation, step * np.arange(1, 9))
    found = []
    for number in range(1, 9):
        simulation.integrator.advance(number * step)
        found.append(simulation.effective.state.contact_forces.copy())
    # Two factorisations of different conditioning agree to eight digits of the static load.
    np.testing.assert_allclose(found, wanted, atol=1e-8 * simulation.static.contact_forces.max())


def test_contact_forces_balance_weight_and_inertia(small_study: Study) -> None:
    """At every step: the sum of forces is weight plus inertia, as HHT weighs them; roll too."""
    defect = IsolatedDefect(amplitude=0.005, position=2.0, rail="right")
    simulation = prepare(replace(small_study, irregularity=defect))
    train = build_train(small_study.train)
    up, roll = rigid_motions(train)
    previous = np.zeros(2)
    alpha = simulation.method.alpha
    worst = 0.0
    lever = train.wheel_lateral
    for sample in islice(simulation.samples(), 1, 500):
        motion = simulation.integrator.motions[TRAIN]
        forces = simulation.effective.state.contact_forces
        inertia = np.array(
            [up @ train.mass @ motion.acceleration, roll @ train.mass @ motion.acceleration]
        )
        balance = -np.array([forces.sum() - train.total_mass * GRAVITY, (lever * forces).sum()])
        residual = inertia + (1 + alpha) * balance - alpha * previous
        worst = max(worst, float(np.abs(residual).max()))
        previous = balance
        assert sample.step > 0
    assert worst < 1e-6 * train.total_mass * GRAVITY
    assert np.abs(previous[1]) > 1.0  # the one-sided defect does excite roll


def rigid_motions(train) -> tuple[np.ndarray, np.ndarray]:
    """Freedoms of the train lifted by 1 m, and rolled by 1 rad about the track's axis."""
    up, _, _, _ = np.linalg.lstsq(bodies(train, 0), np.ones(len(train.bodies)), rcond=None)
    targets = np.concatenate([np.zeros(len(train.bodies)), np.ones(len(train.bodies))])
    rows = np.concatenate([bodies(train, 0), bodies(train, 1)])
    roll, _, _, _ = np.linalg.lstsq(rows, targets, rcond=None)
    return up, roll


def bodies(train, axis: int) -> np.ndarray:
    return np.array([body.rows[axis] for body in train.bodies])


def test_mirroring_the_defect_mirrors_every_channel(small_study: Study) -> None:
    """A defect on the left rail gives what one on the right gives, sides exchanged, to 1e-10."""
    results = {}
    for rail in ("left", "right"):
        defect = IsolatedDefect(amplitude=0.005, position=-4.0, rail=rail)
        simulation = prepare(replace(small_study, irregularity=defect))
        names = [channel.name for channel in simulation.plan.channels]
        values = np.array([s.channels for s in islice(simulation.samples(), 400)])
        results[rail] = (names, values)
    names, left = results["left"]
    _, right = results["right"]
    bearing_swap = {"01": "02", "02": "01", "03": "04", "04": "03"}
    for index, name in enumerate(names):
        mirrored = name
        if "left" in name or "right" in name:
            mirrored = name.replace("left", "#").replace("right", "left").replace("#", "right")
        if name.startswith("bearing"):
            mirrored = f"bearing {bearing_swap[name[8:10]]}{name[10:]}"
        scale = np.abs(left).max(axis=0)[index] + 1e-12
        difference = np.abs(left[:, index] - right[:, names.index(mirrored)]).max()
        assert difference <= 1e-10 * scale or difference <= 1e-10 * group_scale(names, left, name)


def group_scale(names: list[str], values: np.ndarray, name: str) -> float:
    """Greatest value of the channels of the same kind."""
    kind = name.split("/")[1]
    columns = [i for i, other in enumerate(names) if other.endswith(f"/{kind}")]
    return float(np.abs(values[:, columns]).max())


def test_one_factorisation_and_one_large_solve_a_step(
    small_study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counts of the passes over the large factor, statics included."""
    import solver.system.parts as parts

    calls = {"factorisations": 0, "forward": 0, "backward": 0}
    original = parts.condense

    class Counted:
        def __init__(self, inner) -> None:
            self._inner = inner
            self.complement, self.memory_bytes = inner.complement, inner.memory_bytes

        def forward(self, load):
            calls["forward"] += 1
            return self._inner.forward(load)

        def backward(self, interface):
            calls["backward"] += 1
            return self._inner.backward(interface)

    def counted(*arguments):
        calls["factorisations"] += 1
        return Counted(original(*arguments))

    simulation = prepare(small_study)
    monkeypatch.setattr(parts, "condense", counted)
    fresh = Simulation(
        simulation.plan, simulation.system, simulation.method, simulation._observation
    )
    assert calls["factorisations"] == 2  # one static, one effective
    calls.update(forward=0, backward=0)
    advance(fresh, 10)
    assert calls == {"factorisations": 2, "forward": 10, "backward": 10}


def test_direct_solves_replace_a_window_table_that_is_too_large(
    small_study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The compliance of the rails under the wheels is the same, looked up or solved for."""
    tabulated = prepare(small_study)
    monkeypatch.setattr(chain, "_TABLE_LIMIT", 1000)
    solved = prepare(small_study)
    assert tabulated.effective.lines.has_table
    assert not solved.effective.lines.has_table
    advance(tabulated, 5)
    advance(solved, 5)
    np.testing.assert_allclose(
        solved.effective.state.contact_forces, tabulated.effective.state.contact_forces, rtol=1e-10
    )


def test_a_train_that_stands_still_stays_at_rest(small_study: Study) -> None:
    """Nothing but rounding happens: the static start is an equilibrium."""
    simulation = prepare(small_study)
    frozen = replace(simulation.system, speed=0.0)
    still = Simulation(simulation.plan, frozen, HHT(-0.05, 5e-4), simulation._observation)
    for _ in islice(still.samples(), 50):
        pass
    forces = still.effective.state.contact_forces
    np.testing.assert_allclose(forces, still.static.contact_forces, rtol=1e-9)
    for part in (LINES, TRAIN, STRUCTURE):
        assert np.abs(still.integrator.motions[part].velocity).max() < 1e-9
