"""What the API sends, as OpenAPI describes it. Values are SI; times of day are ISO 8601, UTC."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from server.settings import LARGEST_PRIORITY

__all__ = [
    "ChannelItem",
    "ChannelList",
    "EstimateItem",
    "FindingItem",
    "FrameItem",
    "FrameList",
    "FrameValues",
    "Health",
    "Job",
    "JobChange",
    "JobList",
    "Login",
    "Meta",
    "ProblemDocument",
    "Progress",
    "Report",
    "Run",
    "RunItem",
    "StateName",
    "TemplateItem",
    "TemplateList",
    "Trouble",
    "UnitItem",
    "VerdictList",
]

StateName = Literal[
    "queued", "running", "done", "failed", "cancelled", "timed_out", "out_of_memory"
]


class _Model(BaseModel):
    model_config = ConfigDict(use_attribute_docstrings=True)


class FindingItem(_Model):
    """One thing that is wrong or worth knowing."""

    pointer: str
    """JSON pointer into the body."""
    value: str
    """What stands there, in at most 80 characters."""
    reason: str
    """Why it cannot be used."""
    remedy: str
    """What to do."""


class ProblemDocument(_Model):
    """RFC 9457."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FindingItem]


class Progress(_Model):
    """How far: steps done over steps. Never decreases within an attempt."""

    step: int
    steps: int
    fraction: float = Field(ge=0.0, le=1.0)
    stage: str
    rate: float | None
    """Pace. [steps/s]"""
    remaining: list[float] | None
    """Time left, low and high. [s]"""
    simulated_time: float | None
    """Time in the run. [s]"""


class Trouble(_Model):
    """Why a run or job ended without a result."""

    title: str
    detail: str


class RunItem(_Model):
    """A run in the list of its job."""

    id: str
    parameters: dict[str, float]
    """SI, for example the speed. [m/s]"""
    state: StateName
    attempt: int
    """How often it was begun: more than once where something died on the way."""
    progress: Progress | None
    error: Trouble | None


class Job(_Model):
    """One submission."""

    id: str
    kind: str
    name: str
    state: StateName
    progress: Progress | None
    created: str
    started: str | None
    ended: str | None
    error: Trouble | None
    priority: int
    """Greater ones begin first; of equal ones the older."""
    position: int | None
    """Jobs that wait before this one, while it waits itself."""
    estimated_start: tuple[str, str] | None
    """Earliest and latest time at the pace of the last jobs, while it waits; null where nothing
    is known of the pace."""
    source: str | None
    """The job that it is a clone of."""
    runs: list[RunItem]


class JobList(_Model):
    """Newest first."""

    items: list[Job]
    next: str | None
    """Give it as ``cursor`` for the next page; null on the last."""


class Run(_Model):
    """One time integration."""

    id: str
    job: str
    index: int
    parameters: dict[str, float]
    state: StateName
    attempt: int
    progress: Progress | None
    error: Trouble | None
    summary: dict[str, Any] | None
    """``facts``, ``peaks``, ``timings`` [s], ``versions``; null before the run is done."""
    verdicts: list[dict[str, Any]]
    """Rule, clause, limit, value, place, time, speed, filter and scope of each."""


class VerdictList(_Model):
    """Of a job: of each rule the worst of all runs, with the run it comes from."""

    items: list[dict[str, Any]]
    judged: int
    """Runs that are done."""
    runs: int
    """All runs."""


class UnitItem(_Model):
    """``shown value = stored value * scale``."""

    symbol: str
    display: str
    scale: float


class ChannelItem(_Model):
    """One recorded history."""

    name: str
    title: str
    unit: UnitItem
    group: str
    place: tuple[float, float, float] | None
    """Where it is measured. [m]"""
    time_offset: float
    """Added to the step's time. [s]"""


class ChannelList(_Model):
    """Channels of a run."""

    items: list[ChannelItem]
    samples: int
    """Of the whole run."""
    committed: int
    """That can be read now."""
    time_step: float
    """[s]"""


class FrameItem(_Model):
    """One stored shape."""

    index: int
    step: int
    time: float
    """[s]"""


class FrameList(_Model):
    """Shapes that are stored. Ask for one with ``?index=``."""

    items: list[FrameItem]
    frames: int
    """Of the whole run."""
    vertices: int
    bodies: int


class FrameValues(_Model):
    """One shape as JSON."""

    index: int
    step: int
    time: float
    """[s]"""
    displacement: list[list[float]]
    """Of each vertex: x, y, z. [m]"""
    bodies: list[list[float]]
    """Bounce, roll, pitch of each body. [m, rad, rad]"""
    velocity: list[float] | None
    """Upwards, of each vertex; null in a modal run, and in runs of before. [m/s]"""
    acceleration: list[float] | None
    """Upwards, of each vertex, likewise. [m/s2]"""


class EstimateItem(_Model):
    """What all runs cost together."""

    runs: int
    steps: int
    unknowns: int
    seconds: float
    """Computing time, one run after the other. [s]"""
    basis: str = "closed formula"
    """What the time is from, for example "3 past runs on this machine"."""
    memory_bytes: float
    """Of one run. [B]"""
    disk_bytes: float
    """[B]"""


class QuantityItem(_Model):
    """A derived value."""

    title: str
    value: float
    unit: UnitItem


class Report(_Model):
    """What is known of a study before it runs."""

    errors: list[FindingItem]
    warnings: list[FindingItem]
    derived: dict[str, QuantityItem]
    estimate: EstimateItem | None
    """Null while there are errors."""


class TemplateItem(_Model):
    """A study ready to submit."""

    name: str
    title: str
    description: str
    kind: Literal["crossing", "modes"]
    """What to compute: ``kind`` of ``POST /jobs``."""
    study: dict[str, Any]
    """As ``POST /jobs`` takes it."""
    estimate: EstimateItem | None
    notes: list[str]
    """Warnings about it on this machine."""


class TemplateList(_Model):
    """The one-click job first."""

    items: list[TemplateItem]


class Meta(_Model):
    """What the page needs to know."""

    version: str
    plotly_url: str
    openapi_url: str


class Health(_Model):
    """Whether the server answers and its queue works."""

    status: Literal["ok"]
    coordinator: Literal["here", "elsewhere"]
    """Whether this process hands out the runs, or another one that it cannot see."""
    trouble: str | None = None
    """Why the coordinator here hands out nothing at the moment; it tries again by itself."""


class JobChange(BaseModel):
    """What can be changed of a job that has not ended."""

    model_config = ConfigDict(extra="forbid", strict=True, use_attribute_docstrings=True)

    priority: int = Field(ge=-LARGEST_PRIORITY, le=LARGEST_PRIORITY)
    """Greater ones begin first."""


class Login(BaseModel):
    """What the login page sends."""

    model_config = ConfigDict(extra="forbid", strict=True)

    token: str = Field(min_length=1, max_length=500)
