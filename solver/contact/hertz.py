"""Hertz's theory of two elastic bodies that touch at one point.

    F = K_h delta^(3/2),   K_h = 4 pi beta E_wr / (3 sqrt(C1))                   (3.66, 3.67)

The factor pi is missing in the thesis's text but not in its numbers: without it a sphere on a
plane would not have K_h = 4/3 E_wr sqrt(R). Everything broadcasts: one contact or a whole table.

The bodies are half-spaces as far as the patch sees (patch small against the radii), linear
elastic and smooth; friction does not change the normal forces (equal materials).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Gt, Le
from numpy.typing import ArrayLike

from solver.arrays import FloatArray
from solver.contact.hertz_coefficients import HertzCoefficients, coefficients
from solver.contact.hertz_curvature import PrincipalCurvatures, RelativeCurvature, combine
from solver.errors import InputError
from solver.units import Units

__all__ = ["STEEL", "ContactPatch", "HertzContact", "Material", "contact_modulus", "hertz_contact"]


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic elastic material; steel where nothing else is said.

    Raises:
        InputError: The modulus is not positive, or Poisson's ratio outside (-1, 0.5].
    """

    young_modulus: Annotated[float, Units.young_modulus, Gt(0.0)] = 210e9
    """Young's modulus E (Neves, 2016, section 3.4)."""
    poisson_ratio: Annotated[float, Units.none, Gt(-1.0), Le(0.5)] = 0.3
    """Poisson's ratio (Neves, 2016, section 3.4)."""

    def __post_init__(self) -> None:
        if not 0.0 < self.young_modulus < np.inf:
            raise InputError(
                "young_modulus",
                self.young_modulus,
                "Young's modulus is a positive number",
                "Give it in Pa, 210e9 for steel.",
            )
        if not -1.0 < self.poisson_ratio <= 0.5:
            raise InputError(
                "poisson_ratio",
                self.poisson_ratio,
                "Poisson's ratio lies above -1 and at most 0.5",
                "Use 0.3 for steel.",
            )


STEEL = Material()
"""Wheel and rail of the thesis: E = 210 GPa, nu = 0.3."""


def contact_modulus(wheel: Material, rail: Material) -> float:
    """Modulus E_wr of two bodies in contact, 1/E_wr = sum of (1 - nu^2) / E (3.47).

    Args:
        wheel: Material of the first body.
        rail: Material of the second body.

    Returns:
        E_wr, 115.385 GPa for steel on steel. [Pa]
    """
    flexibilities = ((1.0 - body.poisson_ratio**2) / body.young_modulus for body in (wheel, rail))
    return 1.0 / sum(flexibilities)


@dataclass(frozen=True, kw_only=True)
class ContactPatch:
    """The ellipse over which two bodies press on each other.

    Attributes:
        long_semi_axis: a, along ``direction``. [m]
        short_semi_axis: b, at right angles to it. [m]
        direction: Angle from the wheel's longitudinal axis to the long axis. [rad]
        greatest_pressure: p0, at the centre; zero without load. [Pa]
    """

    long_semi_axis: FloatArray
    short_semi_axis: FloatArray
    direction: FloatArray
    greatest_pressure: FloatArray

    @property
    def area(self) -> FloatArray:
        """Area pi a b. [m2]"""
        return np.pi * self.long_semi_axis * self.short_semi_axis

    def extent(self, direction: ArrayLike) -> FloatArray:
        """Distance from the centre to the rim in any direction.

        Args:
            direction: Angle from the wheel's longitudinal axis: zero for the semi-axis along the
                track, pi/2 for the one across, if the bodies are not yawed. [rad]

        Returns:
            Broadcast shape; zero without load. [m]
        """
        turn = np.asarray(direction, float) - self.direction
        a, b = self.long_semi_axis, self.short_semi_axis
        across = np.hypot(b * np.cos(turn), a * np.sin(turn))
        loaded = across > 0.0
        return np.where(loaded, a * b / np.where(loaded, across, 1.0), 0.0)

    def pressure(self, x: ArrayLike, y: ArrayLike) -> FloatArray:
        """Pressure at a point of the patch (3.37).

        Args:
            x: Distances from the centre along the long axis, any shape. [m]
            y: Distances along the short axis, of a shape that broadcasts. [m]

        Returns:
            Broadcast shape; zero outside the ellipse. [Pa]
        """
        a, b = self.long_semi_axis, self.short_semi_axis
        loaded = self.greatest_pressure > 0.0
        a, b = np.where(loaded, a, 1.0), np.where(loaded, b, 1.0)
        inside = 1.0 - np.square(np.asarray(x) / a) - np.square(np.asarray(y) / b)
        return self.greatest_pressure * np.sqrt(np.maximum(inside, 0.0))


