"""Spring-dampers: moment arms, local axes, ground, free directions, bad input."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.elements import beam, spring_damper
from solver.elements.null_space import NULL_SPACES, rigid_motions
from solver.errors import InputError

COEFFICIENTS = np.array([3e6, 1e6, 7e6, 2e5, 4e5, 1e5])
APART = np.array([[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]])


@pytest.mark.parametrize("distance", [0.0, 1e-3, 1.0, 1e3])
def test_rigid_motions_stay_free_whatever_the_distance(distance: float) -> None:
    nodes = np.array([[[0.4, -0.3, 0.2], [0.4, -0.3, 0.2]]])
    nodes[0, 1] += distance * np.array([0.6, 0.0, 0.8])
    axes = Rotation.from_euler("xyz", [0.3, 0.8, -0.4]).as_matrix()
    matrix = spring_damper.between(nodes, nodes[:, 0] + [0.1, 0.2, 0.3], COEFFICIENTS, axes)[0]
    scale = np.sqrt(np.diag(matrix))
    values = np.linalg.eigvalsh(matrix / np.outer(scale, scale))
    free = NULL_SPACES["spring_damper"].dimension
    # At 1 km of arm the weakest true energy is small, but 1e6 above rounding.
    assert np.all(np.abs(values[:free]) < 1e-14)
    assert values[free] > 1e-10
    motions = rigid_motions(nodes)[0]
    assert np.abs(matrix @ motions).max() < 1e-12 * np.abs(matrix).max()


def test_a_vertical_spring_between_separated_nodes_carries_its_arms() -> None:
    """Shear of 1 m: force k at the middle, and on each node its moment about that node."""
    middle = np.array([[1.0, 0.0, 0.0]])
    matrix = spring_damper.between(APART, middle, np.array([0, 0, 5e6, 0, 0, 0]))[0]
    lifted = np.zeros(12)
    lifted[8] = 1.0
    forces = (matrix @ lifted).reshape(2, 6)
    assert forces[:, 2] == pytest.approx([-5e6, 5e6])
    # About node 0: r x F = (1, 0, 0) x (0, 0, -5e6); about node 1: (-1, 0, 0) x (0, 0, 5e6).
    assert forces[:, 4] == pytest.approx([5e6, 5e6])
    total = forces[:, 3:] + np.cross(APART[0], forces[:, :3])
    assert total.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-6)


def test_the_point_decides_where_a_force_acts() -> None:
    """At node 1, a spring across the line bends node 0 alone."""
    matrix = spring_damper.between(APART, APART[:, 1], np.array([0, 0, 5e6, 0, 0, 0]))[0]
    lifted = np.zeros(12)
    lifted[8] = 1.0
    assert (matrix @ lifted).reshape(2, 6)[:, 4] == pytest.approx([1e7, 0.0])


def test_a_strut_acts_along_its_line_wherever_on_it_the_point_is() -> None:
    nodes = np.array([[[0.0, 0.0, 0.0], [1.0, 2.0, 2.0]]])
    axes, _ = beam.local_frame(nodes)
    strut = np.array([9e5, 0, 0, 0, 0, 0])
    matrices = [
        spring_damper.between(nodes, nodes[:, 0] + share * (nodes[:, 1] - nodes[:, 0]), strut, axes)
        for share in (0.0, 0.3, 1.0)
    ]
    along = np.array([1.0, 2.0, 2.0]) / 3.0
    assert matrices[0][0][:3, :3] == pytest.approx(9e5 * np.outer(along, along))
    assert np.allclose(matrices[0], matrices[1], rtol=0, atol=1e-9)
    assert np.allclose(matrices[0], matrices[2], rtol=0, atol=1e-9)
    assert np.allclose(matrices[0][0][3:6], 0.0, atol=1e-9)


def test_each_direction_of_zero_is_one_free_motion_more() -> None:
    for count in range(7):
        coefficients = np.where(np.arange(6) < count, COEFFICIENTS, 0.0)
        matrix = spring_damper.between(APART, APART[:, 0] + [0.3, 0.5, 0.1], coefficients)[0]
        assert np.linalg.matrix_rank(matrix) == count


def test_each_spring_may_have_its_own_coefficients_and_axes() -> None:
    nodes = np.repeat(APART, 2, axis=0)
    coefficients = np.stack([COEFFICIENTS, 2.0 * COEFFICIENTS])
    axes = np.stack([np.eye(3), np.eye(3)[[1, 2, 0]]])
    both = spring_damper.between(nodes, nodes[:, 0], coefficients, axes)
    for spring in range(2):
        alone = spring_damper.between(APART, APART[:, 0], coefficients[spring], axes[spring])[0]
        assert np.array_equal(both[spring], alone)
    assert np.diag(both[1])[:3] == pytest.approx(2.0 * COEFFICIENTS[[2, 0, 1]])


def test_a_spring_to_ground_holds_its_node_at_the_point() -> None:
    """As between two nodes of which the second, at the point, is held."""
    node, point = np.array([[0.5, 0.1, -0.2]]), np.array([[0.9, 0.4, 0.6]])
    grounded = spring_damper.to_ground(node, point, COEFFICIENTS)[0]
    joined = spring_damper.between(np.stack([node, point], axis=1), point, COEFFICIENTS)[0]
    assert grounded == pytest.approx(joined[:6, :6])
    assert np.linalg.eigvalsh(grounded)[0] > 0.0
    # Pushed at the point, it moves there as the springs alone say.
    force, arm = np.array([1e3, -2e3, 4e3]), (point - node)[0]
    motion = np.linalg.solve(grounded, np.concatenate([force, np.cross(arm, force)]))
    at_point = motion[:3] + np.cross(motion[3:], arm)
    assert at_point == pytest.approx(force / COEFFICIENTS[:3])
    assert motion[3:] == pytest.approx(np.zeros(3), abs=1e-12)


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
def test_a_coefficient_that_is_no_stiffness_is_refused(value: float) -> None:
    coefficients = np.where(np.arange(6) == 4, value, COEFFICIENTS)
    with pytest.raises(InputError, match="coefficient 4 of spring-damper 0"):
        spring_damper.between(APART, APART[:, 0], coefficients)


def test_skewed_local_axes_are_refused() -> None:
    with pytest.raises(InputError, match="not perpendicular unit vectors"):
        spring_damper.to_ground(APART[:, 0], APART[:, 1], COEFFICIENTS, np.eye(3) + 1e-6)
