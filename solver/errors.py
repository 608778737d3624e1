"""Every error that the solver raises on purpose.

SolverError
|-- InputError             a value that cannot be used: field, value, reason, remedy
|-- SingularSystemError    a structure or train that can move without resistance
|-- ConvergenceError       the contact search found no state: time, wheel, residual
`-- UnstableError          the response grew beyond anything physical: time, quantity
"""

from __future__ import annotations

from typing import Any

__all__ = [
    "ConvergenceError",
    "InputError",
    "SingularSystemError",
    "SolverError",
    "UnstableError",
]


class SolverError(Exception):
    """Base of the solver's own errors; the text is meant for an engineer."""


class InputError(SolverError):
    """A value that cannot be used.

    Attributes:
        field: Dotted path of the field, for example ``train.wheelbase``.
        value: The value as given.
        reason: Why it cannot be used.
        remedy: What to try.
    """

    def __init__(self, field: str, value: Any, reason: str, remedy: str) -> None:
        self.field = field
        self.value = value
        self.reason = reason
        self.remedy = remedy
        super().__init__(f"{field} = {value!r}: {reason}. {remedy}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.field, self.value, self.reason, self.remedy)


class SingularSystemError(SolverError):
    """A part that can move without resistance."""

    def __init__(self, part: str, detail: str) -> None:
        self.part = part
        self.detail = detail
        super().__init__(f"{part} is not supported: {detail}. Check its supports and connections.")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.part, self.detail)


class ConvergenceError(SolverError):
    """The contact search found no admissible state."""

    def __init__(self, time: float, wheel: str, residual: float) -> None:
        self.time = time
        self.wheel = wheel
        self.residual = residual
        super().__init__(
            f"the contact search did not settle at t = {time:.6g} s ({wheel}, residual "
            f"{residual:.3g}). Try a shorter time step or a smoother irregularity."
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.time, self.wheel, self.residual)


class UnstableError(SolverError):
    """The response left the range of anything physical."""

    def __init__(self, time: float, quantity: str) -> None:
        self.time = time
        self.quantity = quantity
        super().__init__(
            f"{quantity} is not a finite number at t = {time:.6g} s: the integration broke down. "
            "Try a shorter time step; if it persists, check the model's supports and masses."
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.time, self.quantity)
