"""Small made-up runs for tests of the viewer: a crossing of one beam, and modes of it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from server.store import NotStoredError
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

LENGTH, WIDTH, CELLS = 20.0, 4.0, 20
X = np.linspace(0.0, LENGTH, CELLS + 1)


def _strip() -> tuple[np.ndarray, np.ndarray]:
    vertices = np.array([(x, y, 1.0) for x in X for y in (-WIDTH / 2, WIDTH / 2)])
    a = 2 * np.arange(CELLS)
    return vertices, np.column_stack((a, a + 2, a + 3, a + 1))


def _geometry(*, wheels: int, layer: str = "deck", bodies: int = 0) -> Geometry:
    vertices, faces = _strip()
    return Geometry(
        vertices=vertices if layer else np.empty((0, 3)),
        layers=(Layer(name=layer, faces=faces),) if layer else (),
        wheels=WheelGeometry(
            names=tuple(f"wheel {i + 1:02d}" for i in range(wheels)),
            offsets=-3.0 * np.arange(wheels),
            lateral=np.tile([0.7175, -0.7175], wheels)[:wheels],
            contact_height=1.0,
            radius=0.46,
        ),
        bodies=tuple(
            BodyGeometry(
                name=f"car {i + 1}",
                kind="carbody",
                offset=-10.0 - 20.0 * i,
                size=(18.0, 2.9, 2.9),
                base=0.9,
            )
            for i in range(bodies)
        ),
        spans=np.array([[0.0, LENGTH]]) if layer == "deck" else np.empty((0, 2)),
    )


class BeamRun:
    """A half wave that swings at 2 Hz under four wheels; a ``FrameSource``.

    Args:
        motion: Whether frames hold velocity and acceleration; runs of before had none.
    """

    def __init__(self, *, motion: bool = True) -> None:
        geometry = _geometry(wheels=4)
        names = [f"{wheel}/contact force" for wheel in geometry.wheels.names]
        self.plan = RunPlan(
            n_step=1000,
            time_step=1e-3,
            speed=30.0,
            start_position=0.0,
            window_start=0.0,
            channels=tuple(
                ChannelSpec(name=name, unit=Units.force, title="force", group="wheel")
                for name in names
            ),
            slab=SlabPoints(
                coordinates=np.column_stack((X, np.zeros(len(X)), np.ones(len(X)))),
                span=np.zeros(len(X), dtype=np.int64),
                judged_spans=(0,),
                named={},
            ),
            geometry=geometry,
            frame_stride=10,
            frame_motion=motion,
        )
        self._motion = motion
        self.committed = self.plan.n_sample
        self.committed_frames = self.plan.n_frame
        self.identity = "beam"
        self.done = True
        self.summary: dict[str, Any] | None = None

    def frame(self, index: int, *, motion: Collection[str] = ("velocity", "acceleration")) -> Frame:
        """The swinging half wave; of a frame that is not stored a store says so."""
        if not 0 <= index < self.committed_frames:
            raise NotStoredError(f"Frame {index} is not stored; there are {self.committed_frames}.")
        shape = np.repeat(np.sin(np.pi * X / LENGTH), 2)
        phase = 2.0 * np.pi * 2.0 * 0.01 * index
        displacement = np.zeros((len(shape), 3))
        displacement[:, 2] = -1e-3 * shape * np.sin(phase)
        moves = {
            "velocity": -1e-3 * 4 * np.pi * shape * np.cos(phase),
            "acceleration": 1e-3 * (4 * np.pi) ** 2 * shape * np.sin(phase),
        }
        asked = {name: moves[name] for name in motion if self._motion}
        return Frame(displacement=displacement, bodies=np.zeros((0, 3)), **asked)

    def channel_rows(self, names: Sequence[str], start: int, stop: int) -> np.ndarray:
        """Constant forces."""
        return np.full((min(stop, self.committed) - start, len(names)), 80e3)

    def slab_peaks(self) -> SlabPeaks | None:
        """None are stored."""
        return None


class ModalRun(BeamRun):
    """Half waves 1, 2, 3 of a strip, or bounces of a train; a ``FrameSource``.

    Args:
        part: ``viaduct``, ``track`` or ``train``.
    """

    def __init__(self, part: str) -> None:
        super().__init__()
        train = part == "train"
        layer = {"viaduct": "deck", "track": "rails", "train": ""}[part]
        geometry = _geometry(wheels=4 if train else 0, layer=layer, bodies=3 if train else 0)
        names = [f"{wheel}/displacement" for wheel in geometry.wheels.names]
        self.plan = RunPlan(
            n_step=2,
            time_step=1.0,
            speed=0.0,
            start_position=0.0,
            window_start=0.0,
            channels=tuple(
                ChannelSpec(name=name, unit=Units.small_length, title="shape", group="wheel")
                for name in names
            ),
            slab=SlabPoints(
                coordinates=np.empty((0, 3)),
                span=np.empty(0, dtype=np.int64),
                judged_spans=(),
                named={},
            ),
            geometry=geometry,
            frame_stride=1,
            modal=True,
        )
        self.committed = self.committed_frames = 3
        self.summary = {
            "modes": [{"frequency": 5.0 * k * k, "name": f"bending {k}"} for k in (1, 2, 3)]
        }

    def frame(self, index: int, *, motion: Collection[str] = ()) -> Frame:
        """One mode."""
        geometry = self.plan.geometry
        displacement = np.zeros((len(geometry.vertices), 3))
        if len(displacement):
            shape = np.sin((index + 1) * np.pi * X / LENGTH)
            displacement[:, 2] = np.repeat(shape / np.abs(shape).max(), 2)
        bodies = np.zeros((len(geometry.bodies), 3))
        bodies[index % max(len(bodies), 1) :, 0] = 1.0
        return Frame(displacement=displacement, bodies=bodies)

    def channel_rows(self, names: Sequence[str], start: int, stop: int) -> np.ndarray:
        """Wheels rest on the rails."""
        return np.zeros((min(stop, self.committed) - start, len(names)))
