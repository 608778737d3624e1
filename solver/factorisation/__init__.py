"""Sparse back ends behind one small interface: factorise once, condense on an interface."""

from solver.factorisation.sparse import (
    Condense,
    CondensedFactorisation,
    Factorisation,
    arithmetic,
    back_end_name,
    condense,
    factorise,
    restored,
)

__all__ = [
    "Condense",
    "CondensedFactorisation",
    "Factorisation",
    "arithmetic",
    "back_end_name",
    "condense",
    "factorise",
    "restored",
]
