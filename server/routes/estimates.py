"""Estimates as the API sends them."""

from __future__ import annotations

from dataclasses import asdict

from server.routes.schemas import EstimateItem
from server.routes.service import Service
from solver.studies import Estimate, JobKind

__all__ = ["scaled_estimate"]


def scaled_estimate(service: Service, kind: JobKind, estimate: Estimate) -> EstimateItem:
    """What a study costs, its time corrected by past runs that were alike."""
    scaled = service.past_runs.scaled(kind, estimate)
    return EstimateItem(**asdict(scaled.estimate), basis=scaled.basis)
