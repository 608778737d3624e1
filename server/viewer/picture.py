"""One moment of a run, ready to draw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from server.viewer.kinematics import (
    axle_poses,
    body_poses,
    deformed,
    force_arrows,
    pleasing_scale,
    wheel_positions,
)
from server.viewer.source import FrameSource, WheelHistory
from solver.arrays import BoolVector, FloatArray, IntArray, Matrix, Vector
from solver.results import Frame, Geometry

__all__ = ["Picture", "PictureMaker", "axle_pairs"]

FORCE_LENGTH = 1.0 / 85e3
"""An arrow of one metre is 85 kN, about the static load of a wheel of the KHST. [m/N]"""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """Positions of everything at one stored frame.

    Attributes:
        index: The frame.
        time: Its time. [s]
        first_axle: x of the first axle. [m]
        vertices: Deformed and exaggerated, shape (n_vertex, 3). [m]
        wheels: Centres, shape (n_wheel, 3). [m]
        lost: Which wheels have no contact, shape (n_wheel,).
        arrows: Contact forces, shape (n_wheel, 2, 3). [m]
        axles: Centres, quaternions and lengths.
        body_centres: Shape (n_body, 3). [m]
        body_orientations: Unit quaternions, shape (n_body, 4).
    """

    index: int
    time: float
    first_axle: float
    vertices: Matrix
    wheels: Matrix
    lost: BoolVector
    arrows: FloatArray
    axles: tuple[Matrix, Matrix, Vector]
    body_centres: Matrix
    body_orientations: Matrix


class PictureMaker:
    """Reads frames and the wheels' channels at their steps."""

    def __init__(self, source: FrameSource) -> None:
        self._source = source
        self._plan = source.plan
        self._history = WheelHistory(source)
        self._rest: FloatArray | None = None
        self.pairs = axle_pairs(self._plan.geometry.wheels.offsets)

    def picture(self, index: int, scale: float) -> Picture:
        """The moment of one stored frame, exaggerated by a scale."""
        geometry, wheels = self._plan.geometry, self._plan.geometry.wheels
        if self._source.committed_frames == 0:
            step, frame = 0, _rest(geometry)
            displacement, force = np.zeros(len(wheels.names)), np.full(len(wheels.names), np.inf)
        else:
            step, frame = index * self._plan.frame_stride, self._source.frame(index)
            displacement, force = self._history.at_step(step)
        time = step * self._plan.time_step
        first_axle = self._plan.start_position + self._plan.speed * time
        positions = wheel_positions(wheels, first_axle, displacement, scale)
        motion = np.asarray(frame.bodies, dtype=np.float64) - self._bodies_at_rest(frame)
        centres, orientations = body_poses(
            geometry.bodies, first_axle, wheels.contact_height, motion, scale
        )
        return Picture(
            index=index,
            time=time,
            first_axle=first_axle,
            vertices=deformed(geometry.vertices, frame.displacement, scale),
            wheels=positions,
            lost=force <= 0.0,
            arrows=force_arrows(positions, wheels.lateral, wheels.radius, force, FORCE_LENGTH),
            axles=axle_poses(positions, self.pairs),
            body_centres=centres,
            body_orientations=orientations,
        )

    def scale(self) -> float:
        """A deformation scale at which the stored peak is well seen."""
        geometry = self._plan.geometry
        count = self._source.committed_frames
        indices = np.unique(np.linspace(0, count - 1, 24).astype(int)) if count else []
        moved = [np.abs(self._source.frame(int(index)).displacement).max() for index in indices]
        lengths = geometry.spans[:, 1] - geometry.spans[:, 0]
        return pleasing_scale(float(max(moved, default=0.0)), 0.03 * float(np.max(lengths)))

    def _bodies_at_rest(self, frame: Frame) -> FloatArray:
        """Settlements under the train's own weight, which are no motion worth exaggerating."""
        if self._source.committed_frames == 0:
            return np.asarray(frame.bodies, dtype=np.float64)
        if self._rest is None:
            self._rest = np.array(self._source.frame(0).bodies, dtype=np.float64)
        return self._rest


def _rest(geometry: Geometry) -> Frame:
    """What is shown before the first frame is stored."""
    return Frame(
        displacement=np.zeros(geometry.vertices.shape), bodies=np.zeros((len(geometry.bodies), 3))
    )


def axle_pairs(offsets: Vector) -> IntArray:
    """Indices of the two wheels at each offset that has two, shape (n_axle, 2)."""
    order = np.argsort(offsets, kind="stable")
    same = np.nonzero(np.diff(offsets[order]) < 1e-6)[0]
    return np.column_stack((order[same], order[same + 1]))
