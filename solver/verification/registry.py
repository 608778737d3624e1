"""All verification cases, in the order of the thesis."""

from __future__ import annotations

from solver.errors import InputError
from solver.verification import (
    cycloid,
    energy_balance,
    fast_engine,
    fifty_masses,
    hertz_theory,
    inclined,
    moving_mass,
    sprung_mass,
    time_integration,
    two_spans,
    two_spans_solid,
    two_springs,
    wheel_rail,
)
from solver.verification.case import Case

__all__ = ["case", "cases"]


def cases() -> tuple[Case, ...]:
    """Every case."""
    return (
        two_springs.CASE,
        hertz_theory.CASE,
        wheel_rail.CASE,
        time_integration.CASE,
        *sprung_mass.CASES,
        moving_mass.CASE,
        *fifty_masses.CASES,
        *two_spans.CASES,
        *energy_balance.CASES,
        *two_spans_solid.CASES,
        inclined.CASE,
        cycloid.CASE,
        *fast_engine.CASES,
    )


def case(name: str) -> Case:
    """One case.

    Raises:
        InputError: There is none of that name.
    """
    found = {item.name: item for item in cases()}
    if name not in found:
        raise InputError("case", name, "is not a verification case",
                         f"Choose of {', '.join(found)}.")  # fmt: skip
    return found[name]
