"""Sparse back ends behind one small interface: factorise once, condense on an interface."""

from solver.factorisation.sparse import (
    CondensedFactorisation,
    Factorisation,
    back_end_name,
    condense,
    factorise,
)

__all__ = ["CondensedFactorisation", "Factorisation", "back_end_name", "condense", "factorise"]
