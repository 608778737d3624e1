"""What a run hands out: channels, frames, geometry.

A ``Simulation`` first states its ``RunPlan`` (everything that is known before the first step) and
then yields one ``Sample`` a step. The caller owns storage, progress and cancellation.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from solver.arrays import FloatArray, IntArray, IntVector, Matrix, Vector
from solver.units import Unit

__all__ = [
    "BodyGeometry",
    "ChannelSpec",
    "Frame",
    "Geometry",
    "Layer",
    "RunPlan",
    "Sample",
    "SlabPeaks",
    "SlabPoints",
    "WheelGeometry",
]


@dataclass(frozen=True, kw_only=True)
class ChannelSpec:
    """One recorded time history.

    Attributes:
        name: Unique path, for example ``wheel 01 right/contact force``.
        unit: Unit of the stored values and of their display.
        title: What an engineer reads on an axis or in a list.
        group: ``deck``, ``wheel``, ``vehicle`` or ``bearing``: how lists are folded.
        place: Where it is measured (x, y, z), not a number where it moves. [m]
        time_offset: Added to the step's time: accelerations of the HHT method are of second
            order at t + alpha dt. [s]
    """

    name: str
    unit: Unit
    title: str
    group: str
    place: tuple[float, float, float] | None = None
    time_offset: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Layer:
    """A named set of quadrilaterals of the displayed surface.

    Attributes:
        name: ``slab``, ``beam``, ``walls``, ``ballast``, ``sleepers``, ``rails`` or ``deck``.
        faces: Vertex indices, shape (n_face, 4).
    """

    name: str
    faces: IntArray


@dataclass(frozen=True, kw_only=True)
class WheelGeometry:
    """The wheels, on their rails.

    Attributes:
        names: One a wheel, for example ``wheel 01 right``.
        offsets: x of each wheel less x of the first axle, not positive. [m]
        lateral: y of each wheel. [m]
        contact_height: z of the undeformed contact points. [m]
        radius: Rolling radius, for drawing. [m]
    """

    names: tuple[str, ...]
    offsets: Vector
    lateral: Vector
    contact_height: float
    radius: float


@dataclass(frozen=True, kw_only=True)
class BodyGeometry:
    """A carbody or bogie as a box, for drawing.

    Attributes:
        name: For example ``car 03``.
        kind: ``carbody``, ``bogie`` or ``wheelset``.
        offset: x of the centre less x of the first axle. [m]
        size: Length, width, height; for drawing only. [m]
        base: Height of the box's underside above the rail; for drawing only. [m]
    """

    name: str
    kind: str
    offset: float
    size: tuple[float, float, float]
    base: float


@dataclass(frozen=True, kw_only=True)
class Geometry:
    """The displayed surface and the train, undeformed.

    Attributes:
        vertices: Shape (n_vertex, 3). [m]
        layers: Surfaces over these vertices.
        wheels: The wheels.
        bodies: The carbodies, bogies.
        spans: x of the beginning and end of each span, shape (n_span, 2). [m]
    """

    vertices: Matrix
    layers: tuple[Layer, ...]
    wheels: WheelGeometry
    bodies: tuple[BodyGeometry, ...]
    spans: Matrix


@dataclass(frozen=True, kw_only=True)
class SlabPoints:
    """The points whose accelerations the standard judges.

    Attributes:
        coordinates: Shape (n_point, 3). [m]
        span: Index of the span of each point.
        judged_spans: Spans whose neighbours are modelled: only these decide.
        named: Name of a point to its index.
    """

    coordinates: Matrix
    span: IntVector
    judged_spans: tuple[int, ...]
    named: dict[str, int]


@dataclass(frozen=True, kw_only=True)
class SlabPeaks:
    """Greatest magnitude of the acceleration of every slab point since the window opened.

    Attributes:
        raw: As computed, shape (n_point,). [m/s2]
        raw_time: When, shape (n_point,). [s]
        filtered: After the verdict's low-pass filter, shape (n_point,); None where nothing is
            judged. [m/s2]
        filtered_time: When, shape (n_point,), or None. [s]
    """

    raw: Vector
    raw_time: Vector
    filtered: Vector | None = None
    filtered_time: Vector | None = None


@dataclass(frozen=True, kw_only=True)
class RunPlan:
    """Everything about a run that is known before its first step.

    Attributes:
        n_step: Number of time steps (samples are n_step + 1, the first is the static start).
        time_step: [s]
        speed: [m/s]
        start_position: x of the first axle at t = 0; it moves at ``speed``. [m]
        window_start: Time from which peaks and verdicts count. [s]
        channels: The channels, in the order of ``Sample.channels``.
        slab: Points of ``Sample.slab``.
        geometry: What is drawn.
        frame_stride: A frame is stored every so many steps.
        facts: Plain values that belong in the summary: unknowns, mesh level, assumptions...
        modal: No history: sample and frame k hold the shape of mode k (counted from 0), whose
            greatest displacement is 1; the time of a sample is k, and nothing moves along.
        frame_motion: Whether frames hold velocity and acceleration too.
    """

    n_step: int
    time_step: float
    speed: float
    start_position: float
    window_start: float
    channels: tuple[ChannelSpec, ...]
    slab: SlabPoints
    geometry: Geometry
    frame_stride: int
    facts: dict[str, object] = field(default_factory=dict[str, object])
    modal: bool = False
    frame_motion: bool = False

    @property
    def n_sample(self) -> int:
        """Samples of the whole run, the static start included."""
        return self.n_step + 1

    @property
    def n_frame(self) -> int:
        """Frames of the whole run."""
        return self.n_step // self.frame_stride + 1


@dataclass(frozen=True, kw_only=True)
class Frame:
    """The displaced state at one instant.

    Attributes:
        displacement: Of every displayed vertex, shape (n_vertex, 3). [m]
        bodies: Bounce, roll, pitch of every body, shape (n_body, 3). [m, rad, rad]
        velocity: Upward velocity of every displayed vertex, shape (n_vertex,); None in a modal run,
            and in runs stored before there was one. [m/s]
        acceleration: Its upward acceleration, likewise, as the integrator has it at this step (of
            second order at the time plus alpha dt). [m/s2]
    """

    displacement: FloatArray
    bodies: FloatArray
    velocity: FloatArray | None = None
    acceleration: FloatArray | None = None


@dataclass(frozen=True, kw_only=True)
class Sample:
    """One step's outputs.

    Attributes:
        step: 0 is the static start.
        time: [s]
        channels: Shape (n_channel,), SI.
        slab: Vertical acceleration of each slab point, shape (n_point,). [m/s2]
        frame: Present every ``frame_stride`` steps.
    """

    step: int
    time: float
    channels: Vector
    slab: Vector
    frame: Frame | None
