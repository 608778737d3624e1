"""The geometry of two surfaces that touch: how fast the gap between them opens.

Near the point of contact the gap is h = A x^2 + B y^2 (equation 3.24), x along the direction in
which it opens most slowly. It comes from the curvature tensors of both surfaces: wheel plus rail,
turned into the same axes, is the tensor of 2 h; A and B are half its principal values.

Curvatures are positive for convex bodies (the centre of curvature lies inside the body): a wheel's
concave fillet has a negative one, a straight rail has zero along the track.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import FloatArray
from solver.errors import InputError

__all__ = ["PrincipalCurvatures", "RelativeCurvature", "combine"]

_ROUNDING = 8.0 * np.finfo(float).eps
"""Sums of curvatures smaller than this part of their terms are zero but for rounding."""


@dataclass(frozen=True, kw_only=True)
class PrincipalCurvatures:
    """Principal curvatures of one surface at the point of contact, positive where convex.

    Attributes:
        longitudinal: Curvature 1/R' in the section along the track. [1/m]
        lateral: Curvature 1/R'' in the section across the track. [1/m]
    """

    longitudinal: ArrayLike
    lateral: ArrayLike

    def along(self, direction: FloatArray) -> FloatArray:
        """Curvature of the section in any direction (Euler's theorem).

        Args:
            direction: Angle from the longitudinal axis. [rad]

        Returns:
            Broadcast shape. [1/m]
        """
        first, second = np.asarray(self.longitudinal, float), np.asarray(self.lateral, float)
        return np.asarray(first * np.cos(direction) ** 2 + second * np.sin(direction) ** 2)


@dataclass(frozen=True, kw_only=True)
class RelativeCurvature:
    """The gap h = A x^2 + B y^2 between two surfaces that touch at one point, 0 < A <= B.

    Attributes:
        A: Coefficient along the ellipse's long axis (3.31). [1/m]
        B: Coefficient along its short axis (3.35). [1/m]
        direction: Angle from the wheel's longitudinal axis to the long axis, positive the way
            ``combine`` counts the angle to the rail's axis; in (-pi/2, pi/2], zero for a circle.
            [rad]
    """

    A: FloatArray
    B: FloatArray
    direction: FloatArray

    @property
    def C1(self) -> FloatArray:  # noqa: N802 (letter of the equation)
        """Sum A + B (3.17). [1/m]"""
        return self.A + self.B

    @property
    def C2(self) -> FloatArray:  # noqa: N802 (letter of the equation)
        """Difference A - B, never positive (3.18). [1/m]"""
        return self.A - self.B

    @property
    def theta(self) -> FloatArray:
        """Auxiliary angle, cos(theta) = -C2 / C1 (3.27), in (0, pi/2]. [rad]

        From tan^2(theta/2) = A / B (3.31, 3.35), which unlike the arc cosine keeps all its digits
        for small angles.
        """
        return np.asarray(2.0 * np.arctan(np.sqrt(self.A / self.B)))


def combine(
    wheel: PrincipalCurvatures, rail: PrincipalCurvatures, angle: ArrayLike = 0.0
) -> RelativeCurvature:
    """Relative curvature of two surfaces at their point of contact.

    Args:
        wheel: Curvatures of the first body, any shape. [1/m]
        rail: Curvatures of the second body, any shape that broadcasts. [1/m]
        angle: Angle psi from the wheel's longitudinal axis to the rail's (zero without yaw). [rad]

    Returns:
        The gap's coefficients and the direction of its long axis, broadcast shape.

    Raises:
        InputError: A curvature is not finite, or the bodies do not touch at a single point: in
            some direction they fit each other (line contact) or one enters the other.

    References:
        Neves (2016), equations 3.14 to 3.35; the tensor form gives the same A and B, without the
        cancellation of 3.28 when C2 is close to -C1.
    """
    h11, h22, h12, largest = _tensor(wheel, rail, np.asarray(angle, float))
    C1 = 0.5 * (h11 + h22)
    C2 = -0.5 * np.hypot(h11 - h22, 2.0 * h12)
    # What is of rounding size (axes at right angles) must not turn a circle's axes.
    skew, stretch = (
        np.where(np.abs(term) <= _ROUNDING * largest, 0.0, term) for term in (-2.0 * h12, h22 - h11)
    )
    direction = np.asarray(0.5 * np.arctan2(skew, stretch))
    direction = np.where(direction <= -0.5 * np.pi, 0.5 * np.pi, direction)
    B = 0.5 * (C1 - C2)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Determinant over the other principal value; B = 0 is refused below.
        A = np.where(C1 > 0.0, 0.25 * (h11 * h22 - h12**2) / B, 0.5 * (C1 + C2))
    _check_contact(A, direction, largest, wheel, rail, np.asarray(angle, float))
    # Rounding may leave A one last digit above B for a circle.
    return RelativeCurvature(A=np.minimum(A, B), B=B, direction=direction)


def _tensor(
    wheel: PrincipalCurvatures, rail: PrincipalCurvatures, angle: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Curvature tensor (11, 22, 12) of 2 h in the wheel's axes, and the greatest term in it."""
    given = {
        "wheel.longitudinal": np.asarray(wheel.longitudinal, float),
        "wheel.lateral": np.asarray(wheel.lateral, float),
        "rail.longitudinal": np.asarray(rail.longitudinal, float),
        "rail.lateral": np.asarray(rail.lateral, float),
        "angle": angle,
    }
    for field, values in given.items():
        if not np.all(np.isfinite(values)):
            value = float(values[~np.isfinite(values)].flat[0])
            raise InputError(
                field, value, "it is not a finite number", "Give the curvature, zero for a plane."
            )
    w1, w2, r1, r2, _ = np.broadcast_arrays(*given.values())
    cosine, sine = np.cos(angle), np.sin(angle)
    h11 = w1 + (r1 * cosine**2 + r2 * sine**2)
    h22 = w2 + (r1 * sine**2 + r2 * cosine**2)
    h12 = (r1 - r2) * sine * cosine
    return h11, h22, h12, np.max(np.abs([w1, w2, r1, r2]), axis=0)


def _check_contact(
    A: FloatArray,
    direction: FloatArray,
    largest: FloatArray,
    wheel: PrincipalCurvatures,
    rail: PrincipalCurvatures,
    angle: FloatArray,
) -> None:
    """Refuses bodies whose gap does not open in every direction."""
    bad = _ROUNDING * largest >= A
    if not np.any(bad):
        return
    first = tuple(int(i) for i in np.argwhere(bad)[0])
    place = f" (entry {', '.join(map(str, first))})" if first else ""
    of_wheel = float(np.broadcast_to(wheel.along(direction), A.shape)[first])
    of_rail = float(np.broadcast_to(rail.along(direction - angle), A.shape)[first])
    degrees = float(np.degrees(direction[first]))
    axis = {0.0: "longitudinal", 90.0: "lateral"}.get(degrees, f"at {degrees:.6g} degrees")
    relative = of_wheel + of_rail
    raise InputError(
        f"curvature {axis}{place}",
        relative,
        f"the bodies do not touch at one point: wheel {of_wheel:.6g} 1/m and rail {of_rail:.6g} "
        "1/m must add up to more than zero",
        "Curvatures are positive for convex bodies; a concave one must be flatter than the body "
        "that it touches. Check their signs.",
    )
