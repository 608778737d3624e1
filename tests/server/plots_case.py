"""What the tests of figures share: runs in memory, with closed forms for histories."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from server.plots import FigureRequest, figures
from solver.arrays import IntVector, Matrix, Vector
from solver.results import (
    BodyGeometry,
    ChannelSpec,
    Geometry,
    Layer,
    SlabPeaks,
    SlabPoints,
    WheelGeometry,
)
from solver.units import Unit, Units

STEP = 1e-3
N_SAMPLE = 4001
TIME = np.arange(N_SAMPLE) * STEP
STRIDE = 10
AXIS = "mid-span 2, axis/acceleration"
FILTERED = AXIS + " (filtered)"

SPANS = np.array([[0.0, 10.0], [10.0, 30.0], [30.0, 40.0]])
"""x of three spans, of which the middle one is judged. [m]"""


def slab_points() -> SlabPoints:
    """Points every 2.5 m along, at y = -1, 0 and 1; two of them where spans meet."""
    coordinates, span = [], []
    for number, (start, stop) in enumerate(SPANS):
        for x in np.arange(start, stop + 1e-9, 2.5):
            for y in (-1.0, 0.0, 1.0):
                coordinates.append((x, y, 1.3))
                span.append(number)
    points = np.array(coordinates)
    middle = int(np.flatnonzero((points[:, 0] == 20.0) & (points[:, 1] == 0.0))[0])
    return SlabPoints(
        coordinates=points,
        span=np.array(span),
        judged_spans=(1,),
        named={"mid-span 2, axis": middle},
    )


def geometry() -> Geometry:
    """The slab's points as vertices, and one rail above them."""
    slab = slab_points().coordinates
    rail = np.column_stack([SPANS[:, 0], np.full(3, 0.7), np.full(3, 2.2)])
    first = np.arange(0, len(slab) - 5, 3)
    faces = np.column_stack([first, first + 1, first + 4, first + 3])
    n = len(slab)
    return Geometry(
        vertices=np.concatenate([slab, rail]),
        layers=(
            Layer(name="slab", faces=np.concatenate([faces, faces + 1])),
            Layer(name="rails", faces=np.array([[n, n + 1, n + 2, n + 1]])),
        ),
        wheels=WheelGeometry(
            names=("wheel 01 left", "wheel 01 right"),
            offsets=np.zeros(2),
            lateral=np.array([0.7, -0.7]),
            contact_height=2.2,
            radius=0.46,
        ),
        bodies=tuple(
            BodyGeometry(name=name, kind=name[:-3], offset=0.0, size=(20.0, 3.0, 3.0), base=1.0)
            for name in ("carbody 01", "carbody 02", "carbody 03", "bogie 01")
        ),
        spans=SPANS,
    )


@dataclass
class Plan:
    """A plan that a test may change."""

    channels: tuple[ChannelSpec, ...]
    slab: SlabPoints = field(default_factory=slab_points)
    geometry: Geometry = field(default_factory=geometry)
    modal: bool = False
    time_step: float = STEP
    frame_stride: int = STRIDE
    n_sample: int = N_SAMPLE
    speed: float = 120.0
    start_position: float = -66.0
    window_start: float = 0.4
    facts: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass
