"""A made-up crossing, held in memory, that looks like a real one: for tests of the viewer.

Three spans of a U-shaped beam carry ballast, sleepers and rails; a train of 92 wheels crosses at
120 m/s. Each axle on a span bends it as a half sine, and dips the rails below itself.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from solver.results import (
    BodyGeometry,
    ChannelSpec,
    Frame,
    Geometry,
    Layer,
    RunPlan,
    SlabPeaks,
    SlabPoints,
    WheelGeometry,
)
from solver.units import Units

SPANS = np.array([[0.0, 16.5], [16.5, 37.5], [37.5, 58.5]])
SPEED, TIME_STEP, STRIDE, START = 120.0, 5e-4, 8, -60.0
RAIL_TOP = 2.13
DIFFERENCE = 1e-4
"""Step of the differences that give velocities and accelerations. [s]"""
GAUGE = 1.435


class Mesh:
    """Collects quadrilaterals by layer."""

    def __init__(self) -> None:
        self.vertices: list[np.ndarray] = []
        self.faces: dict[str, list[np.ndarray]] = {}
        self.count = 0

    def sheet(self, layer: str, x: np.ndarray, section: Sequence[tuple[float, float]]) -> None:
        """Extrudes an open section of (y, z) along x."""
        points = np.array(section)
        n = len(points)
        grid = np.concatenate([np.column_stack((np.full(n, at), points)) for at in x])
        row = np.arange(len(x) - 1)[:, None] * n + np.arange(n - 1)[None, :] + self.count
        quads = np.stack((row, row + n, row + n + 1, row + 1), axis=2).reshape(-1, 4)
        self.vertices.append(grid)
        self.faces.setdefault(layer, []).append(quads)
        self.count += len(grid)

    def block(self, layer: str, x: np.ndarray, y: tuple[float, float], z: tuple[float, float]):
        """A closed box along x."""
        (y0, y1), (z0, z1) = y, z
        self.sheet(layer, x, [(y0, z0), (y0, z1), (y1, z1), (y1, z0), (y0, z0)])
        n = self.count
        caps = np.array([[n - 5, n - 4, n - 3, n - 2], [n - 5 * len(x) + i for i in range(4)]])
        self.faces[layer].append(caps)


def _geometry() -> Geometry:
    mesh = Mesh()
    for begin, end in SPANS:
        x = np.linspace(begin + 0.05, end - 0.05, round((end - begin) / 0.6) + 1)
        mesh.sheet("slab", x, [(y, 1.335) for y in np.linspace(-3.6, 3.6, 13)])
        for y in (-1.55, 1.55):
            mesh.sheet("beam", x, [(y, z) for z in np.linspace(0.09, 1.335, 4)])
        mesh.sheet("beam", x, [(y, 0.09) for y in np.linspace(-1.55, 1.55, 6)])
        for y in (-2.15, 2.15):
            mesh.sheet("walls", x, [(y, z) for z in (1.335, 1.7, 2.035)])
    long = np.arange(-18.0, 58.5 + 0.3, 0.6)
    mesh.block("ballast", long, (-2.0, 2.0), (1.47, 1.82))
    for at in np.arange(-17.7, 58.5, 0.6):
        mesh.block("sleepers", np.array([at - 0.13, at + 0.13]), (-1.3, 1.3), (1.82, 1.96))
    for y in (-GAUGE / 2, GAUGE / 2):
        mesh.block("rails", np.arange(-18.0, 58.6, 0.3), (y - 0.036, y + 0.036), (1.96, RAIL_TOP))
    axles, bodies = _train()
    offsets = np.repeat(axles, 2)
    wheels = WheelGeometry(
        names=tuple(f"wheel {1 + i // 2:02d} {('left', 'right')[i % 2]}" for i in range(92)),
        offsets=offsets,
        lateral=np.tile([GAUGE / 2, -GAUGE / 2], 46),
        contact_height=RAIL_TOP,
        radius=0.46,
    )
    return Geometry(
        vertices=np.concatenate(mesh.vertices),
        layers=tuple(
            Layer(name=name, faces=np.concatenate(faces)) for name, faces in mesh.faces.items()
        ),
        wheels=wheels,
        bodies=bodies,
        spans=SPANS,
    )


def _train() -> tuple[np.ndarray, tuple[BodyGeometry, ...]]:
    first = np.array([0.0, 14.0])
    coaches = 14.0 + 6.6 + 18.7 * np.arange(19)
    last = coaches[-1] + 6.6 + first
    bogies = np.concatenate((first, coaches, last)) + 1.5
    axles = -np.sort(np.concatenate((bogies - 1.5, bogies + 1.5)))[::-1]
    axles = np.sort(axles)[::-1]
    ends = [(-3.0, 19.8), *zip(coaches[:-1] + 1.7, coaches[1:] + 1.3, strict=True)]
    ends.append((float(coaches[-1]) + 1.9, float(last[-1]) + 7.0))
    cars = [
        BodyGeometry(
            name=f"car {i + 1:02d}",
            kind="carbody",
            offset=-(a + b) / 2.0,
            size=(b - a, 2.9, 2.9),
            base=0.95,
        )
        for i, (a, b) in enumerate(ends)
    ]
    frames = [
        BodyGeometry(
            name=f"bogie {i + 1:02d}", kind="bogie", offset=-at, size=(3.6, 2.2, 0.25), base=0.55
        )
        for i, at in enumerate(bogies)
    ]
    return axles, (*cars, *frames)


def _slab_points(geometry: Geometry) -> SlabPoints:
    """The slab's vertices between the ballast walls."""
    (slab,) = (layer for layer in geometry.layers if layer.name == "slab")
    points = geometry.vertices[np.unique(slab.faces)]
    points = points[np.abs(points[:, 1]) < 2.2]
    span = np.searchsorted(SPANS[:, 1], points[:, 0])
    middle = np.linalg.norm(points[:, :2] - (27.0, 0.0), axis=1)
    return SlabPoints(
        coordinates=points,
        span=span,
        judged_spans=(1,),
        named={"mid-span 2, axis": int(np.argmin(middle))},
    )


