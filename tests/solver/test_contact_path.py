"""The path of a wheel: geometry, rows, search, errors."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.contact.path import Path, beam_path, edge_path, hermite, join, rigid_path
from solver.errors import InputError


def _nodes(x: np.ndarray) -> np.ndarray:
    return np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)


def _edge(x: np.ndarray, rows: str) -> Path:
    return edge_path(_nodes(x), sparse.csr_array(sparse.eye_array(x.size)), rows)  # type: ignore[arg-type]


def test_hermite_functions_are_the_cubic_of_their_ends() -> None:
    local, length = np.linspace(0.0, 1.0, 11), np.full(11, 2.5)
    x = 2.5 * local
    cubic, slope = 1.0 - 2.0 * x + 0.3 * x**3, -2.0 + 0.9 * x**2
    ends = np.array([1.0, -2.0, cubic[-1], slope[-1]])
    np.testing.assert_allclose(hermite(local, length) @ ends, cubic, atol=1e-14)
    np.testing.assert_allclose(hermite(local, length, 1) @ ends / 2.5, slope, atol=1e-14)
    np.testing.assert_allclose(hermite(local, length, 2) @ ends / 2.5**2, 1.8 * x, atol=1e-13)


def test_exact_edges_are_linear_and_cubic_edges_smooth() -> None:
    x = np.array([0.0, 1.0, 2.5, 3.0, 4.5])
    parabola = x**2
    places = np.array([0.3, 1.9, 2.7, 4.2])
    linear, smooth = _edge(x, "exact"), _edge(x, "hermite")
    np.testing.assert_allclose(
        linear.rows(*linear.locate(places)).dot(parabola), np.interp(places, x, parabola)
    )
    # Slopes from the parabola through three nodes: a parabola is reproduced exactly.
    for derivative, expected in ((0, places**2), (1, 2 * places), (2, 2.0 + 0 * places)):
        rows = smooth.rows(*smooth.locate(places), derivative)
        np.testing.assert_allclose(rows.dot(parabola), expected, atol=1e-12)


def test_exact_edges_of_quadratic_elements_are_parabolas() -> None:
    """Three corners, two middle nodes: each element's own quadratic shape functions."""
    corners, middles = np.array([0.0, 2.0, 5.0]), np.array([1.0, 3.5])
    identity = sparse.csr_array(sparse.eye_array(5))
    path = edge_path(_nodes(corners), identity[:3], "exact", identity[3:])
    values = np.random.default_rng(2).normal(size=5)
    places = np.array([0.4, 1.7, 2.5, 4.9])
    for place in places:
        k = int(place > 2.0)
        nodes = np.array([corners[k], middles[k], corners[k + 1]])
        parabola = np.polynomial.Polynomial.fit(nodes, values[[k, 3 + k, k + 1]], 2)
        found = path.rows(*path.locate(np.array([place]))).dot(values)[0]
        assert found == pytest.approx(float(parabola(place)), rel=1e-12)
    with pytest.raises(InputError, match="List all nodes"):
        edge_path(_nodes(corners), identity[:3], "hermite", identity[3:])


def test_cubic_edges_have_no_kink_at_their_nodes() -> None:
    x = np.linspace(0.0, 4.0, 9)
    path, values = _edge(x, "hermite"), np.random.default_rng(0).normal(size=9)
    before, after = np.array([1.5 - 1e-9]), np.array([1.5 + 1e-9])
    slopes = [path.rows(*path.locate(place), 1).dot(values)[0] for place in (before, after)]
    assert slopes[0] == pytest.approx(slopes[1], abs=1e-6)


def test_beam_rows_join_across_rigid_ground() -> None:
    n_dof = 4
    identity = sparse.csr_array(sparse.eye_array(n_dof))
    span = beam_path(_nodes(np.array([0.0, 2.0])), identity[[0, 2]], identity[[1, 3]])
    path = join(
        [rigid_path(_nodes(np.array([-5.0, 0.0])), n_dof), span,
         rigid_path(_nodes(np.array([2.0, 7.0])), n_dof)]
    )  # fmt: skip
    rows = path.rows(*path.locate(np.array([-1.0, 1.0, 6.0]))).dense()
    np.testing.assert_allclose(rows, [[0, 0, 0, 0], [0.5, 0.25, 0.5, -0.25], [0, 0, 0, 0]])
    np.testing.assert_array_equal(path.freedoms, np.arange(4))


def test_inclined_path_has_its_own_axes() -> None:
    path = rigid_path(np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 4.0], [6.0, 0.0, 8.0]]), 0)
    point = path.at(np.array([7.5]))
    np.testing.assert_allclose(point.position, [[4.5, 0.0, 6.0]])
    np.testing.assert_allclose(point.tangent, [[0.6, 0.0, 0.8]])
    np.testing.assert_allclose(point.normal, [[-0.8, 0.0, 0.6]])
    skew = rigid_path(np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]), 0).at(np.array([0.5]))
    np.testing.assert_allclose(skew.normal, [[0.0, 0.0, 1.0]])


def test_curved_path_knows_its_curvature_and_nearest_points() -> None:
    angle = np.linspace(-0.6, 0.6, 25)
    radius = 30.0
    points = np.stack([radius * np.sin(angle), 0 * angle, -radius * np.cos(angle)], axis=1)
    path = rigid_path(points, 0, smooth=True)
    at = path.at(np.linspace(-10.0, 10.0, 7))
    # Cubics of 1.5 m on a radius of 30 m: curvature to their second order.
    np.testing.assert_allclose(at.curvature, 1.0 / radius, rtol=5e-3)
    wheels = at.position + 0.7 * at.normal
    found = path.nearest(wheels, np.full(7, 0.1))
    np.testing.assert_allclose(path.at(found).position, at.position, atol=1e-9)


def test_wheels_outside_are_refused_by_name_of_the_place() -> None:
    path = rigid_path(_nodes(np.array([0.0, 10.0])), 0)
    with pytest.raises(InputError, match=r"goes from 0 to 10 m"):
        path.locate(np.array([5.0, 10.1]))
    # A search from a wheel that has left finds its place beyond the end.
    np.testing.assert_allclose(path.nearest(np.array([[12.0, 0, 1.0]]), np.array([9.0])), [12.0])


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        ([[0.0, 0.0, 0.0]], "two or more"),
        ([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]], "on the point before"),
        ([[0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]], "not finite"),
        ([[0.0, 0.0, 0.0], [0.0, 0.0, 3.0]], "vertical"),
    ],
)
def test_paths_that_are_none_are_refused(points: list[list[float]], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        rigid_path(np.array(points), 0)


def test_paths_that_do_not_meet_are_refused() -> None:
    first = rigid_path(_nodes(np.array([0.0, 1.0])), 0)
    with pytest.raises(InputError, match=r"path\[1\]"):
        join([first, rigid_path(_nodes(np.array([1.1, 2.0])), 0)])


def test_cubics_through_two_nodes_are_refused() -> None:
    with pytest.raises(InputError, match="cubics need two"):
        _edge(np.array([0.0, 1.0]), "hermite")