@dataclass(frozen=True, kw_only=True)
class HertzContact:
    """The law of one contact, or of many: force, approach, stiffness and patch.

    Attributes:
        curvature: Relative curvature of the bodies.
        modulus: E_wr (3.47). [Pa]
        coefficients: m, n and beta.
    """

    curvature: RelativeCurvature
    modulus: float
    coefficients: HertzCoefficients

    @property
    def constant(self) -> FloatArray:
        """Hertz's constant K_h (3.67, with the factor pi). [N/m^1.5]"""
        beta = self.coefficients.beta
        return 4.0 * np.pi * beta * self.modulus / (3.0 * np.sqrt(self.curvature.C1))

    def force(self, approach: ArrayLike) -> FloatArray:
        """Contact force, F = K_h delta^(3/2) (3.66).

        Args:
            approach: delta, by how much the bodies approach each other; negative is a gap. [m]

        Returns:
            Broadcast shape; zero where there is a gap. [N]
        """
        return self.constant * np.maximum(np.asarray(approach, float), 0.0) ** 1.5

    def approach(self, force: ArrayLike) -> FloatArray:
        """Approach under a force (3.70).

        Args:
            force: Compressive contact force, not negative. [N]

        Returns:
            Broadcast shape. [m]

        Raises:
            InputError: A force is negative or not a number.
        """
        return (_compression(force) / self.constant) ** (2.0 / 3.0)

    def tangent_stiffness(self, force: ArrayLike) -> FloatArray:
        """Stiffness dF/d(delta) under a force, k_h = 3/2 K_h^(2/3) Q^(1/3) (3.71).

        Args:
            force: Compressive contact force Q, not negative. [N]

        Returns:
            Broadcast shape; zero without load. [N/m]

        Raises:
            InputError: A force is negative or not a number.
        """
        return 1.5 * np.cbrt(np.square(self.constant) * _compression(force))

    def patch(self, force: ArrayLike) -> ContactPatch:
        """Contact ellipse under a force (3.38, 3.59, 3.61).

        Args:
            force: Compressive contact force, not negative. [N]

        Returns:
            The ellipse, broadcast shape; of no size without load.

        Raises:
            InputError: A force is negative or not a number.
        """
        load = _compression(force)
        scale = np.cbrt(0.75 * load / (self.curvature.C1 * self.modulus))
        a, b = self.coefficients.m * scale, self.coefficients.n * scale
        pressed = load > 0.0
        ellipse = np.where(pressed, np.pi * a * b, 1.0)
        return ContactPatch(
            long_semi_axis=a,
            short_semi_axis=b,
            direction=np.broadcast_to(self.curvature.direction, a.shape),
            greatest_pressure=np.where(pressed, 1.5 * load / ellipse, 0.0),
        )


def hertz_contact(
    wheel: PrincipalCurvatures,
    rail: PrincipalCurvatures,
    angle: ArrayLike = 0.0,
    *,
    wheel_material: Material = STEEL,
    rail_material: Material = STEEL,
) -> HertzContact:
    """Hertz's contact law of two bodies.

    Args:
        wheel: Curvatures of the first body, any shape. [1/m]
        rail: Curvatures of the second body, any shape that broadcasts. [1/m]
        angle: Angle psi from the wheel's longitudinal axis to the rail's. [rad]
        wheel_material: Material of the first body.
        rail_material: Material of the second body.

    Returns:
        The law, of the broadcast shape.

    Raises:
        InputError: The bodies do not touch at a single point.

    References:
        Hertz (1882); Neves (2016), section 3.3.
    """
    curvature = combine(wheel, rail, angle)
    return HertzContact(
        curvature=curvature,
        modulus=contact_modulus(wheel_material, rail_material),
        coefficients=coefficients(curvature.theta),
    )


def _compression(force: ArrayLike) -> FloatArray:
    """The forces as an array, none of them tension."""
    load = np.asarray(force, float)
    good = (load >= 0.0) & np.isfinite(load)
    if not np.all(good):
        raise InputError(
            "force",
            float(load[~good].flat[0]),
            "a contact force is compression, positive or zero, and finite",
            "Give zero where the bodies are apart.",
        )
    return load
