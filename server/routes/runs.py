"""Runs: state, verdicts, histories, shapes."""

from __future__ import annotations

import csv
import logging
import math
from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import chain, islice
from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Response
from starlette.responses import StreamingResponse
from starlette.types import Send

from server.errors import Finding, Problem, gone_missing, shortened
from server.plots.spreadsheet import cell
from server.routes.documents import channel_document, run_document
from server.routes.schemas import ChannelList, FrameList, FrameValues, Run, VerdictList
from server.routes.service import ServiceDependency
from server.store import NotStoredError, RunReader, StoreError

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/runs/{run_id}", tags=["runs"])

_log = logging.getLogger("trainbridge.errors")

_CSV_ROWS = 20_000
"""Rows read and sent at once."""

From = Annotated[
    float | None, Query(alias="from", allow_inf_nan=False, description="Begin of the window. [s]")
]
To = Annotated[
    float | None, Query(alias="to", allow_inf_nan=False, description="End of the window. [s]")
]
Channels = Annotated[
    list[Annotated[str, Query(max_length=200)]],
    Query(max_length=16, description="More channels, as in the list of channels."),
]


@router.get("")
def read_run(run_id: str, service: ServiceDependency) -> Run:
    """A run with its summary and verdicts."""
    return Run.model_validate(run_document(service, service.run(run_id)))


@router.get("/verdicts")
def read_run_verdicts(run_id: str, service: ServiceDependency) -> VerdictList:
    """The verdicts of a run."""
    run = service.run(run_id)
    items = run.verdicts or []
    return VerdictList(items=items, judged=int(run.state == "done"), runs=1)


@router.get("/channels")
def list_channels(run_id: str, service: ServiceDependency) -> ChannelList:
    """The recorded histories."""
    reader = service.open_reader(run_id)
    plan = reader.plan
    return ChannelList.model_validate(
        {
            "items": [channel_document(channel) for channel in plan.channels],
            "samples": plan.n_sample,
            "committed": reader.committed,
            "time_step": plan.time_step,
        }
    )


@router.get(
    "/channels/{name:path}.csv",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/csv": {}}}},
)
def read_channel(
    run_id: str,
    name: str,
    service: ServiceDependency,
    begin: From = None,
    end: To = None,
    points: Annotated[
        int | None, Query(ge=2, le=1_000_000, description="Most rows: every k-th sample then.")
    ] = None,
    channels: Channels = [],  # noqa: B006 (FastAPI copies it)
) -> StreamingResponse:
    """Histories as CSV, SI: time, this channel, then any others asked for."""
    reader = service.open_reader(run_id)
    known = {channel.name: channel for channel in reader.plan.channels}
    names = list(dict.fromkeys([name, *channels]))
    for wanted in names:
        if wanted not in known:
            raise gone_missing("channel", wanted)
    window = _window(reader, begin, end)
    stride = 1 if points is None else max(1, math.ceil(len(window) / points))
    header = ["time [s]", *(f"{item} [{known[item].unit.symbol}]" for item in names)]
    lines = _csv(reader, header, names, window[::stride])
    # Before the answer begins: what is gone by now can still be said.
    begun = list(islice(lines, 2))
    return _Breakable(
        chain(begun, lines),
        media_type="text/csv; charset=utf-8",
        headers={"Content-Disposition": f'attachment; filename="{_file_name(name)}.csv"'},
    )


