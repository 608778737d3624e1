"""Measured profiles and studies around them."""

from __future__ import annotations

import numpy as np

from solver.arrays import FloatArray
from solver.irregularities import MeasuredProfile, ProfileSample
from solver.studies import Study, check, template
from solver.studies.bounds import Finding

__all__ = ["BEAM", "KHST", "found", "measured", "named", "ramp"]

BEAM = template("sprung-mass-beam").study
KHST = template("khst-alverca-standard").study


def measured(
    x: FloatArray, left: FloatArray, right: FloatArray | float = 0.0, fade: float = 10.0
) -> MeasuredProfile:
    columns = zip(x.tolist(), left.tolist(), (left * 0.0 + right).tolist(), strict=True)
    samples = tuple(ProfileSample(position=p, left=a, right=b) for p, a, b in columns)
    return MeasuredProfile(samples=samples, fade=fade)


def ramp(x: FloatArray) -> FloatArray:
    """Off zero, sloping and bent at both ends."""
    return 2e-3 + 3e-3 * np.sin(0.4 * x + 0.5)


def named(findings: tuple[Finding, ...]) -> dict[str, Finding]:
    """Findings by their places."""
    return {".".join(map(str, finding.path)): finding for finding in findings}


def found(study: Study) -> dict[str, Finding]:
    """What a check refuses."""
    return named(check(study).errors)
