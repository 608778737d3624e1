"""Runs side by side: inputs that differ, results against the first one."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict

from server.reports.comparison import ComparedRun, Comparison, compare
from server.routes.documents import channel_document
from server.routes.schemas import ChannelItem, StateName, UnitItem
from server.routes.service import Service, ServiceDependency
from server.store import RunReader, attempt_place
from solver.units import Unit

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/compare", tags=["compare"])

_MOST_RUNS = 12


class _Model(BaseModel):
    model_config = ConfigDict(use_attribute_docstrings=True)


class ComparedRunItem(_Model):
    """A run of the comparison."""

    id: str
    job: str
    name: str
    """Of its job."""
    kind: str
    index: int
    """Its place in the job's sweep."""
    runs: int
    """Of its job."""
    state: StateName
    parameters: dict[str, float]
    """SI, for example the speed. [m/s]"""
    has_histories: bool


class ComparedInput(_Model):
    """An input that is not the same in all runs."""

    pointer: str
    """JSON pointer into the study."""
    unit: UnitItem | None
    values: list[Any]
    """Of each run, SI; null where its study has no such input."""


class ComparedResult(_Model):
    """A result that at least one run has."""

    name: str
    group: str
    """``verdict``, ``comfort``, ``deck``, ``contact``, ``vehicle``, ``modes``, ``cost`` or the
    group of its history."""
    unit: UnitItem | None
    values: list[float | None]
    """Of each run, SI."""
    changes: list[float | None]
    """Of each run, relative to the first: 0.1 is ten percent more, of equal signs in size. [1]"""
    remarks: list[str]
    """Of each run."""


class CompareDocument(_Model):
    """Runs side by side; the first one is the baseline."""

    runs: list[ComparedRunItem]
    inputs: list[ComparedInput]
    results: list[ComparedResult]
    channels: list[ChannelItem]
    """Histories that can be laid over one another."""
    remarks: list[str]
    """What to know before comparing."""


@router.get("")
def compare_runs(
    service: ServiceDependency,
    run: Annotated[
        list[Annotated[str, Query(max_length=64)]],
        Query(min_length=1, max_length=_MOST_RUNS, description="Runs; the first is the baseline."),
    ],
) -> CompareDocument:
    """Inputs that differ, and results with their change against the first run."""
    runs = [_compared(service, name) for name in dict.fromkeys(run)]
    totals = service.database.runs_of([item.job.id for item in runs])
    sizes = {job: len(records) for job, records in totals.items()}
    return CompareDocument.model_validate(_document(runs, compare(runs), sizes))


def _compared(service: Service, name: str) -> ComparedRun:
    record = service.run(name)
    reader = RunReader(attempt_place(service.store, record.id, record.attempt))
    return ComparedRun(
        job=service.job(record.job),
        record=record,
        reader=reader if record.attempt and reader.has_plan else None,
        summary=reader.summary if record.state == "done" else None,
    )


def _document(runs: list[ComparedRun], found: Comparison, sizes: dict[str, int]) -> dict[str, Any]:
    return {
        "runs": [_run_item(run, sizes[run.job.id]) for run in runs],
        "inputs": [
            {"pointer": item.pointer, "unit": _unit(item.unit), "values": item.values}
            for item in found.inputs
        ],
        "results": [
            {
                "name": item.name,
                "group": item.group,
                "unit": _unit(item.unit),
                "values": item.values,
                "changes": item.changes,
                "remarks": item.remarks,
            }
            for item in found.outcomes
        ],
        "channels": [channel_document(channel) for channel in found.channels],
        "remarks": found.remarks,
    }


def _run_item(run: ComparedRun, runs: int) -> dict[str, Any]:
    return {
        "id": run.record.id,
        "job": run.job.id,
        "name": run.job.name,
        "kind": run.job.kind,
        "index": run.record.index,
        "runs": runs,
        "state": run.record.state,
        "parameters": run.record.parameters,
        "has_histories": bool(run.channels),
    }


def _unit(unit: Unit | None) -> dict[str, Any] | None:
    if unit is None or unit.symbol == "1":
        return None
    return {"symbol": unit.symbol, "display": unit.shown, "scale": unit.scale}
