"""One moment of a run, ready to draw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from server.viewer.colour_map import ColourBar
from server.viewer.colouring import SurfaceColours, needed
from server.viewer.kinematics import (
    axle_poses,
    body_poses,
    deformed,
    force_arrows,
    pleasing_scale,
    wheel_positions,
)
from server.viewer.palette import Colouring
from server.viewer.source import FrameSource, WheelHistory
from solver.arrays import BoolVector, FloatArray, IntArray, Matrix, Vector
from solver.results import Frame, Geometry

__all__ = ["Picture", "PictureMaker", "axle_pairs"]

FORCE_LENGTH = 1.0 / 85e3
"""An arrow of one metre is 85 kN, about the static load of a wheel of the KHST. [m/N]"""

_OVER_THE_SLAB = frozenset({"ballast", "sleepers"})
_SHAPE_SIZE = 1.0
_TRACK_SHAPE_SIZE = 0.5
"""Greatest displacement of a mode's shape as first drawn: of a viaduct or a train some twentieth of
a span or a car, of a track, whose waves are shorter, less. [m]"""
_SHORTEST = 20.0
"""Where there are no spans, the length that counts for one. [m]"""


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
        arrows: Contact forces, shape (n_wheel, 2, 3); none in a modal run. [m]
        axles: Centres, quaternions and lengths.
        body_centres: Shape (n_body, 3). [m]
        body_orientations: Unit quaternions, shape (n_body, 4).
        colours: Layer to sRGB colours of its vertices in ascending order of their indices, shape
            (n_used, 3); layers that are not named show their material.
        veiled: Layers that are drawn as a veil, because they lie over what the colours tell.
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
    colours: dict[str, NDArray[np.uint8]]
    veiled: frozenset[str]


class PictureMaker:
    """Reads frames and the wheels' channels at their steps."""

    def __init__(self, source: FrameSource) -> None:
        self._source = source
        self._plan = source.plan
        self._history = WheelHistory(source)
        self._colours = SurfaceColours(source)
        self._rest: FloatArray | None = None
        self.pairs = axle_pairs(self._plan.geometry.wheels.offsets)

    @property
    def available_colourings(self) -> tuple[Colouring, ...]:
        """Colourings that this run has data for, ``none`` first."""
        return self._colours.available

    def colour_bar(self, colour: Colouring) -> ColourBar | None:
        """What the colours mean: the same at all times of the run so far."""
        return self._colours.bar(colour)

    def picture(
        self, index: int, scale: float, colour: Colouring = "none", phase: float = 1.0
    ) -> Picture:
        """The moment of one stored frame.

        Args:
            index: The frame; the mode in a modal run.
            scale: Deformation scale.
            colour: What the surface's colours say.
            phase: Multiplies the shape of a mode, -1 to 1.
        """
        geometry, wheels = self._plan.geometry, self._plan.geometry.wheels
        if self._source.committed_frames == 0:
            step, frame = 0, _rest(geometry)
            displacement, force = np.zeros(len(wheels.names)), np.full(len(wheels.names), np.inf)
        else:
            step = index * self._plan.frame_stride
            frame = self._source.frame(index, motion=needed(colour))
            displacement, force = self._history.at_step(step)
        if self._plan.modal:
            displacement = phase * displacement
        time = step * self._plan.time_step
        first_axle = self._plan.start_position + self._plan.speed * time
        positions = wheel_positions(wheels, first_axle, displacement, scale)
        arrows = force_arrows(positions, wheels.lateral, wheels.radius, force, FORCE_LENGTH)
        motion = self._motion(frame)
        centres, orientations = body_poses(
            geometry.bodies, first_axle, wheels.contact_height, motion, phase * scale
        )
        colours = self._colours.of(frame, colour, phase)
        return Picture(
            index=index,
            time=time,
            first_axle=first_axle,
            vertices=deformed(geometry.vertices, frame.displacement, phase * scale),
            wheels=positions,
            lost=force <= 0.0,
            arrows=arrows[:0] if self._plan.modal else arrows,
            axles=axle_poses(positions, self.pairs),
            body_centres=centres,
            body_orientations=orientations,
            colours=colours,
            veiled=_OVER_THE_SLAB if colour == "peak" and colours else frozenset(),
        )

    def scale(self) -> float:
        """A deformation scale at which the stored peak is well seen."""
        geometry = self._plan.geometry
        if self._plan.modal:
            track = len(geometry.vertices) and not len(geometry.spans)
            return _TRACK_SHAPE_SIZE if track else _SHAPE_SIZE
        lengths = geometry.spans[:, 1] - geometry.spans[:, 0]
        span = float(np.max(lengths)) if len(lengths) else _SHORTEST
        return pleasing_scale(self._colours.greatest_displacement, 0.03 * span)

    def _motion(self, frame: Frame) -> FloatArray:
        """Bounce, roll and pitch of the bodies, less those under the train's own weight.

        Shape (n_body, 3). [m, rad, rad]
        """
        bodies = np.asarray(frame.bodies, dtype=np.float64)
        if self._plan.modal:
            return bodies
        if self._rest is None:
            if self._source.committed_frames == 0:
                return np.zeros_like(bodies)
            self._rest = np.array(self._source.frame(0, motion=()).bodies, dtype=np.float64)
        return bodies - self._rest


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
