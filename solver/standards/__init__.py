"""Criteria of standards, one a file, and the verdict that each returns."""

from __future__ import annotations

from solver.standards.deck_acceleration import (
    CutOff,
    Fastening,
    cut_off_frequency,
    decide,
    eurocode_cut_off,
    under_ballast,
)
from solver.standards.low_pass import FILTER_TEXT, low_pass
from solver.standards.verdict import NamedPeak, Peak, Place, Scope, SpanPeak, Verdict, worst

__all__ = [
    "FILTER_TEXT",
    "CutOff",
    "Fastening",
    "NamedPeak",
    "Peak",
    "Place",
    "Scope",
    "SpanPeak",
    "Verdict",
    "cut_off_frequency",
    "decide",
    "eurocode_cut_off",
    "low_pass",
    "under_ballast",
    "worst",
]
