"""The line that wheels roll on: interpolation, places, beams in closed form, sleepers."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import scipy.sparse.linalg as sparse_linalg

from solver.contact.path import hermite
from solver.errors import InputError
from solver.integrators import HHT
from solver.modal import modes
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge, beam_bridge_line
from solver.models.beam_line import BeamLine
from solver.models.rails import ApproachTrack, rail_line
from solver.simulation import effective_coefficients
from solver.system.parts import Coefficients, LinePart

BRIDGE = BeamBridge(spans=(25.0,), elements_per_span=10)
RIGIDITY = BRIDGE.young_modulus * BRIDGE.second_moment


def bridge_line(bridge: BeamBridge = BRIDGE) -> BeamLine:
    return beam_bridge_line(bridge, -30.0, bridge.length + 30.0)


def test_hermite_functions_interpolate_every_cubic_exactly() -> None:
    """On an uneven mesh, whatever the element: value at x from values and slopes at the nodes."""
    generator = np.random.default_rng(1)
    cubic = np.polynomial.Polynomial(generator.standard_normal(4))
    start, length = generator.uniform(-5.0, 5.0, 50), generator.uniform(0.1, 3.0, 50)
    local = generator.uniform(0.0, 1.0, 50)
    slope = cubic.deriv()
    nodal = np.stack(
        [cubic(start), slope(start), cubic(start + length), slope(start + length)], axis=1
    )
    found = np.einsum("nk,nk->n", hermite(local, length), nodal)
    np.testing.assert_allclose(found, cubic(start + local * length), rtol=1e-12, atol=1e-10)


def test_places_at_nodes_joints_and_ends() -> None:
    """A wheel on a node feels that node; on a joint, the beginning of the next span."""
    bridge = BeamBridge(spans=(20.0, 10.0), elements_per_span=4)
    line = beam_bridge_line(bridge, -30.0, 60.0)
    x = np.array([-30.0, 0.0, 5.0, 20.0, 30.0, 60.0])
    nodes, rows = line.locate(x)
    for index, place in enumerate(x):
        weights = np.zeros(line.n_node)
        weights[nodes[index]] = rows[index, 0]
        weights[nodes[index] + 1] = rows[index, 2]
        assert weights.sum() == pytest.approx(1.0)
        assert line.positions @ weights == pytest.approx(place)
        assert line.connected[nodes[index]]
    # 2 nodes of ground, then 5 a span: the second span begins at node 7.
    assert nodes[3] == 7


def test_every_place_of_the_line_lies_in_a_real_element() -> None:
    line = bridge_line(BeamBridge(spans=(7.0, 11.0, 7.0), elements_per_span=3))
    x = np.concatenate([np.linspace(-30.0, 55.0, 1001), line.positions])
    nodes, rows = line.locate(x)
    assert line.connected[nodes].all()
    assert np.isfinite(rows).all()
    heights = rows[:, 0] * line.positions[nodes] + rows[:, 2] * line.positions[nodes + 1]
    slopes = rows[:, 1] + rows[:, 3]
    np.testing.assert_allclose(heights + slopes, x, atol=1e-12)  # a straight line stays straight


@pytest.mark.parametrize("x", [-30.001, 55.001])
def test_a_wheel_off_its_path_is_an_error(x: float) -> None:
    with pytest.raises(InputError, match="beyond the end of its path"):
        bridge_line().locate(np.array([0.0, x]))


@pytest.mark.parametrize(("start", "end"), [(0.0, 60.0), (-1.0, 25.0), (float("nan"), 60.0)])
def test_beams_need_ground_on_either_side(start: float, end: float) -> None:
    with pytest.raises(InputError, match="ground"):
        beam_bridge_line(BRIDGE, start, end)


def test_nodes_must_not_go_backwards() -> None:
    with pytest.raises(InputError, match="left of the node before"):
        BeamLine.build(
            positions=np.array([0.0, 2.0, 1.0]),
            rigidity=np.ones(2),
            mass_per_length=np.ones(2),
            free=np.ones((3, 2), dtype=bool),
            n_line=1,
        )


def test_simply_supported_beam_deflects_by_the_closed_form() -> None:
    """P L^3 / 48 E I at mid-span, exact with cubic elements and a node there."""
    line, load = bridge_line(), 1e5
    part = LinePart(line, Coefficients.static(), table=False)
    node, rows = line.locate(np.array([12.5]))
    column = part.columns(node, part.masked(node, rows))[:, 0]
    found = load * float(rows[0] @ column[2 * node[0] : 2 * node[0] + 4])
    assert found == pytest.approx(load * 25.0**3 / (48.0 * RIGIDITY), rel=1e-10)


def test_spans_are_beams_of_their_own() -> None:
    """A load on one span moves neither the other span nor the ground."""
    bridge = BeamBridge(spans=(20.0, 10.0), elements_per_span=4)
    line = bridge_line(bridge)
    part = LinePart(line, Coefficients.static(), table=False)
    node, rows = line.locate(np.array([9.0]))
    column = part.columns(node, part.masked(node, rows))[:, 0]
    assert np.abs(column[4:14]).max() > 0.0
    np.testing.assert_array_equal(column[14:], 0.0)
    np.testing.assert_array_equal(column[:4], 0.0)


def test_frequencies_of_a_simply_supported_beam() -> None:
    """(n pi / L)^2 sqrt(EI / m) / 2 pi, and the error of cubic elements, (n pi / 10)^4 / 1440."""
    line = bridge_line()
    free = np.flatnonzero(line.free.ravel())
    found, _ = modes(line.stiffness[free][:, free], line.mass[free][:, free], 3)
    number = np.arange(1, 4)
    wanted = (number * pi / 25.0) ** 2 * np.sqrt(RIGIDITY / BRIDGE.mass_per_length) / (2.0 * pi)
    # The next term of the error's series is some percent of it.
    np.testing.assert_allclose(found / wanted - 1.0, (number * pi / 10.0) ** 4 / 1440.0, rtol=0.05)


@pytest.mark.parametrize(
    "coefficients",
    [Coefficients.static(), effective_coefficients(HHT(-0.05, 2.5e-4))],
    ids=["static", "effective"],
)
def test_sleepers_eliminated_are_sleepers_assembled(coefficients: Coefficients) -> None:
    """One step from random histories, by the chain and by the whole sparse matrix."""
    approach = ApproachTrack(bed_stiffness=1.9e8)
    line, _ = rail_line(TrackProperties(), approach, 4, np.zeros(0), 0.0, -15.0, 0.0)
    part = LinePart(line, coefficients, table=False)
    generator = np.random.default_rng(2)
    inertia, viscous, acceleration, previous = generator.standard_normal((4, line.n_dof, 2))
    extra = 1e5 * generator.standard_normal((2 * line.n_node, 2))
    imbalance = part.begin(inertia, viscous, acceleration, previous)
    found = part.finish(extra)
    c = coefficients
    wanted_imbalance = (c.memory * previous - line.mass @ acceleration) / c.force
    load = line.mass @ inertia + c.force * (line.damping @ viscous) + c.memory * wanted_imbalance
    load[: 2 * line.n_node] += c.force * extra
    effective = c.effective(line.mass, line.damping, line.stiffness)
    wanted = sparse_linalg.splu(effective.tocsc()).solve(load)
    np.testing.assert_allclose(imbalance, wanted_imbalance, rtol=1e-12)
    np.testing.assert_allclose(found, wanted, atol=1e-10 * np.abs(wanted).max())


def test_approach_sinks_by_the_stiffness_of_its_springs() -> None:
    """All bays loaded alike, the rail stays straight: pad and bed in series."""
    track = TrackProperties(transition=False)
    approach = ApproachTrack(bed_stiffness=1.9e8)
    line, _ = rail_line(track, approach, 4, np.zeros(0), 0.0, -15.0, 0.0)
    part = LinePart(line, Coefficients.static(), table=False)
    load = np.zeros((2 * line.n_node, 2))
    load[2 * line.sleepers.nodes] = -1e4
    found = part.finish(load)
    wanted = -1e4 * (1.0 / track.pad_stiffness + 1.0 / 1.9e8)
    np.testing.assert_allclose(found[: 2 * line.n_node : 2], wanted, rtol=1e-9)
    np.testing.assert_allclose(found[2 * line.n_node :], -1e4 / 1.9e8, rtol=1e-9)


def test_seats_of_the_structure_get_no_sleeper_of_the_approach() -> None:
    seats = 0.6 * np.arange(-10, 11)
    line, seat_nodes = rail_line(
        TrackProperties(), ApproachTrack(bed_stiffness=1e8), 4, seats, 6.0, -30.0, 30.0
    )
    np.testing.assert_allclose(line.positions[seat_nodes], seats, atol=1e-12)
    beneath = line.positions[line.sleepers.nodes]
    assert not np.isin(np.round(beneath, 6), np.round(seats, 6)).any()
    assert beneath.size + seats.size == 101