class ExampleRun:
    """A ``FrameSource`` computed on demand.

    Args:
        n_step: Steps of the whole run.
        done: Whether the run has ended.
    """

    def __init__(self, *, n_step: int = 6400, done: bool = True) -> None:
        geometry = _geometry()
        names = [
            (wheel, quantity)
            for quantity in ("contact force", "displacement")
            for wheel in geometry.wheels.names
        ]
        self.plan = RunPlan(
            n_step=n_step,
            time_step=TIME_STEP,
            speed=SPEED,
            start_position=START,
            window_start=0.0,
            channels=tuple(
                ChannelSpec(
                    name=f"{wheel}/{quantity}",
                    unit=Units.force if quantity == "contact force" else Units.small_length,
                    title=quantity,
                    group="wheel",
                )
                for wheel, quantity in names
            ),
            slab=_slab_points(geometry),
            geometry=geometry,
            frame_stride=STRIDE,
            frame_motion=True,
        )
        self.identity = "example"
        self.done = done
        self.committed = self.plan.n_sample
        self.reads = 0
        self._frames = lru_cache(maxsize=128)(self._computed)

    @property
    def committed_frames(self) -> int:
        """Frames among the committed samples."""
        return (self.committed - 1) // STRIDE + 1 if self.committed else 0

    def frame(self, index: int, *, motion: Collection[str] = ("velocity", "acceleration")) -> Frame:
        """The displaced state of a frame."""
        frame = self._frames(index)
        left_out = {"velocity", "acceleration"} - set(motion)
        return replace(frame, **dict.fromkeys(left_out))

    def _computed(self, index: int) -> Frame:
        """The same at every call, and slow: what asks twice must not wait twice."""
        geometry, time = self.plan.geometry, index * STRIDE * TIME_STEP
        x, _, z = geometry.vertices.T
        _, slope = self._bending(x, time)
        w = self._upward(time)
        before, after = self._upward(time - DIFFERENCE), self._upward(time + DIFFERENCE)
        displacement = np.column_stack((-(z - 0.7) * slope, np.zeros(len(x)), w))
        order = np.arange(len(geometry.bodies))
        sag = np.where(order < 20, -0.4, -0.05)
        bounce = sag + 0.6e-3 * np.sin(2 * np.pi * 3.0 * time + order)
        pitch = 1.5e-4 * np.sin(2 * np.pi * 2.0 * time + 0.7 * order)
        roll = 2e-5 * np.sin(2 * np.pi * 2.5 * time + 1.3 * order)
        return Frame(
            displacement=displacement.astype(np.float32).astype(np.float64),
            bodies=np.column_stack((bounce, roll, pitch)),
            velocity=(after - before) / (2.0 * DIFFERENCE),
            acceleration=(after - 2.0 * w + before) / DIFFERENCE**2,
        )

    def slab_peaks(self) -> SlabPeaks | None:
        """Peaks that are greatest in the middle of the second span, at y = 0."""
        if not self.done:
            return None
        x, y, _ = self.plan.slab.coordinates.T
        begin, end = SPANS[self.plan.slab.span].T
        shape = np.sin(np.pi * (x - begin) / (end - begin)) * (1.0 - 0.1 * np.abs(y))
        raw = 0.47 * shape * np.where(self.plan.slab.span == 1, 1.0, 0.6)
        at = np.full(len(raw), 0.8)
        return SlabPeaks(raw=raw, raw_time=at, filtered=0.6 * raw, filtered_time=at)

    def _upward(self, time: float) -> np.ndarray:
        """Upward displacement of every vertex."""
        x, y, z = self.plan.geometry.vertices.T
        w, _ = self._bending(x, time)
        dipped = (z > 1.7) & (np.abs(y) < 1.5)
        w[dipped] += self._dip(x[dipped], time)
        return w

    def channel_rows(self, names: Sequence[str], start: int, stop: int) -> np.ndarray:
        """Histories of the wheels."""
        self.reads += 1
        known = [channel.name for channel in self.plan.channels]
        columns = [known.index(name) for name in names]
        stop = min(stop, self.committed)
        times = np.arange(start, stop) * TIME_STEP
        return np.array([self._channels(time) for time in times])[:, columns]

    def _channels(self, time: float) -> np.ndarray:
        wheels = self.plan.geometry.wheels
        x = START + SPEED * time + wheels.offsets
        bump = np.exp(-((x - 27.0) ** 2) / 8.0) * (wheels.lateral < 0.0)
        force = np.maximum(83.4e3 * (1.0 + 0.1 * np.sin(40.0 * time + x) - 1.4 * bump), 0.0)
        w, _ = self._bending(x, time)
        return np.concatenate((force, w + self._dip(x, time)))

    def _bending(self, x: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        axles = START + SPEED * time + self.plan.geometry.wheels.offsets[::2]
        w, slope = np.zeros(len(x)), np.zeros(len(x))
        for begin, end in SPANS:
            length = end - begin
            on = (axles > begin) & (axles < end)
            load = np.sum(np.sin(np.pi * (axles[on] - begin) / length))
            amplitude = -0.45e-3 * load * (length / 21.0) ** 3
            within = (x >= begin) & (x <= end)
            phase = np.pi * (x - begin) / length
            w += np.where(within, amplitude * np.sin(phase), 0.0)
            slope += np.where(within, amplitude * np.pi / length * np.cos(phase), 0.0)
        return w, slope

    def _dip(self, x: np.ndarray, time: float) -> np.ndarray:
        axles = START + SPEED * time + self.plan.geometry.wheels.offsets[::2]
        near = axles[(axles > x.min(initial=0.0) - 6.0) & (axles < x.max(initial=0.0) + 6.0)]
        return -0.7e-3 * np.exp(-(((x[:, None] - near[None, :]) / 0.9) ** 2)).sum(axis=1)
