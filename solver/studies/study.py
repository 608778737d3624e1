"""A study: one train, one viaduct, one track, and how to compute them. Plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from annotated_types import Ge, Gt, Le, Len

from solver.irregularities import Irregularity, NoIrregularity
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.mesh_level import MeshLevel
from solver.models.rails import ApproachTrack
from solver.models.train import TrainProperties
from solver.models.viaduct import ViaductProperties
from solver.units import Unit, Units

__all__ = [
    "Contact",
    "Extent",
    "Integration",
    "JobKind",
    "Modes",
    "NoTrack",
    "Outputs",
    "Study",
    "Sweep",
    "Track",
    "Viaduct",
]

_STRICT: dict[str, Any] = {"extra": "forbid", "use_attribute_docstrings": True}

_HERTZ_CONSTANT = Unit("N/m^1.5", "MN/m^1.5", 1e-6)
"""Unit of K_h in F = K_h d^1.5."""

Speed = Annotated[float, Units.speed, Gt(0.0), Le(200.0)]
"""Speed of the train. [m/s]"""


@dataclass(frozen=True, kw_only=True)
class NoTrack:
    """No track: the wheels roll on the beam itself."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    type: Literal["none"] = "none"
    """Kind of track."""


Viaduct: TypeAlias = ViaductProperties | BeamBridge
"""Every kind of viaduct, told apart by its ``type``."""
Track: TypeAlias = TrackProperties | NoTrack
"""Every kind of track, told apart by its ``type``."""


JobKind: TypeAlias = Literal["crossing", "modes"]
"""What is computed of a study."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """The contact between wheels and rails."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    law: Literal["linear_hertz", "nonlinear_hertz", "rigid"] = "linear_hertz"
    """Force against compression d: a linear spring k_h d, Hertz's law K_h d^1.5, or rigid."""
    stiffness: Annotated[float, Units.stiffness, Ge(1e6), Le(1e12)] = 1.212e9
    """Stiffness k_h of the linear Hertz spring of one wheel; Hertz's law at 83.385 kN.
    Only the linear law reads it."""
    hertz_constant: Annotated[float, _HERTZ_CONSTANT, Ge(1e6), Le(1e14)] = 7.958e10
    """Constant K_h of Hertz's law for one wheel: S1002 on 60E1, 7.958e7 kN/m^1.5 (Neves 2016,
    section 3.4). Only the nonlinear law reads it."""
    unilateral: bool = True
    """Whether a wheel may leave the rail; otherwise the contact also pulls (Hertz's law then
    continues as an odd function)."""


@dataclass(frozen=True, kw_only=True)
class Integration:
    """The HHT-alpha time integration."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    alpha: Annotated[float, Units.none, Ge(-1.0 / 3.0), Le(0.0)] = -0.05
    """Numerical dissipation of high frequencies; 0 for none."""
    time_step: Annotated[float, Units.time_step, Ge(1e-7), Le(0.1)] = 2.5e-4
    """Time step."""


@dataclass(frozen=True, kw_only=True)
class Extent:
    """Where and when a crossing begins and ends."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    run_in: Annotated[float, Units.length, Ge(0.0), Le(2000.0)] = 66.0
    """Distance of the first axle before the first span at the start; 40 m let the start die out."""
    run_out: Annotated[float, Units.time, Ge(0.0), Le(60.0)] = 1.0
    """Time after the last axle has left the last span."""


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What is recorded and judged."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    frame_interval: Annotated[float, Units.time, Ge(1e-4), Le(10.0)] = 0.01
    """Time between two stored shapes of the structure."""
    cut_off_frequency: Annotated[float, Units.frequency, Ge(0.0), Le(1000.0)] = 0.0
    """Low-pass frequency of the deciding acceleration; 0 takes the standard's,
    the greatest of 30 Hz, 1.5 f1 and f3 (EN 1990:2002/A1 A2.4.4.2.1(4))."""


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """The points at which the study is run."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    speeds: Annotated[tuple[Speed, ...], Len(1, 500)] = (120.0,)
    """Speeds of the train, one run each."""


@dataclass(frozen=True, kw_only=True)
class Modes:
    """What a modal analysis finds; only jobs of kind ``modes`` read it."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    part: Literal["viaduct", "track", "train"] = "viaduct"
    """The viaduct with its track and rails, the approach track alone, or the train on rigid
    rails."""
    count: Annotated[int, Ge(1), Le(200)] = 24
    """Greatest number of modes, the lowest ones; a small model has fewer."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """What a user asks for."""

    __pydantic_config__: ClassVar[dict[str, Any]] = _STRICT

    schema_version: Literal[1] = 1
    """Version of this form."""
    name: Annotated[str, Len(1, 120)]
    """Name shown in lists and reports."""
    train: TrainProperties
    """The train."""
    viaduct: Viaduct
    """The viaduct, or beams in its place."""
    track: Track = field(default_factory=TrackProperties)
    """The track."""
    approach: ApproachTrack = field(default_factory=ApproachTrack)
    """The flexible track before and after the three-dimensional model."""
    irregularity: Irregularity = field(default_factory=NoIrregularity)
    """Irregularity of the rails."""
    contact: Contact = field(default_factory=Contact)
    """The wheel-rail contact."""
    integration: Integration = field(default_factory=Integration)
    """The time integration."""
    extent: Extent = field(default_factory=Extent)
    """Beginning and end of the crossing."""
    mesh_level: MeshLevel = "standard"
    """Density of the mesh: coarse is a screening mesh."""
    outputs: Outputs = field(default_factory=Outputs)
    """What is recorded."""
    sweep: Sweep = field(default_factory=Sweep)
    """Speeds of the runs."""
    modes: Modes = field(default_factory=Modes)
    """What a modal analysis finds."""
    line_speed: Annotated[float, Units.speed, Ge(0.0), Le(200.0)] = 0.0
    """Maximum speed of the line at the site; 0 if not stated."""
