"""Pictures in space: the moment that decides, or the first shapes of a modal analysis."""

from __future__ import annotations

from dataclasses import replace

from server.reports.figures import Illustration
from server.reports.material import Material, RunMaterial
from server.store import NotStoredError, RunReader
from server.viewer import Still, StillOptions, read_still
from server.viewer.captions import SEPARATOR
from server.viewer.colour_map import ColourBar
from solver.results import Geometry

__all__ = ["MODES_SHOWN", "report_stills"]

MODES_SHOWN = 4
"""The first shapes of a modal analysis; the table of frequencies has all of them."""
_WIDTH, _HEIGHT = 1440, 560
"""A bridge is long and low. [pixel]"""
_TRAIN_SCALE = 1.0
"""Greatest displacement of a train's shape as drawn: of 100 m seen from the side less is not
seen. [m]"""


def report_stills(material: Material) -> dict[str, Illustration]:
    """Pictures of the deciding run, by names that no figure has, ready to be drawn.

    Args:
        material: What is known of the job.

    Returns:
        Nothing for runs that store no shapes, such as modal ones of before.
    """
    run = material.deciding
    try:
        if not run.reader.has_plan or not run.reader.committed_frames:
            return {}
        if material.modal:
            shown = range(min(MODES_SHOWN, run.reader.committed_frames))
            return {f"shape-{mode + 1}": _shape(run, mode) for mode in shown}
        return {"moment": _moment(run)}
    except NotStoredError:
        return {}


def _shape(run: RunMaterial, mode: int) -> Illustration:
    """One mode, fully deflected."""
    drawing = _read(run.reader, _shape_options(run.reader.plan.geometry, mode))
    words = (
        f"{_said(drawing)}. A shape has no size of its own: the factor of the deformation is the "
        "greatest displacement as drawn, in m."
    )
    return Illustration(title=f"Shape of mode {mode + 1}", words=words, drawing=drawing)


def _shape_options(geometry: Geometry, mode: int) -> StillOptions:
    """From where a shape is well seen: a train from its side."""
    still = StillOptions(mode=mode, colour="displacement", width=_WIDTH, height=_HEIGHT)
    if len(geometry.vertices):
        return still
    return replace(still, camera="side", scale=_TRAIN_SCALE, colour="none")


def _moment(run: RunMaterial) -> Illustration:
    """The stored shape nearest to the deciding moment."""
    time, why = _deciding_time(run)
    drawing = _read(
        run.reader,
        StillOptions(time=time, colour="acceleration", width=_WIDTH, height=_HEIGHT),
    )
    asked = f"; the stored shape nearest to t = {time:.3f} s, {why}" if time is not None else ""
    filtered = ", as computed, not filtered" if _accelerates(drawing) else ""
    title = "Bridge and train at the moment that decides" if run.verdicts else "Bridge and train"
    return Illustration(title=title, words=f"{_said(drawing)}{filtered}{asked}.", drawing=drawing)


def _read(reader: RunReader, options: StillOptions) -> Still:
    """The picture in the colours wanted; runs of before have displacements only."""
    drawing = read_still(reader, options)
    if drawing.bar is None and options.colour == "acceleration":
        return read_still(reader, replace(options, colour="displacement"))
    return drawing


def _deciding_time(run: RunMaterial) -> tuple[float | None, str]:
    """When what decides is greatest, and what that is; None takes the viewer's own choice. [s]"""
    if run.verdicts:
        verdict = run.verdicts[0]
        return float(verdict["time"]), f"when the {verdict['rule']} is greatest"
    greatest = run.greatest_displacement
    if greatest is None:
        return None, ""
    return greatest.time, f"when the displacement at {greatest.place} is greatest"


def _accelerates(drawing: Still) -> bool:
    return drawing.bar is not None and "acceleration" in drawing.bar.quantity


def _said(drawing: Still) -> str:
    """Time, speed, scale and colours in words, as they stand in the picture."""
    colours = "" if drawing.bar is None else f"; colours: {_range(drawing.bar)}"
    words = drawing.caption.replace(SEPARATOR, ", ")
    # A time begins with its symbol.
    begin = words[:1].upper() if words.startswith("mode") else words[:1]
    return f"{begin}{words[1:]}{colours}"


def _range(bar: ColourBar) -> str:
    ends = f"{bar.minimum:.4g} to {bar.maximum:.4g}".replace("-", "\N{MINUS SIGN}")
    return f"{bar.quantity}, {ends} {bar.unit}".rstrip()
