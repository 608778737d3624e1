"""Natural modes: frequencies and shapes, their comparison, identification and damping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from solver.arrays import IntVector, Matrix, SparseMatrix, Vector
from solver.errors import InputError
from solver.factorisation import factorise

__all__ = [
    "DeckPoints",
    "GlobalShape",
    "assurance",
    "deck_points",
    "global_shapes",
    "identify",
    "modes",
    "rayleigh_damping_ratios",
]

_LIKE = 0.8
"""Assurance criterion from which a mode bears a target's name."""


def modes(
    stiffness: SparseMatrix, mass: SparseMatrix, count: int, shift: float = 0.0
) -> tuple[Vector, Matrix]:
    """Lowest undamped modes, by Lanczos on the inverse.

    Args:
        stiffness: Positive (semi-)definite, shape (n_dof, n_dof). [N/m]
        mass: Positive semi-definite; freedoms without mass are fine. [kg]
        count: Number of modes.
        shift: Eigenvalue (omega squared) below the lowest: 0 for a supported structure, negative
            for one that can move freely. [1/s2]

    Returns:
        Frequencies, ascending, shape (n_mode,) [Hz], and shapes of unit modal mass, shape
        (n_dof, n_mode).

    Raises:
        InputError: The shift is positive.
        SingularSystemError: ``stiffness - shift mass`` is singular.
    """
    if shift > 0.0:
        raise InputError("shift", shift, "must not be positive", "Use 0 or a negative number.")
    n_dof = stiffness.shape[0]
    solver = factorise((stiffness - shift * mass).tocsr(), "structure")
    inverse = LinearOperator((n_dof, n_dof), matvec=solver.solve, dtype=np.float64)
    start = mass @ np.random.default_rng(0).standard_normal(n_dof)
    values, shapes = eigsh(
        stiffness, k=count, M=mass, sigma=shift, OPinv=inverse, v0=solver.solve(start)
    )
    order = np.argsort(values)
    shapes = shapes[:, order]
    shapes /= np.sqrt(np.sum(shapes * (mass @ shapes), axis=0))
    return np.sqrt(np.maximum(values[order], 0.0)) / (2.0 * pi), shapes


def assurance(first: Matrix, second: Matrix) -> Matrix:
    """Modal assurance criterion of every pair of shapes.

    Args:
        first: Shapes in columns, shape (n_point, n).
        second: Shapes in columns, shape (n_point, m).

    Returns:
        Between 0 and 1, shape (n, m); 0 where a shape is at rest.

    References:
        Neves (2016), equation 7.1.
    """
    norms = np.outer(np.sum(first**2, axis=0), np.sum(second**2, axis=0))
    return np.divide((first.T @ second) ** 2, norms, out=np.zeros_like(norms), where=norms > 0.0)


def rayleigh_damping_ratios(
    shapes: Matrix, mass: SparseMatrix, damping: SparseMatrix, stiffness: SparseMatrix
) -> Vector:
    """Damping ratio of each shape from its modal mass, damping and stiffness.

    Exact where the damping does not couple modes, otherwise its diagonal part.

    Args:
        shapes: Shape (n_dof, n_mode).
        mass: Shape (n_dof, n_dof). [kg]
        damping: Shape (n_dof, n_dof). [N s/m]
        stiffness: Shape (n_dof, n_dof). [N/m]

    Returns:
        phi' C phi / (2 sqrt(phi' M phi phi' K phi)), shape (n_mode,). [1]
    """
    modal_mass = np.sum(shapes * (mass @ shapes), axis=0)
    modal_damping = np.sum(shapes * (damping @ shapes), axis=0)
    modal_stiffness = np.sum(shapes * (stiffness @ shapes), axis=0)
    return modal_damping / (2.0 * np.sqrt(modal_mass * modal_stiffness))


@dataclass(frozen=True, kw_only=True)
class GlobalShape:
    """A shape by which a global mode of one span is recognised.

    Attributes:
        name: For people, for example ``bending of span 2``.
        span: Number of the span, from 0.
        kind: ``bending`` (both walls together) or ``torsion`` (against each other).
        waves: Half sine waves along the span.
    """

    name: str
    span: int
    kind: Literal["bending", "torsion"]
    waves: int


