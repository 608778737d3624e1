"""The three contact laws between wheel and rail.

*Rigid*: the wheel follows the rail. *Linear Hertz*: F = k_h d. *Nonlinear Hertz*: F = K_h d^1.5
(equation 3.66), d the compression of the contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from solver.errors import InputError

__all__ = ["ContactLaw", "LinearHertz", "NonlinearHertz", "RigidContact"]


def _require_positive(field: str, value: float, remedy: str) -> None:
    if not 0.0 < value < float("inf"):
        raise InputError(field, value, "is not a positive number", remedy)


@dataclass(frozen=True)
class RigidContact:
    """No spring: the wheel follows the rail exactly."""


@dataclass(frozen=True, kw_only=True)
class LinearHertz:
    """A linear spring.

    Attributes:
        stiffness: k_h. [N/m]

    Raises:
        InputError: The stiffness is not positive.
    """

    stiffness: float

    def __post_init__(self) -> None:
        _require_positive(
            "contact.stiffness", self.stiffness, "Use about 1.2e9 N/m, or the rigid law."
        )


@dataclass(frozen=True, kw_only=True)
class NonlinearHertz:
    """Hertz's spring F = K_h d^1.5.

    Attributes:
        coefficient: K_h. [N/m^1.5]
        reference_force: Force Q whose compression d_Q a wheel that touches down starts from, so
            that its first tangent is not zero (equation 3.70). [N]

    Raises:
        InputError: A value is not positive.
    """

    coefficient: float
    reference_force: float

    def __post_init__(self) -> None:
        _require_positive(
            "contact.coefficient", self.coefficient, "Use about 8e10 N/m^1.5, or the rigid law."
        )
        _require_positive(
            "contact.reference_force", self.reference_force, "Use the static wheel load."
        )

    @property
    def reference_compression(self) -> float:
        """d_Q = (Q / K_h)^(2/3). [m]"""
        return (self.reference_force / self.coefficient) ** (2.0 / 3.0)


ContactLaw: TypeAlias = RigidContact | LinearHertz | NonlinearHertz
"""Any of the three."""
