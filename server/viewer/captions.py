"""Words under pictures that leave the dashboard: when, how fast, how much exaggerated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.viewer.colour_map import ColourBar
from server.viewer.picture import Picture
from server.viewer.source import FrameSource
from solver.results import RunPlan
from solver.units import Units

__all__ = ["SEPARATOR", "bar_title", "crossing", "exaggeration", "mode_name", "moment"]

SEPARATOR = "   ·   "
"""Between the parts of a caption."""


def moment(source: FrameSource, picture: Picture, scale: float, mode: int) -> str:
    """One line on what a picture shows.

    Args:
        source: The run.
        picture: The moment.
        scale: Deformation scale.
        mode: Of a modal run, counted from 0.
    """
    plan = source.plan
    if plan.modal:
        return SEPARATOR.join((mode_name(source, mode), exaggeration(scale)))
    parts = [f"t = {picture.time:.3f} s", crossing(plan)]
    if len(plan.geometry.wheels.names):
        parts.append(f"first axle at x = {picture.first_axle:.1f} m".replace("-", "−"))
    return SEPARATOR.join(part for part in [*parts, exaggeration(scale)] if part)


def crossing(plan: RunPlan) -> str:
    """How fast the train goes; empty where nothing moves along."""
    return f"{plan.speed * Units.speed.scale:.4g} {Units.speed.display}" if plan.speed else ""


def exaggeration(scale: float) -> str:
    """The deformation scale in words."""
    return f"deformation × {scale:.4g}"


def mode_name(source: FrameSource, mode: int) -> str:
    """A mode as engineers count it, from 1, with its frequency and name where they are known."""
    words = f"mode {mode + 1} of {source.plan.n_frame}"
    known: Sequence[Mapping[str, Any]] = (source.summary or {}).get("modes", ())
    if mode >= len(known):
        return words
    frequency, name = known[mode]["frequency"], known[mode]["name"]
    return f"{words}: {frequency:.4g} Hz" + (f", {name}" if name else "")


def bar_title(bar: ColourBar) -> str:
    """What a colour bar shows."""
    return f"{bar.quantity} [{bar.unit}]" if bar.unit else bar.quantity