@dataclass(frozen=True, kw_only=True)
class DeckPoints:
    """Points of the slab at which global modes are recognised.

    Attributes:
        nodes: Nodes of the mesh, shape (n_point,).
        span: Span of each, shape (n_point,).
        share: Way from the span's first bearings to its last, 0 to 1, shape (n_point,).
        side: 1 on the left, -1 on the right, shape (n_point,).
    """

    nodes: IntVector
    span: IntVector
    share: Vector
    side: Vector


def deck_points(
    coordinates: Matrix,
    slab_nodes: IntVector,
    span_of_slab_node: IntVector,
    bearing_positions: Matrix,
    bearing_span: IntVector,
    lateral: float,
    stations: int = 9,
) -> DeckPoints:
    """Slab nodes nearest to evenly spaced points on both sides of every span.

    The thesis's figure 7.11 measures at the foot of the ballast retaining walls: give their
    distance from the axis.

    Args:
        coordinates: Shape (n_node, 3). [m]
        slab_nodes: Shape (n_slab_node,).
        span_of_slab_node: Shape (n_slab_node,).
        bearing_positions: Shape (n_bearing, 3). [m]
        bearing_span: Shape (n_bearing,).
        lateral: Distance of the points from the axis. [m]
        stations: Points along a span and a side, its bearings' sections included.

    Returns:
        The points.
    """
    nodes, spans, shares, sides = [], [], [], []
    for span in np.unique(span_of_slab_node):
        own = slab_nodes[span_of_slab_node == span]
        bearings = bearing_positions[bearing_span == span, 0]
        start, end = bearings.min(), bearings.max()
        for side in (1.0, -1.0):
            for share in np.linspace(0.0, 1.0, stations):
                target = np.array([start + share * (end - start), side * lateral])
                distance = np.linalg.norm(coordinates[own, :2] - target, axis=1)
                node = int(own[np.argmin(distance)])
                nodes.append(node)
                spans.append(int(span))
                shares.append((coordinates[node, 0] - start) / (end - start))
                sides.append(side)
    return DeckPoints(
        nodes=np.array(nodes), span=np.array(spans), share=np.array(shares), side=np.array(sides)
    )


def global_shapes(n_span: int) -> tuple[GlobalShape, ...]:
    """First bending, first torsion and second bending of every span."""
    kinds: tuple[tuple[str, Literal["bending", "torsion"], int], ...] = (
        ("bending", "bending", 1),
        ("torsion", "torsion", 1),
        ("second bending", "bending", 2),
    )
    return tuple(
        GlobalShape(name=f"{text} of span {span + 1}", span=span, kind=kind, waves=waves)
        for text, kind, waves in kinds
        for span in range(n_span)
    )


def _target(shape: GlobalShape, points: DeckPoints) -> Vector:
    """Sine (bending) or twist (torsion) on one span, at rest elsewhere."""
    wave = np.sin(shape.waves * pi * points.share) * (points.span == shape.span)
    return wave * points.side if shape.kind == "torsion" else wave


def identify(
    shapes: Matrix,
    displacement_operator: SparseMatrix,
    points: DeckPoints,
    targets: Sequence[GlobalShape],
) -> tuple[IntVector, Vector]:
    """Finds the mode that a target shape names, over the points of the target's own span.

    It is the lowest mode that moves this span more than any other and looks like the target there
    (assurance criterion of at least 0.8); failing that, the likest of all, weighed by the span's
    share of the motion. Only the own span counts, because spans of equal length share their modes
    through track and rails.

    Args:
        shapes: In ascending order of frequency, shape (n_dof, n_mode).
        displacement_operator: Translations of the nodes, shape (3 n_node, n_dof).
        points: Where to look.
        targets: What to look for.

    Returns:
        Number of the mode for each target, and its assurance criterion over the span's points,
        shapes (n_target,).
    """
    vertical = displacement_operator[3 * points.nodes + 2] @ shapes
    spans = np.unique(points.span)
    motion = np.array([np.sum(vertical[points.span == span] ** 2, axis=0) for span in spans])
    dominant = spans[np.argmax(motion, axis=0)]
    share = motion / np.sum(motion, axis=0)
    chosen, likeness = [], []
    for target in targets:
        own = points.span == target.span
        criterion = assurance(_target(target, points)[own, None], vertical[own])[0]
        named = np.flatnonzero((criterion >= _LIKE) & (dominant == target.span))
        weighed = criterion * np.sqrt(share[spans == target.span][0])
        best = int(named[0]) if len(named) else int(np.argmax(weighed))
        chosen.append(best)
        likeness.append(float(criterion[best]))
    return np.array(chosen), np.array(likeness)
