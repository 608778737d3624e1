"""What the viewer's routes take and give, as JSON."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from server.viewer.camera import Place, Pose, Preset
from server.viewer.colour_map import ColourBar
from server.viewer.palette import Colouring, Theme
from server.viewer.picking import Picked
from server.viewer.session import Session

__all__ = ["OpenedView", "ViewChange", "ViewRequest", "ViewState"]

_STRICT = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class ViewRequest(BaseModel):
    """How a new view looks."""

    model_config = _STRICT

    theme: Annotated[Theme, Field(description="Of the page around the view.")] = "light"


class OpenedView(BaseModel):
    """A new viewing session."""

    session: Annotated[str, Field(description="128 random bits.")]
    url: Annotated[str, Field(description="Page to show in a frame, under this origin.")]


_Coordinates = Annotated[
    list[Annotated[float, Field(ge=-1e5, le=1e5)]], Field(min_length=3, max_length=3)
]


class PoseChange(BaseModel):
    """Where the camera should be; up is always z."""

    model_config = _STRICT

    position: Annotated[_Coordinates, Field(description="Of the eye, (x, y, z). [m]")]
    look_at: Annotated[_Coordinates, Field(description="What it looks at, (x, y, z). [m]")]
    fov: Annotated[
        float | None,
        Field(ge=0.01, le=2.6, description="Vertical field of view; left out, the preset's. [rad]"),
    ] = None
    time: Annotated[
        float | None,
        Field(
            ge=0.0,
            le=1e6,
            description="When it was there, for `follow`, which carries it on; now. [s]",
        ),
    ] = None

    @classmethod
    def read(cls, text: str) -> PoseChange:
        """From an address: six numbers between commas, and perhaps the field of view.

        Raises:
            ValueError: It is something else, or out of bounds.
        """
        numbers = [float(part) for part in text.split(",")]
        if len(numbers) not in (6, 7):
            raise ValueError(f"{len(numbers)} numbers are no pose")
        fov = numbers[6] if len(numbers) == 7 else None
        return cls(position=numbers[:3], look_at=numbers[3:6], fov=fov)

    def pose(self) -> Pose:
        """As the viewer takes it."""
        return Pose(
            position=_place(self.position),
            look_at=_place(self.look_at),
            field=self.fov,
            time=self.time,
        )


def _place(coordinates: list[float]) -> Place:
    x, y, z = coordinates
    return x, y, z


class ViewChange(BaseModel):
    """What should be shown. Fields that are left out stay as they are."""

    model_config = _STRICT

    run: Annotated[
        str, Field(max_length=64, description="Another run to show; the other fields are of it.")
    ] = ""
    time: Annotated[
        float,
        Field(ge=0.0, le=1e6, description="Time in the run; of the animation for modes. [s]"),
    ] = 0.0
    playing: Annotated[
        bool, Field(description="Whether the time runs; true also ends a pause of the server.")
    ] = False
    rate: Annotated[
        float,
        Field(
            ge=1e-3,
            le=10.0,
            description="Simulated over real seconds; cycles a second for modes.",
            examples=[0.1],
        ),
    ] = 0.1
    scale: Annotated[
        float, Field(ge=0.0, le=1e5, description="Deformation scale.", examples=[500.0])
    ] = 1.0
    layers: Annotated[
        list[Annotated[str, Field(max_length=40)]],
        Field(max_length=32, description="Names of what is visible, from `available_layers`."),
    ] = []
    camera: Annotated[
        Preset, Field(description="Where to look from; `free` leaves the camera alone.")
    ] = "overview"
    pose: Annotated[
        PoseChange | None,
        Field(description="Where the camera goes instead; null: where its preset has it."),
    ] = None
    theme: Annotated[Theme, Field(description="Of the page around the view.")] = "light"
    colour: Annotated[
        Colouring, Field(description="What colours say, from `available_colours`.")
    ] = "none"
    mode: Annotated[int, Field(ge=0, le=999, description="Which mode, counted from 0.")] = 0
    place: Annotated[
        list[Annotated[float, Field(ge=-1e6, le=1e6)]] | None,
        Field(
            min_length=3,
            max_length=3,
            description="Marks the point nearest to (x, y, z) at rest, as a click does. [m]",
        ),
    ] = None
    smooth: Annotated[
        bool,
        Field(description="Colours per vertex; false gives each element one colour instead."),
    ] = True


class BarState(BaseModel):
    """What the colours mean."""

    quantity: str
    unit: Annotated[str, Field(description="Of minimum and maximum: what people read.")]
    minimum: Annotated[float, Field(description="Of the first colour; lower ones have it too.")]
    maximum: Annotated[float, Field(description="Of the last colour; higher ones have it too.")]
    stops: Annotated[
        list[tuple[float, str]], Field(description="Places from 0 to 1 and colours `#rrggbb`.")
    ]

    @classmethod
    def of(cls, bar: ColourBar) -> BarState:
        """A bar as JSON."""
        return cls(
            quantity=bar.quantity,
            unit=bar.unit,
            minimum=bar.minimum,
            maximum=bar.maximum,
            stops=list(bar.stops),
        )


class PickedState(BaseModel):
    """The point that was clicked last."""

    sequence: Annotated[int, Field(description="A new click has a new number.")]
    layer: str
    point: Annotated[tuple[float, float, float], Field(description="At rest. [m]")]
    slab_point: Annotated[
        int | None, Field(description="Nearest point whose history is judged, if one is near.")
    ]

    @classmethod
    def of(cls, picked: Picked) -> PickedState:
        """A picked point as JSON."""
        return cls(
            sequence=picked.sequence,
            layer=picked.layer,
            point=picked.point,
            slab_point=picked.slab_point,
        )


class PoseState(BaseModel):
    """Where somebody moved the camera; up is always z."""

    position: Annotated[Place, Field(description="Of the eye, (x, y, z). [m]")]
    look_at: Annotated[Place, Field(description="What it looks at, (x, y, z). [m]")]
    fov: Annotated[
        float | None, Field(description="Vertical field of view, null for the preset's. [rad]")
    ]

    @classmethod
    def of(cls, pose: Pose) -> PoseState:
        """A pose as JSON, in whole millimetres."""
        return cls(
            position=_rounded(pose.position),
            look_at=_rounded(pose.look_at),
            fov=None if pose.field is None else round(pose.field, 4),
        )


def _rounded(place: Place) -> Place:
    # Adding zero makes a zero of a negative one.
    x, y, z = (round(value, 3) + 0.0 for value in place)
    return x, y, z


class ViewState(BaseModel):
    """What is shown now, and what could be."""

    session: str
    run: str
    time: Annotated[float, Field(description="Time in the run; of the animation for modes. [s]")]
    playing: bool
    rate: float
    scale: float
    layers: list[str]
    camera: Preset
    pose: Annotated[
        PoseState | None, Field(description="Where somebody moved the camera, if it is there.")
    ]
    theme: Theme
    colour: Colouring
    colour_bar: BarState | None
    mode: Annotated[int, Field(description="Which mode is shown, counted from 0.")]
    smooth: Annotated[bool, Field(description="Whether each vertex has its own colour.")]
    modal: Annotated[bool, Field(description="Whether shapes of modes are shown, no history.")]
    picked: PickedState | None
    paused: Annotated[str, Field(description="Why the server paused it; empty where it did not.")]
    available_layers: list[str]
    available_colours: list[Colouring]
    available_modes: Annotated[int, Field(description="How many; none in a history.")]
    last_time: Annotated[
        float, Field(description="Time of the last stored frame; one cycle of a mode. [s]")
    ]
    frame_interval: Annotated[float, Field(description="Time between stored frames. [s]")]
    done: Annotated[bool, Field(description="Whether no more frames will come.")]
    clients: Annotated[int, Field(description="Browsers that watch.")]

    @classmethod
    def of(cls, session: Session) -> ViewState:
        """What a session shows now; its viewers then know why it was paused, if it was."""
        player, choices = session.player, session.player.choices
        state, timeline, bar = player.state, player.timeline, player.colour_bar()
        pose = player.pose
        return cls(
            session=session.id,
            run=session.run,
            time=state.time,
            playing=state.playing,
            rate=state.rate,
            scale=state.scale,
            layers=[name for name in choices.layers if name in state.layers],
            camera=state.camera,
            pose=None if pose is None else PoseState.of(pose),
            theme=state.theme,
            colour=state.colour,
            colour_bar=None if bar is None else BarState.of(bar),
            mode=state.mode,
            smooth=state.smooth,
            modal=timeline.modal,
            picked=None if state.picked is None else PickedState.of(state.picked),
            paused=session.tell_pause(),
            available_layers=list(choices.layers),
            available_colours=list(choices.colours),
            available_modes=choices.modes,
            last_time=timeline.shown_last,
            frame_interval=timeline.interval,
            done=timeline.done,
            clients=session.clients,
        )