@router.get("/frames", responses={200: {"content": {"application/octet-stream": {}}}})
def read_frames(
    run_id: str,
    service: ServiceDependency,
    index: Annotated[
        int | None, Query(ge=0, le=10**9, description="One shape instead of the list.")
    ] = None,
    form: Annotated[
        str,
        Query(alias="format", pattern="^(binary|json)$", description="Of one shape."),
    ] = "binary",
    begin: From = None,
    end: To = None,
    points: Annotated[
        int | None, Query(ge=2, le=1_000_000, description="Most shapes: every k-th then.")
    ] = None,
) -> Any:
    """The stored shapes, or one of them.

    Binary is little-endian float32, x, y, z of each vertex [m], then bounce, roll and pitch of each
    body [m, rad, rad].
    """
    reader = service.open_reader(run_id)
    if index is None:
        return _frame_list(reader, begin, end, points)
    try:
        frame = reader.frame(index)
    except NotStoredError:
        raise gone_missing("frame", str(index)) from None
    if form == "json":
        return FrameValues(
            index=index,
            step=reader.frame_step(index),
            time=reader.frame_step(index) * reader.plan.time_step,
            displacement=frame.displacement.tolist(),
            bodies=frame.bodies.tolist(),
            velocity=None if frame.velocity is None else frame.velocity.tolist(),
            acceleration=None if frame.acceleration is None else frame.acceleration.tolist(),
        )
    values = np.concatenate([frame.displacement.ravel(), frame.bodies.ravel()])
    return Response(
        values.astype("<f4").tobytes(),
        media_type="application/octet-stream",
        headers={"Content-Disposition": f'attachment; filename="frame-{index}.f32"'},
    )


def _frame_list(
    reader: RunReader, begin: float | None, end: float | None, points: int | None
) -> FrameList:
    plan = reader.plan
    interval = plan.time_step * plan.frame_stride
    low, high = _bounds(begin, end)
    first = max(0, math.ceil(low / interval - 1e-9)) if math.isfinite(low) else 0
    last = reader.committed_frames - 1
    last = min(last, math.floor(high / interval + 1e-9)) if math.isfinite(high) else last
    chosen = range(first, last + 1)
    chosen = chosen[:: 1 if points is None else max(1, math.ceil(len(chosen) / points))]
    steps = [(index, reader.frame_step(index)) for index in chosen]
    return FrameList.model_validate(
        {
            "items": [
                {"index": index, "step": step, "time": step * plan.time_step}
                for index, step in steps
            ],
            "frames": plan.n_frame,
            "vertices": int(plan.geometry.vertices.shape[0]),
            "bodies": len(plan.geometry.bodies),
        }
    )


def _window(reader: RunReader, begin: float | None, end: float | None) -> range:
    """Committed samples of a time window."""
    low, high = _bounds(begin, end)
    step, committed = reader.plan.time_step, reader.committed
    first = max(0, math.ceil(low / step - 1e-9)) if math.isfinite(low) else 0
    last = min(committed, math.floor(high / step + 1e-9) + 1) if math.isfinite(high) else committed
    return range(first, max(first, last))


def _bounds(begin: float | None, end: float | None) -> tuple[float, float]:
    low = -math.inf if begin is None else begin
    high = math.inf if end is None else end
    if low > high:
        finding = Finding(
            pointer="from",
            value=shortened(begin),
            reason="does not come before 'to'",
            remedy="Give a window that has a length.",
        )
        raise Problem(422, "Unusable values", "The window is empty.", errors=[finding])
    return low, high


class _Breakable(StreamingResponse):
    """An answer that breaks off where what it sends was removed: nobody takes a part for all."""

    async def stream_response(self, send: Send) -> None:
        """Without the last message the server closes the connection."""
        try:
            await super().stream_response(send)
        except (NotStoredError, StoreError) as error:
            _log.warning("an answer breaks off: %s", error)


def _csv(
    reader: RunReader, header: Sequence[str], names: Sequence[str], window: range
) -> Iterator[str]:
    yield _line([cell(item) for item in header])
    rows_at_once = max(1, _CSV_ROWS // window.step) * window.step
    for start in range(window.start, window.stop, rows_at_once):
        stop = min(start + rows_at_once, window.stop)
        times = reader.times(start, stop)[:: window.step]
        rows = reader.channel_rows(names, start, stop)[:: window.step]
        # Numbers need no quotes: the writer would take as long as all the rest.
        table = np.column_stack([times, rows]).tolist()
        yield "".join([",".join(map(repr, row)) + "\r\n" for row in table])


def _line(cells: Sequence[str]) -> str:
    buffer = StringIO()
    csv.writer(buffer).writerow(cells)
    return buffer.getvalue()


def _file_name(name: str) -> str:
    kept = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "-" for c in name)
    return kept[:100] or "channel"
