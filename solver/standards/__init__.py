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
from solver.standards.passenger_comfort import CarPeak, Comfort, ComfortLevel, passenger_comfort
from solver.standards.slab_peaks import slab_peaks
from solver.standards.verdict import NamedPeak, Peak, Place, Scope, SpanPeak, Verdict, worst

__all__ = [
    "FILTER_TEXT",
    "CarPeak",
    "Comfort",
    "ComfortLevel",
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
    "passenger_comfort",
    "slab_peaks",
    "under_ballast",
    "worst",
]
