"""What the surface's colours say: quantities of a run, their ranges and their colours.

The range is that of the whole run so far, rounded up, so that a colour means the same at all
times. The bridge sets it: rails and sleepers shake many times harder under a wheel and would leave
it grey.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from threading import RLock

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from server.store.reader import Motion
from server.viewer.colour_map import DIVERGING, SEQUENTIAL, ColourBar, ColourMap, rounded_up
from server.viewer.palette import Colouring
from server.viewer.source import FrameSource
from solver.arrays import IntVector, Vector
from solver.results import Frame, RunPlan, SlabPeaks

__all__ = ["SurfaceColours", "needed"]

_BRIDGE = ("slab", "deck", "beam", "walls")
_TRACK = ("sleepers", "rails")
_PEAK_LAYERS = ("slab", "deck")
_SURVEYED = 48
"""Frames looked at for the greatest values; all of them would take seconds to open a view."""
_NEAR = 0.01
"""A vertex has a slab point's peak if it lies this near. [m]"""
_NO_DATA = (150, 150, 150)


@dataclass(frozen=True, kw_only=True)
class _Quantity:
    title: str
    unit: str
    scale: float
    colours: ColourMap


_QUANTITIES: dict[Colouring, _Quantity] = {
    "displacement": _Quantity(title="displacement", unit="mm", scale=1e3, colours=SEQUENTIAL),
    "velocity": _Quantity(title="vertical velocity", unit="mm/s", scale=1e3, colours=DIVERGING),
    "acceleration": _Quantity(
        title="vertical acceleration", unit="m/s²", scale=1.0, colours=DIVERGING
    ),
}


