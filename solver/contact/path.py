"""The path of a wheel: consecutive target elements of any orientation in space.

Along each element two cubics run: the curve itself (its undeformed geometry) and the displacement
normal to it. Both are Hermite cubics; for the displacement they are written on the four
*generalised* values (d1, d1', d2, d2'), the normal displacement and its slope at both ends, which
a sparse matrix makes from the structure's freedoms. So a beam (cubic), the edge of a solid
(linear, or C1 cubics through the edge's nodes) and rigid ground (nothing moves) are one and the
same thing for the contact.

Pair axes (Neves 2016, section 4.2.1): tangent t in the direction of travel, normal xi_2 in the
vertical plane through t, pointing from the rail to the wheel.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, IntArray, IntVector, SparseMatrix, Vector
from solver.assembly.rows import Rows
from solver.errors import InputError

__all__ = ["Path", "PathPoint", "beam_path", "edge_path", "hermite", "join", "rigid_path"]

_UP = np.array([0.0, 0.0, 1.0])
_MOST_SEARCHES = 50
"""Newton's method needs four from the last step's place; the rest is for a first search."""


@dataclass(frozen=True, kw_only=True)
class PathPoint:
    """Geometry of the path under some wheels.

    Attributes:
        element: Target element, shape (n,).
        local: Local abscissa in [0, 1], shape (n,).
        position: Point of the undeformed curve, shape (n, 3). [m]
        tangent: Unit tangent, shape (n, 3).
        normal: Unit normal xi_2, shape (n, 3).
        curvature: Of the curve, positive where it bends towards the normal, shape (n,). [1/m]
    """

    element: IntVector
    local: Vector
    position: FloatArray
    tangent: FloatArray
    normal: FloatArray
    curvature: Vector


@dataclass(frozen=True, kw_only=True)
class Path:
    """A chain of target elements.

    Attributes:
        chainage: Distance along the path of the ends of the elements, shape (n_element + 1,). [m]
        ends: End points of each element, shape (n_element, 2, 3). [m]
        tangents: Unit tangents at both ends of each element, shape (n_element, 2, 3).
        generalised: (d1, d1', d2, d2') of each element in turn from the structure's freedoms,
            shape (4 n_element, n_dof).
    """

    chainage: Vector
    ends: FloatArray
    tangents: FloatArray
    generalised: SparseMatrix

    @cached_property
    def lengths(self) -> Vector:
        """Length of each element, shape (n_element,). [m]"""
        return np.diff(self.chainage)

    @cached_property
    def shortest_flexible(self) -> float:
        """Length of the shortest element that moves with the structure; infinite for none. [m]"""
        flexible = np.diff(self.generalised.indptr).reshape(-1, 4).any(axis=1)
        return float(self.lengths[flexible].min(initial=np.inf))

    @property
    def freedoms(self) -> IntVector:
        """Structure freedoms that the path touches, ascending."""
        return np.unique(self.generalised.indices).astype(np.int64)

    def locate(self, chainage: Vector) -> tuple[IntVector, Vector]:
        """Element and local abscissa at distances along the path.

        Raises:
            InputError: A wheel is outside the path.
        """
        outside = (chainage < self.chainage[0]) | (chainage > self.chainage[-1])
        if outside.any() or not np.isfinite(chainage).all():
            worst = float(chainage[int(np.argmax(outside))])
            raise InputError(
                "path", worst,
                f"a wheel is outside its path, which goes from {self.chainage[0]:g} to "
                f"{self.chainage[-1]:g} m", "Lengthen the path before and after the structure.",
            )  # fmt: skip
        element = np.searchsorted(self.chainage, chainage, side="right") - 1
        element = np.minimum(element, self.lengths.size - 1)
        return element, (chainage - self.chainage[element]) / self.lengths[element]

    def at(self, chainage: Vector) -> PathPoint:
        """Geometry at distances along the path; the local abscissa follows the chord.

        Raises:
            InputError: A wheel is outside the path.
        """
        element, local = self.locate(chainage)
        first, second = self._curve(element, local, 1), self._curve(element, local, 2)
        speed = np.linalg.norm(first, axis=1)
        tangent = first / speed[:, None]
        normal = _normals(tangent)
        curvature = np.einsum("nk,nk->n", second, normal) / speed**2
        return PathPoint(
            element=element,
            local=local,
            position=self._curve(element, local, 0),
            tangent=tangent,
            normal=normal,
            curvature=curvature,
        )

    @cached_property
    def _corners(self) -> FloatArray:
        """End, tangent, end, tangent of each element, shape (n_element, 4, 3)."""
        parts = [self.ends[:, 0], self.tangents[:, 0], self.ends[:, 1], self.tangents[:, 1]]
        return np.stack(parts, axis=1)

    @cached_property
    def _table(self) -> tuple[IntArray, FloatArray]:
        """Freedoms of each element and their weights in (d1, d1', d2, d2')."""
        blocks = Rows.from_sparse(self.generalised)
        columns = blocks.columns.reshape(self.lengths.size, -1)
        weights = np.zeros((self.lengths.size, 4, columns.shape[1]))
        width = blocks.columns.shape[1]
        for k in range(4):
            weights[:, k, k * width : (k + 1) * width] = blocks.values[k::4]
        return columns, weights

    def rows(self, element: IntVector, local: Vector, derivative: int = 0) -> Rows:
        """Rows of the normal displacement, or of its derivative along the path.

        Args:
            element: Shape (n,).
            local: Shape (n,).
            derivative: 0 for w, 1 for dw/ds, 2 for d2w/ds2.

        Returns:
            One row a wheel, over the structure's freedoms.
        """
        length = self.lengths[element]
        shapes = hermite(local, length, derivative) / length[:, None] ** derivative
        columns, weights = self._table
        values = np.einsum("nk,nkc->nc", shapes, weights[element])
        return Rows(columns[element], values, int(self.generalised.shape[1]))

    def nearest(self, points: FloatArray, guess: Vector) -> Vector:
        """Chainage of the points of the curve that are nearest to wheels.

        Newton's method from the guess, element by element; the search runs anew at each call.
        A wheel beyond an end gets a place beyond it.

        Args:
            points: Shape (n, 3). [m]
            guess: Chainage to start from, shape (n,). [m]

        Raises:
            InputError: The search does not end: the path bends away from under a wheel.
        """
        first, last = float(self.chainage[0]), float(self.chainage[-1])
        longest = float(self.lengths.max())
        chainage = np.clip(guess, first, last)
        for _ in range(_MOST_SEARCHES):
            point = self.at(chainage)
            offset = points - point.position
            along = np.einsum("nk,nk->n", offset, point.tangent)
            height = np.einsum("nk,nk->n", offset, point.normal)
            # Above a path that bends up the nearest point moves faster than the wheel.
            step = along / np.maximum(1.0 - height * point.curvature, 0.1)
            moved = np.clip(chainage + np.clip(step, -2 * longest, 2 * longest), first, last)
            still = np.abs(moved - chainage).max(initial=0.0) <= 1e-12 * (last - first)
            chainage = moved
            if still:
                at_end = ((chainage == first) & (along < 0)) | ((chainage == last) & (along > 0))
                return np.where(at_end, chainage + along, chainage)
        raise InputError(
            "path", chainage.tolist()[:8], "has no nearest point under a wheel",
            "Use a smoother path, or a shorter time step.",
        )  # fmt: skip

    def _curve(self, element: IntVector, local: Vector, derivative: int) -> FloatArray:
        """The curve or its derivative by distance along the chord, shape (n, 3)."""
        length = self.lengths[element]
        weights = hermite(local, length, derivative) / length[:, None] ** derivative
        return np.einsum("nk,nkx->nx", weights, self._corners[element])


def hermite(local: Vector, length: Vector, derivative: int = 0) -> FloatArray:
    """Cubic Hermite functions and their derivatives by the local abscissa.

    Args:
        local: s in [0, 1], shape (n,). [1]
        length: Element lengths, shape (n,). [m]
        derivative: 0, 1 or 2.

    Returns:
        Shape (n, 4), on (d1, d1', d2, d2').

    References:
        Neves (2016), section 4.2.1: linear rows would leave a trace of the mesh in the contact.
    """
    s = local
    if derivative == 0:
        columns = [1 - 3 * s**2 + 2 * s**3, s - 2 * s**2 + s**3, 3 * s**2 - 2 * s**3, s**3 - s**2]
    elif derivative == 1:
        columns = [6 * s**2 - 6 * s, 1 - 4 * s + 3 * s**2, 6 * s - 6 * s**2, 3 * s**2 - 2 * s]
    else:
        columns = [12 * s - 6, 6 * s - 4, 6 - 12 * s, 6 * s - 2]
    result = np.empty((s.size, 4))
    for number, column in enumerate(columns):
        result[:, number] = column
    result[:, 1::2] *= length[:, None]
    return result


def rigid_path(points: FloatArray, n_dof: int, smooth: bool = False) -> Path:
    """Rigid ground through points.

    Args:
        points: Shape (n, 3), in the direction of travel. [m]
        n_dof: Freedoms of the structure.
        smooth: Cubics with common tangents at the points, or straight lines between them.
    """
    points = _checked(points)
    generalised = sparse.csr_array((4 * (len(points) - 1), n_dof))
    return _path(points, generalised, smooth)


def beam_path(points: FloatArray, displacements: SparseMatrix, slopes: SparseMatrix) -> Path:
    """Along beam elements, one target element a beam.

    Args:
        points: Nodes, shape (n, 3). [m]
        displacements: Normal displacement of each node, shape (n, n_dof).
        slopes: Its slope along the path at each node, shape (n, n_dof).
    """
    points = _checked(points)
    count = len(points) - 1
    both = sparse.csr_array(sparse.vstack([displacements, slopes]))
    node, n = np.arange(count), len(points)
    order = np.stack([node, n + node, node + 1, n + node + 1], axis=1).ravel()
    return _path(points, both[order], smooth=False)


def edge_path(
    points: FloatArray,
    displacements: SparseMatrix,
    edge_rows: Literal["exact", "hermite"],
    middles: SparseMatrix | None = None,
) -> Path:
    """Along the edges of shells or solids, whose nodes have no slope of their own.

    Args:
        points: Nodes, the corners only where ``middles`` are given, shape (n, 3). [m]
        displacements: Normal displacement of each node, shape (n, n_dof).
        edge_rows: ``exact`` interpolates as the element's edge does, with a kink at every corner;
            ``hermite`` lays C1 cubics through the nodes, their slopes from the parabola through
            three neighbours.
        middles: Normal displacement of the middle node of each edge, for 20-node solids with
            ``exact`` rows, shape (n - 1, n_dof); for cubics list them among the nodes instead.

    Raises:
        InputError: Fewer than three nodes for cubics, or cubics with middle nodes apart.
    """
    points = _checked(points)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if edge_rows == "hermite":
        if middles is not None:
            raise InputError("edge_rows", edge_rows, "takes the middle nodes among the others",
                             "List all nodes of the edge in order.")  # fmt: skip
        return beam_path(points, displacements, _slopes(lengths) @ displacements)
    count = lengths.size
    node = np.arange(count)
    start, end = displacements[node], displacements[node + 1]
    inverse = sparse.diags_array(1.0 / lengths)
    first = last = inverse @ (end - start)
    if middles is not None:
        # Ends of the parabola through three nodes: a Hermite cubic on them is the parabola.
        first = inverse @ (4.0 * middles - 3.0 * start - end)
        last = inverse @ (start - 4.0 * middles + 3.0 * end)
    blocks = sparse.csr_array(sparse.vstack([start, first, end, last]))
    order = (np.arange(4) * count + node[:, None]).ravel()
    return _path(points, blocks[order], smooth=False)


def join(paths: list[Path]) -> Path:
    """One path of several that follow each other.

    Raises:
        InputError: A path does not begin where the one before it ends.
    """
    for number, (before, after) in enumerate(pairwise(paths)):
        gap = float(np.linalg.norm(after.ends[0, 0] - before.ends[-1, 1]))
        if gap > 1e-6 * float(before.lengths.max()):
            raise InputError(
                f"path[{number + 1}]", gap, "is the distance [m] from the end of the path before",
                "Let every part begin where the one before it ends.",
            )  # fmt: skip
    lengths = np.concatenate([path.lengths for path in paths])
    return Path(
        chainage=paths[0].chainage[0] + np.concatenate([[0.0], np.cumsum(lengths)]),
        ends=np.concatenate([path.ends for path in paths]),
        tangents=np.concatenate([path.tangents for path in paths]),
        generalised=sparse.csr_array(sparse.vstack([path.generalised for path in paths])),
    )


def _path(points: FloatArray, generalised: SparseMatrix, smooth: bool) -> Path:
    """A path through points; chainage starts at the first point's x."""
    chords = np.diff(points, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    directions = chords / lengths[:, None]
    tangents = np.stack([directions, directions], axis=1)
    if smooth:
        common = _slopes(lengths) @ points
        common /= np.linalg.norm(common, axis=1)[:, None]
        tangents = np.stack([common[:-1], common[1:]], axis=1)
    _normals(tangents.reshape(-1, 3))
    return Path(
        chainage=points[0, 0] + np.concatenate([[0.0], np.cumsum(lengths)]),
        ends=np.stack([points[:-1], points[1:]], axis=1),
        tangents=tangents,
        generalised=sparse.csr_array(generalised),
    )


def _slopes(lengths: Vector) -> SparseMatrix:
    """Slopes at the nodes of the parabolas through three neighbours, shape (n, n)."""
    if lengths.size < 2:
        raise InputError(
            "path", lengths.size, "is the number of elements: cubics need two or more",
            "Use more elements, or linear rows (edge_rows: exact).",
        )  # fmt: skip
    count = lengths.size + 1
    before, after = lengths[:-1], lengths[1:]
    both = before + after
    inner = np.arange(1, count - 1)
    rows: IntArray = np.repeat(inner, 3)
    columns = (inner[:, None] + np.array([-1, 0, 1])).ravel()
    values = np.stack(
        [-after / (before * both), (after - before) / (before * after), before / (after * both)],
        axis=1,
    ).ravel()
    matrix = sparse.lil_array((count, count))
    matrix[rows, columns] = values
    first, second = lengths[0], lengths[1]
    matrix[0, :3] = _end_slope(first, second)
    last, previous = lengths[-1], lengths[-2]
    matrix[count - 1, count - 3 :] = -_end_slope(last, previous)[::-1]
    return sparse.csr_array(matrix)


def _end_slope(first: float, second: float) -> Vector:
    """Weights of three nodes in the slope at the first of them."""
    both = first + second
    return np.array([-(first + both) / (first * both), both / (first * second),
                     -first / (both * second)])  # fmt: skip


def _normals(tangents: FloatArray) -> FloatArray:
    """Unit normals in the vertical plane through each tangent.

    Raises:
        InputError: A path is vertical.
    """
    normal = _UP - tangents[:, 2:3] * tangents
    length = np.linalg.norm(normal, axis=1)
    if length.min(initial=1.0) < 1e-6:
        raise InputError(
            "path", tangents[int(np.argmin(length))].tolist(), "is a vertical direction",
            "Give the path points that advance horizontally.",
        )  # fmt: skip
    return normal / length[:, None]


def _checked(points: FloatArray) -> FloatArray:
    """Points of a path, distinct and finite.

    Raises:
        InputError: Too few points, two in one place, or values that are not numbers.
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1:] != (3,) or len(points) < 2:
        raise InputError("path", points.shape, "is not a list of two or more points (x, y, z)",
                         "Give the points in the direction of travel.")  # fmt: skip
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if not np.isfinite(points).all() or steps.min() <= 0.0:
        worst = int(np.argmin(np.where(np.isfinite(steps), steps, -1.0)))
        raise InputError(
            f"path[{worst + 1}]", points[worst + 1].tolist(),
            "lies on the point before it, or is not finite", "Remove repeated points.",
        )  # fmt: skip
    return points
