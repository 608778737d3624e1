"""Straight two-node beam in space: Euler-Bernoulli, or Timoshenko where shear areas are given.

Six freedoms a node, in global axes. The local x axis runs from the first end to the second, and
the section's z axis lies in the plane of x and an orientation vector, on the vector's side; with
the default, a beam along the track has the global axes. An end may be offset from its node by a
rigid arm, whose transformation is exact.

With phi = 12 E I / (G A_s L^2), zero for Euler-Bernoulli, the shape functions below solve the
static equations between the nodes: nodal values are exact under loads at nodes and uniform loads,
and slender Timoshenko beams do not lock. The same functions make the mass consistent.

Frequencies converge at order four; with shear deformation at order two once the elements are
shorter than the beam is deep, because the shear strain is constant in an element.

References:
    Przemieniecki (1968), Theory of Matrix Structural Analysis, chapters 5 and 11.
    Friedman and Kosmatka (1993), An improved two-node Timoshenko beam finite element, Computers
    and Structures 47.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np
from annotated_types import Gt, Le

from solver.arrays import FloatArray, Vector
from solver.elements.rigid_link import rigid_arm
from solver.errors import InputError
from solver.units import Units

__all__ = [
    "VERTICAL",
    "BeamSection",
    "bending_mass",
    "bending_stiffness",
    "local_frame",
    "mass",
    "stiffness",
    "uniform_load",
]

VERTICAL: Vector = np.array([0.0, 0.0, 1.0])
"""Default orientation: the section's z axis is as upright as the beam's axis allows."""

_PARALLEL = 1e-6
"""Sine of the angle between axis and orientation below which the section's axes are undefined."""
_ABSCISSAE, _WEIGHTS = np.polynomial.legendre.leggauss(4)
"""Gauss points on (-1, 1), exact for the products of two cubics."""

_BAR = np.array([[1.0, -1.0], [-1.0, 1.0]])
"""Stiffness of a bar in tension or torsion, over E A / L or G J / L."""
_ROD = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
"""Consistent mass of a bar over its whole."""

# Freedoms of bending in the local planes x-y: (v, rz), and x-z: (w, -ry), node by node.
_IN_XY = np.array([1, 5, 7, 11])
_IN_XZ = np.array([2, 4, 8, 10])
_SLOPE_SIGN = np.array([1.0, -1.0, 1.0, -1.0])