class SurfaceColours:
    """Colours of one run's displayed surface; safe to use from several threads.

    The thread that draws and those that tell what is drawn look through the run together.

    Args:
        source: The run, finished or still running.
    """

    def __init__(self, source: FrameSource) -> None:
        self._source = source
        self._layers = [layer for layer in source.plan.geometry.layers if len(layer.faces)]
        self._used = {layer.name: np.unique(layer.faces) for layer in self._layers}
        self._greatest: dict[Colouring, float] = {}
        self._surveyed = 0
        self._peaks: _PeakPicture | None = None
        self._peaks_sought = False
        self._looking = RLock()

    @property
    def available(self) -> tuple[Colouring, ...]:
        """Colourings that this run has data for; ``none`` is always one."""
        plan, found = self._source.plan, list[Colouring](["none"])
        if self._layers:
            found.append("displacement")
        if self._layers and plan.frame_motion and not plan.modal:
            found.append("velocity")
            found.append("acceleration")
        if self._peak_picture is not None:
            found.append("peak")
        return tuple(found)

    def bar(self, colouring: Colouring) -> ColourBar | None:
        """The bar of a colouring; None for ``none`` and where the run has no data for it."""
        if colouring == "none" or not self._layers:
            return None
        if colouring == "peak":
            return self._peak_picture.bar if self._peak_picture else None
        quantity, plan = _QUANTITIES[colouring], self._source.plan
        if colouring != "displacement" and (plan.modal or not plan.frame_motion):
            return None
        if plan.modal:
            return ColourBar.of(SEQUENTIAL, "share of the greatest displacement", "", 0.0, 1.0)
        self._survey()
        greatest = self._greatest.get(colouring, 0.0)
        if colouring == "acceleration" and self._peak_picture is not None:
            # Between frames the slab was shaken harder still.
            greatest = max(greatest, self._peak_picture.greatest)
        top = rounded_up(greatest * quantity.scale)
        least = 0.0 if quantity.colours is SEQUENTIAL else -top
        return ColourBar.of(quantity.colours, quantity.title, quantity.unit, least, top)

    @property
    def greatest_displacement(self) -> float:
        """Of the run so far, nothing before its first frame. [m]"""
        self._survey()
        return self._greatest.get("displacement", 0.0)

    def of(
        self, frame: Frame, colouring: Colouring, phase: float = 1.0
    ) -> dict[str, NDArray[np.uint8]]:
        """Colours by layer at one moment.

        Args:
            frame: The moment.
            colouring: Without data for it all layers are plain.
            phase: Multiplies a mode's shape.

        Returns:
            Layer to sRGB colours of its vertices in ascending order of their indices, shape
            (n_used, 3). Layers that are left out show their material.
        """
        bar = self.bar(colouring)
        if bar is None:
            return {}
        if colouring == "peak":
            return self._peak_picture.colours if self._peak_picture else {}
        scale = 1.0 if self._source.plan.modal else _QUANTITIES[colouring].scale
        values = _values(frame, colouring)
        if values is None:
            return {}
        colours = bar.colours(values * (scale * abs(phase)))
        return {name: colours.take(self._used[name], axis=0) for name in self._coloured(colouring)}

    def _coloured(self, colouring: Colouring) -> Iterable[str]:
        """Layers with colours: all for displacements, else those that move like the bridge."""
        names = [layer.name for layer in self._layers]
        bridge = [name for name in names if name not in _TRACK]
        return names if colouring == "displacement" or not bridge else bridge

    @property
    def _peak_picture(self) -> _PeakPicture | None:
        """The peaks, which a run has once it has ended; looked for only once then."""
        with self._looking:
            if not self._peaks_sought and self._source.done and not self._source.plan.modal:
                peaks = self._source.slab_peaks()
                layers = {name: self._used[name] for name in _PEAK_LAYERS if name in self._used}
                if peaks is not None and layers:
                    self._peaks = _peak_picture(self._source.plan, peaks, layers)
                self._peaks_sought = True
            return self._peaks

    @cached_property
    def _ruling(self) -> IntVector:
        """Vertices that set the range."""
        used = [vertices for name, vertices in self._used.items() if name in _BRIDGE]
        return np.unique(np.concatenate(used or list(self._used.values())))

    def _survey(self) -> None:
        """Looks at frames spread over the run, and at those that came since."""
        with self._looking:
            self._look_at_new_frames()

    def _look_at_new_frames(self) -> None:
        count = self._source.committed_frames
        if count <= self._surveyed:
            return
        every = max(1, -(-self._source.plan.n_frame // _SURVEYED))
        first = -(-self._surveyed // every) * every
        fresh = [*range(first, count, every)] or [count - 1]
        for index in fresh:
            frame = self._source.frame(index)
            for colouring in _QUANTITIES:
                values = _values(frame, colouring)
                if values is not None:
                    ruling = self._ruling if colouring != "displacement" else slice(None)
                    top = float(np.abs(values[ruling]).max(initial=0.0))
                    self._greatest[colouring] = max(top, self._greatest.get(colouring, 0.0))
        self._surveyed = count


def needed(colouring: Colouring) -> tuple[Motion, ...]:
    """What a colouring reads of a frame besides its displacements."""
    return (colouring,) if colouring == "velocity" or colouring == "acceleration" else ()


def _values(frame: Frame, colouring: Colouring) -> Vector | None:
    """A quantity at every vertex, SI, shape (n_vertex,)."""
    if colouring == "displacement":
        return np.sqrt(np.einsum("ij,ij->i", frame.displacement, frame.displacement))
    return frame.velocity if colouring == "velocity" else frame.acceleration


@dataclass(frozen=True, kw_only=True)
class _PeakPicture:
    bar: ColourBar
    greatest: float
    colours: dict[str, NDArray[np.uint8]]


def _peak_picture(plan: RunPlan, peaks: SlabPeaks, layers: Mapping[str, IntVector]) -> _PeakPicture:
    """Peaks on the slab: those that the verdict is about, where there is one.

    Vertices without a slab point near them have no peak and are grey.
    """
    filtered = peaks.filtered is not None
    values = peaks.raw if peaks.filtered is None else peaks.filtered
    title = f"peak acceleration ({'filtered' if filtered else 'unfiltered'})"
    top = rounded_up(float(values.max(initial=0.0)))
    bar = ColourBar.of(SEQUENTIAL, title, "m/s²", 0.0, top)
    tree = KDTree(plan.slab.coordinates)
    colours: dict[str, NDArray[np.uint8]] = {}
    for name, used in layers.items():
        near = tree.query_ball_point(plan.geometry.vertices[used], _NEAR)
        known = np.array([max((values[i] for i in points), default=np.nan) for points in near])
        colours[name] = np.where(
            np.isnan(known)[:, None],
            np.array(_NO_DATA, np.uint8),
            bar.colours(np.nan_to_num(known)),
        )
    greatest = float(peaks.raw.max(initial=0.0))
    return _PeakPicture(bar=bar, greatest=greatest, colours=colours)