class Run:
    """A run that a test may change."""

    plan: Plan
    histories: dict[str, Vector]
    committed: int = N_SAMPLE
    summary: Mapping[str, Any] | None = None
    peaks: SlabPeaks | None = None

    @property
    def committed_frames(self) -> int:
        return -(-self.committed // STRIDE)

    def channel(self, name: str, start: int = 0, stop: int | None = None) -> Vector:
        return self.histories[name][: self.committed][start:stop]

    def filtered(self, name: str) -> Vector:
        return self.histories[name]

    def slab_point(self, index: int, start: int = 0, stop: int | None = None) -> Vector:
        return self.slab_histories(np.array([index]))[: self.committed][start:stop, 0]

    def slab_histories(self, indices: IntVector) -> Matrix:
        """The channel at mid-span 2, smaller towards the ends; that point's own exactly."""
        x = self.plan.slab.coordinates[indices, 0]
        return self.histories[AXIS][:, None] * np.sin(np.pi * (x - 10.0) / 20.0)

    def slab_peaks(self) -> SlabPeaks | None:
        return self.peaks

    def heights(self, vertices: IntVector, frames: range) -> Matrix:
        """A half sine along the whole bridge, that sinks with the displacement at mid-span 2."""
        sag = self.histories["mid-span 2, axis/displacement"][np.array(frames) * STRIDE]
        return np.outer(sag, np.sin(np.pi * self.plan.geometry.vertices[vertices, 0] / 40.0))


def spec(name: str, group: str, unit: Unit, **more: Any) -> ChannelSpec:
    """A channel."""
    return ChannelSpec(name=name, unit=unit, title=name.replace("/", " "), group=group, **more)


def make_run(**changes: Any) -> Run:
    """A run that has not ended."""
    slow = 4.0 * np.sin(2 * np.pi * 2 * TIME) * np.exp(-((TIME - 2.0) ** 2))
    raw = slow + 3.0 * np.sin(2 * np.pi * 180 * TIME)
    force = 83e3 + 1e3 * np.sin(30 * TIME)
    force[0] = 83.4e3
    force[2000:2010] = 0.0
    channels = (
        spec(AXIS, "deck", Units.acceleration),
        spec("mid-span 2, axis/displacement", "deck", Units.small_length, place=(20.0, 0.0, 1.3)),
        spec("wheel 01 left/contact force", "wheel", Units.force),
        spec("wheel 01 right/contact force", "wheel", Units.force),
        spec("wheel 02 left/contact force", "wheel", Units.force),
        spec("carbody 01/acceleration", "vehicle", Units.acceleration),
        spec("carbody 02/acceleration", "vehicle", Units.acceleration),
        spec("carbody 03/acceleration", "vehicle", Units.acceleration),
        spec("bogie 01/acceleration", "vehicle", Units.acceleration),
    )
    bounce = np.sin(2 * np.pi * TIME)
    histories: dict[str, Vector] = {
        AXIS: raw,
        FILTERED: slow,
        "mid-span 2, axis/displacement": -2e-3 * np.sin(np.pi * TIME / 4),
        "wheel 01 left/contact force": force,
        "wheel 01 right/contact force": force + 500.0,
        "wheel 02 left/contact force": force,
        "carbody 01/acceleration": 0.4 * bounce,
        "carbody 02/acceleration": 1.2 * bounce,
        "carbody 03/acceleration": 0.6 * bounce,
        "bogie 01/acceleration": 9.0 * bounce,
    }
    return Run(plan=Plan(channels=channels), histories=histories, **changes)


COMFORT = {
    "clause": "EN 1990:2002/A1 A2.4.4.3.2",
    "levels": [
        {"name": "very good", "limit": 1.0},
        {"name": "good", "limit": 1.3},
        {"name": "acceptable", "limit": 2.0},
    ],
    "cars": [
        {"name": "carbody 01", "peak": 0.4, "time": 1.25, "level": "very good"},
        {"name": "carbody 02", "peak": 1.2, "time": 1.25, "level": "good"},
        {"name": "carbody 03", "peak": 0.6, "time": 1.25, "level": "very good"},
    ],
    "worst": {"name": "carbody 02", "peak": 1.2, "time": 1.25, "level": "good"},
}


def finished_run() -> Run:
    """A run that has ended and been judged."""
    run = make_run()
    peaks = {
        name: {"least": float(values.min()), "greatest": float(values.max())}
        for name, values in run.histories.items()
    }
    run.summary = {
        "filtered": [{"name": "mid-span 2, axis", "channel": FILTERED}],
        "comfort": COMFORT,
        "peaks": peaks,
        "verdicts": [
            {
                "rule": "deck acceleration",
                "limit": 3.5,
                "value": 3.98,
                "cut_off": 30.0,
                "place": {"name": "slab, span 2", "x": 29.2, "y": 0.0, "z": 1.335},
                "time": 2.31,
            }
        ],
    }
    return run


def draw(name: str, run: Run, **request: Any) -> dict[str, Any]:
    """A figure of a run."""
    return figures()[name](run, FigureRequest(**request))
