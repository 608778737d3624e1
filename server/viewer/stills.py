"""Stills: one moment of a run as a PNG, drawn by the server without WebGL.

For browsers that cannot draw in three dimensions, and for reports. What is drawn, and from where,
is what the live view shows; reading it and drawing it are two functions, so that the drawing, which
takes a second, can be done by another process.
"""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from server.viewer import captions
from server.viewer.camera import Pose, Preset, View, posed, view
from server.viewer.colour_map import ColourBar
from server.viewer.palette import Colouring, Theme
from server.viewer.picture import PictureMaker
from server.viewer.raster import Lines, Mesh, rendered
from server.viewer.solids import drawn_lines, drawn_meshes
from server.viewer.source import FrameSource
from server.viewer.timeline import Timeline

__all__ = ["Still", "StillOptions", "draw_still", "read_still"]

_PAPER: dict[Theme, tuple[float, float, float]] = {
    "light": (1.0, 1.0, 1.0),
    "dark": (0.078, 0.086, 0.098),
}
_INK: dict[Theme, str] = {"light": "#1c2733", "dark": "#e6ebf0"}
_DOTS_PER_INCH = 100
_FONT_PIXELS = 13.0
"""At the usual width of 1200; smaller pictures have smaller letters, down to two thirds."""


@dataclass(frozen=True, kw_only=True)
class StillOptions:
    """What a still shows.

    Attributes:
        time: In the run, None for the moment at which the view opens. [s]
        mode: The mode of a modal run, counted from 0.
        camera: Preset; ``free`` is the overview.
        pose: Where somebody moved the camera; None for the preset's own place.
        colour: What the surface's colours say.
        scale: Deformation scale, None for one at which the deformation is well seen.
        theme: Light or dark.
        width: [pixel]
        height: [pixel]
    """

    time: float | None = None
    mode: int = 0
    camera: Preset = "overview"
    pose: Pose | None = None
    colour: Colouring = "none"
    scale: float | None = None
    theme: Theme = "light"
    width: int = 1200
    height: int = 675


@dataclass(frozen=True, kw_only=True)
class Still:
    """Everything that a still is drawn from: arrays and words, ready for another process."""

    view: View
    meshes: tuple[Mesh, ...]
    lines: tuple[Lines, ...]
    caption: str
    bar: ColourBar | None
    theme: Theme
    width: int
    height: int


def read_still(source: FrameSource, options: StillOptions) -> Still:
    """Reads what a still needs from the store; quick.

    Args:
        source: The run, finished or still running.
        options: What to show.
    """
    maker, timeline = PictureMaker(source), Timeline(source)
    time = timeline.opening() if options.time is None else options.time
    index, phase = timeline.frame(time, options.mode)
    scale = maker.scale() if options.scale is None else options.scale
    picture = maker.picture(index, scale, options.colour, phase)
    geometry = source.plan.geometry
    usual = view(options.camera, geometry, picture.first_axle, options.width / options.height)
    looks = posed(usual, options.pose)
    cut = options.camera == "section"
    return Still(
        view=looks,
        meshes=drawn_meshes(geometry, picture, options.theme),
        lines=drawn_lines(geometry, picture, options.theme, looks, cut),
        caption=captions.moment(source, picture, scale, options.mode),
        bar=maker.colour_bar(options.colour),
        theme=options.theme,
        width=options.width,
        height=options.height,
    )


def draw_still(drawing: Still) -> bytes:
    """Draws a still to a PNG's bytes; about a second of one core."""
    picture = rendered(
        drawing.view,
        drawing.meshes,
        drawing.lines,
        np.array(_PAPER[drawing.theme]),
        (drawing.width, drawing.height),
    )
    return _sheet(drawing, picture)


def _sheet(drawing: Still, picture: NDArray[np.uint8]) -> bytes:
    """The picture with its caption and its colour bar."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    size = (drawing.width / _DOTS_PER_INCH, drawing.height / _DOTS_PER_INCH)
    sheet = Figure(figsize=size, dpi=_DOTS_PER_INCH)
    FigureCanvasAgg(sheet)
    sheet.figimage(picture, origin="upper", zorder=-1)
    letters = _FONT_PIXELS * float(np.clip(drawing.width / 1200.0, 0.67, 2.0))
    style: dict[str, Any] = {
        "color": _INK[drawing.theme],
        "fontsize": letters * 72.0 / _DOTS_PER_INCH,
        "parse_math": False,
    }
    edge = letters / drawing.height
    sheet.text(
        letters / drawing.width,
        1.0 - edge,
        drawing.caption,
        ha="left",
        va="top",
        bbox=_behind(drawing.theme),
        **style,
    )
    if drawing.bar is not None:
        _draw_bar(sheet, drawing.bar, drawing, letters, style)
    buffer = BytesIO()
    sheet.savefig(buffer, format="png", dpi=_DOTS_PER_INCH)
    return buffer.getvalue()


def _draw_bar(
    sheet: Any, bar: ColourBar, drawing: Still, letters: float, style: dict[str, Any]
) -> None:
    """The colour bar, lying in the lower left corner."""
    width, height = min(26.0 * letters / drawing.width, 0.8), letters / drawing.height
    axes = sheet.add_axes((2.2 * letters / drawing.width, 2.6 * height, width, 0.9 * height))
    axes.imshow(bar.table()[None], aspect="auto", extent=(bar.minimum, bar.maximum, 0.0, 1.0))
    axes.set_yticks([])
    axes.set_xticks(np.linspace(bar.minimum, bar.maximum, 5))
    axes.tick_params(colors=style["color"], labelsize=style["fontsize"], length=3)
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:.3g}".replace("-", "−"))
    for spine in axes.spines.values():
        spine.set_edgecolor(style["color"])
    axes.set_title(
        captions.bar_title(bar),
        loc="left",
        pad=4,
        bbox=_behind(drawing.theme),
        **style,
    )


def _behind(theme: Theme) -> dict[str, Any]:
    """What lies behind words, so that lines do not run through them."""
    return {"facecolor": _PAPER[theme], "edgecolor": "none", "alpha": 0.75, "pad": 2.0}