@dataclass(frozen=True, kw_only=True)
class BeamSection:
    """Cross-section in its principal axes y and z through the centroid, also its shear centre.

    A shear area that is None leaves out the shear deformation along that axis (Euler-Bernoulli).

    Raises:
        InputError: A property is not a positive number.
    """

    area: Annotated[float, Units.area, Gt(0), Le(1e3)]
    """Area A."""
    second_moment_y: Annotated[float, Units.second_moment, Gt(0), Le(1e4)]
    """Second moment of area about y, the integral of z^2: bending in the x-z plane."""
    second_moment_z: Annotated[float, Units.second_moment, Gt(0), Le(1e4)]
    """Second moment of area about z, the integral of y^2: bending in the x-y plane."""
    torsion_constant: Annotated[float, Units.second_moment, Gt(0), Le(1e4)]
    """Saint-Venant's torsion constant J."""
    shear_area_y: Annotated[float, Units.area, Gt(0), Le(1e3)] | None = None
    """Area times shear coefficient for shear along y."""
    shear_area_z: Annotated[float, Units.area, Gt(0), Le(1e3)] | None = None
    """Area times shear coefficient for shear along z."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and not 0.0 < value < np.inf:
                raise InputError(
                    f"section.{field.name}", value, "it must be positive", "Use more than 0."
                )


def stiffness(
    coordinates: FloatArray,
    section: BeamSection,
    young_modulus: float,
    poisson_ratio: float,
    *,
    orientation: FloatArray = VERTICAL,
    offsets: FloatArray | None = None,
) -> FloatArray:
    """Stiffness in tension, bending in both planes and uniform torsion.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        section: The section of all the elements.
        young_modulus: Modulus of elasticity. [Pa]
        poisson_ratio: Poisson's ratio. [1]
        orientation: Any vector in the section's x-z half-plane z > 0, shape (3,) or
            (n_element, 3).
        offsets: From each node to the beam's end in global axes, shape (n_element, 2, 3). [m]

    Returns:
        Shape (n_element, 12, 12), freedoms (u, v, w, and the three rotations) node by node.

    Raises:
        InputError: An element has no length, or its orientation is parallel to its axis.
    """
    length, transform = _placement(coordinates, orientation, offsets)
    in_xy, in_xz = _shear_parameters(section, poisson_ratio, length)
    shear_modulus = young_modulus / (2.0 * (1.0 + poisson_ratio))
    local = _assembled(
        young_modulus * section.area / length[:, None, None] * _BAR,
        shear_modulus * section.torsion_constant / length[:, None, None] * _BAR,
        bending_stiffness(length, young_modulus * section.second_moment_z, in_xy),
        bending_stiffness(length, young_modulus * section.second_moment_y, in_xz),
    )
    return _to_global(local, transform)


def mass(
    coordinates: FloatArray,
    section: BeamSection,
    density: float,
    poisson_ratio: float,
    *,
    rotary_inertia: bool = True,
    orientation: FloatArray = VERTICAL,
    offsets: FloatArray | None = None,
) -> FloatArray:
    """Consistent mass; the inertia in torsion is density (I_y + I_z) per length.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        section: The section of all the elements.
        density: Density. [kg/m3]
        poisson_ratio: Poisson's ratio, which with the shear areas shapes the deflection. [1]
        rotary_inertia: Whether the section's rotation in bending has inertia, as in Timoshenko's
            and Rayleigh's beams. Torsion always has.
        orientation: As for the stiffness.
        offsets: As for the stiffness. [m]

    Returns:
        Shape (n_element, 12, 12). [kg, kg m, kg m2]

    Raises:
        InputError: The density is negative, an element has no length, or its orientation is
            parallel to its axis.
    """
    if not 0.0 <= density < np.inf:
        raise InputError("density", density, "it must not be negative", "Use 0 or more.")
    length, transform = _placement(coordinates, orientation, offsets)
    in_xy, in_xz = _shear_parameters(section, poisson_ratio, length)
    per_length = density * section.area
    rotary = density if rotary_inertia else 0.0
    polar = density * (section.second_moment_y + section.second_moment_z)
    local = _assembled(
        per_length * length[:, None, None] * _ROD,
        polar * length[:, None, None] * _ROD,
        bending_mass(length, per_length, rotary * section.second_moment_z, in_xy),
        bending_mass(length, per_length, rotary * section.second_moment_y, in_xz),
    )
    return _to_global(local, transform)


def uniform_load(
    coordinates: FloatArray,
    force_per_length: FloatArray,
    *,
    offsets: FloatArray | None = None,
) -> FloatArray:
    """Consistent nodal loads of a uniform force along the axis, for example a beam's own weight.

    Shear deformation does not change them: the end moments q L^2 / 12 follow from symmetry.

    Args:
        coordinates: Nodes, shape (n_element, 2, 3). [m]
        force_per_length: In global axes, shape (3,) or (n_element, 3). [N/m]
        offsets: From each node to the beam's end in global axes, shape (n_element, 2, 3). [m]

    Returns:
        Shape (n_element, 12). [N, N m]

    Raises:
        InputError: An element has no length.
    """
    arms = _arms(coordinates, offsets)
    axis, length = _axes(coordinates + arms)
    force = np.broadcast_to(force_per_length, axis.shape) * length[:, None]
    moment = np.cross(axis, force) * (length / 12.0)[:, None]
    ends = np.stack([np.hstack([0.5 * force, moment]), np.hstack([0.5 * force, -moment])], axis=1)
    rows = rigid_arm(arms.reshape(-1, 3)).reshape(-1, 2, 6, 6)
    return np.einsum("enij,eni->enj", rows, ends).reshape(-1, 12)


def local_frame(ends: FloatArray, orientation: FloatArray = VERTICAL) -> tuple[FloatArray, Vector]:
    """Axes of the section and lengths.

    Args:
        ends: Ends of the beams (or any two points), shape (n_element, 2, 3). [m]
        orientation: Vector in the x-z half-plane z > 0, shape (3,) or (n_element, 3).

    Returns:
        Rotation, shape (n_element, 3, 3), whose rows are the local axes in global coordinates, and
        lengths, shape (n_element,). [m]

    Raises:
        InputError: An element has no length, or its orientation is parallel to its axis.
    """
    first, length = _axes(ends)
    towards = np.broadcast_to(np.asarray(orientation, dtype=float), first.shape)
    second = np.cross(towards, first)
    sine = np.linalg.norm(second, axis=1)
    parallel = ~(sine > _PARALLEL * np.linalg.norm(towards, axis=1))
    if np.any(parallel):
        worst = int(np.argmax(parallel))
        raise InputError(
            "orientation",
            towards[worst].tolist(),
            f"it is zero or parallel to the axis of beam element {worst}",
            "Give a vector across the axis, for example (1, 0, 0) for a vertical beam.",
        )
    second /= sine[:, None]
    return np.stack([first, second, np.cross(first, second)], axis=1), length


def bending_stiffness(
    length: Vector, rigidity: FloatArray | float, shear_parameter: FloatArray | float = 0.0
) -> FloatArray:
    """Stiffness in bending in one plane.

    Args:
        length: Shape (n_element,). [m]
        rigidity: Flexural rigidity E I, one number or shape (n_element,). [N m2]
        shear_parameter: phi, one number or shape (n_element,); 0 for Euler-Bernoulli. [1]

    Returns:
        Shape (n_element, 4, 4), freedoms (deflection, rotation) node by node; without shear
        deformation the rotation is the slope.
    """
    phi = np.broadcast_to(shear_parameter, length.shape)
    a, b, c, d = np.broadcast_arrays(
        12.0, 6.0 * length, (4.0 + phi) * length**2, (2.0 - phi) * length**2
    )
    rows = [[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]]
    scale = rigidity / ((1.0 + phi) * length**3)
    return np.moveaxis(np.array(rows), 2, 0) * scale[:, None, None]


def bending_mass(
    length: Vector,
    mass_per_length: FloatArray | float,
    rotary_inertia: FloatArray | float = 0.0,
    shear_parameter: FloatArray | float = 0.0,
) -> FloatArray:
    """Consistent mass in bending in one plane.

    Args:
        length: Shape (n_element,). [m]
        mass_per_length: density A, one number or shape (n_element,). [kg/m]
        rotary_inertia: density I, one number or shape (n_element,). [kg m]
        shear_parameter: phi, one number or shape (n_element,); 0 for Euler-Bernoulli. [1]

    Returns:
        Shape (n_element, 4, 4), freedoms (deflection, rotation) node by node.
    """
    phi = np.broadcast_to(shear_parameter, length.shape)
    result = np.zeros((len(length), 4, 4))
    for abscissa, weight in zip(_ABSCISSAE, _WEIGHTS, strict=True):
        deflection, rotation = _bending_shapes(0.5 * (1.0 + abscissa), length, phi)
        for shape, inertia in ((deflection, mass_per_length), (rotation, rotary_inertia)):
            scale = 0.5 * weight * length * inertia
            result += scale[:, None, None] * shape[:, :, None] * shape[:, None, :]
    return result


def _bending_shapes(s: float, length: Vector, phi: Vector) -> tuple[FloatArray, FloatArray]:
    """Deflection and rotation at s = x / L, each of shape (n_element, 4).

    The slope less the rotation, which is the shear strain, is constant along the element.
    """
    one = np.ones_like(length)
    deflection = [
        2 * s**3 - 3 * s**2 - phi * s + 1 + phi,
        length * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
        -(2 * s**3 - 3 * s**2 - phi * s),
        length * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s),
    ]
    rotation = [
        6 * (s**2 - s) * one / length,
        3 * s**2 - (4 + phi) * s + 1 + phi,
        -6 * (s**2 - s) * one / length,
        3 * s**2 - (2 - phi) * s,
    ]
    scale = 1.0 / (1.0 + phi)[:, None]
    return np.stack(deflection, axis=1) * scale, np.stack(rotation, axis=1) * scale


def _shear_parameters(
    section: BeamSection, poisson_ratio: float, length: Vector
) -> tuple[Vector, Vector]:
    """phi = 12 E I / (G A_s L^2) in the x-y and x-z planes, each of shape (n_element,)."""
    ratio = 24.0 * (1.0 + poisson_ratio) / length**2
    planes = (
        (section.second_moment_z, section.shear_area_y),
        (section.second_moment_y, section.shear_area_z),
    )
    in_xy, in_xz = (
        np.zeros_like(length) if area is None else ratio * moment / area for moment, area in planes
    )
    return in_xy, in_xz


def _assembled(
    tension: FloatArray, torsion: FloatArray, in_xy: FloatArray, in_xz: FloatArray
) -> FloatArray:
    """Uncoupled parts into matrices in local axes, shape (n_element, 12, 12)."""
    result = np.zeros((len(tension), 12, 12))
    result[:, 0:12:6, 0:12:6] = tension
    result[:, 3:12:6, 3:12:6] = torsion
    result[:, _IN_XY[:, None], _IN_XY] = in_xy
    result[:, _IN_XZ[:, None], _IN_XZ] = in_xz * np.outer(_SLOPE_SIGN, _SLOPE_SIGN)
    return result


def _arms(coordinates: FloatArray, offsets: FloatArray | None) -> FloatArray:
    return np.broadcast_to(0.0 if offsets is None else offsets, coordinates.shape)


def _axes(ends: FloatArray) -> tuple[FloatArray, Vector]:
    """Unit vectors from the first end to the second, and lengths."""
    span = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(span, axis=1)
    if not np.all(length > 0.0):
        worst = int(np.argmin(length))
        raise InputError(
            "coordinates",
            ends[worst].tolist(),
            f"beam element {worst} has no length",
            "Check its nodes and offsets, or use a rigid link.",
        )
    return span / length[:, None], length


def _placement(
    coordinates: FloatArray, orientation: FloatArray, offsets: FloatArray | None
) -> tuple[Vector, FloatArray]:
    """Lengths, and local freedoms of the ends from global ones of the nodes (n_element, 12, 12)."""
    arms = _arms(coordinates, offsets)
    rotation, length = local_frame(coordinates + arms, orientation)
    rows = rigid_arm(arms.reshape(-1, 3)).reshape(-1, 2, 2, 3, 6)
    transform = np.zeros((len(length), 2, 2, 3, 2, 6))
    for end in range(2):
        transform[:, end, :, :, end] = rotation[:, None] @ rows[:, end]
    return length, transform.reshape(-1, 12, 12)


def _to_global(local: FloatArray, transform: FloatArray) -> FloatArray:
    result = transform.transpose(0, 2, 1) @ local @ transform
    return 0.5 * (result + result.transpose(0, 2, 1))
