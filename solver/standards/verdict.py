"""The verdict: one criterion of a standard, applied to one run, with its scope."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["NamedPeak", "Peak", "Place", "Scope", "SpanPeak", "Verdict", "worst"]


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where something happened.

    Attributes:
        name: For example ``mid-span 2, axis``.
        x: Along the track. [m]
        y: To the left. [m]
        z: Upwards. [m]
    """

    name: str
    x: float
    y: float
    z: float


@dataclass(frozen=True, kw_only=True)
class Peak:
    """The greatest magnitude of a history.

    Attributes:
        value: Its magnitude, in the verdict's unit.
        time: When. [s]
        place: Where.
    """

    value: float
    time: float
    place: Place


@dataclass(frozen=True, kw_only=True)
class NamedPeak:
    """Filtered and raw peak of one named point.

    Attributes:
        name: The point's name.
        filtered: Peak of the filtered history.
        raw: Peak of the raw history: informative, without verdict.
    """

    name: str
    filtered: Peak
    raw: Peak


@dataclass(frozen=True, kw_only=True)
class SpanPeak:
    """Filtered and raw peak of one span.

    Attributes:
        number: 1 is the first span.
        judged: It decides; otherwise it is shown only.
        filtered: Peak of the filtered histories.
        raw: Peak of the raw histories: informative, without verdict.
        remark: Why it does not decide, else empty.
    """

    number: int
    judged: bool
    filtered: Peak
    raw: Peak
    remark: str


@dataclass(frozen=True, kw_only=True)
class Scope:
    """What the verdict holds for, and nothing else.

    Attributes:
        train: The train's name.
        speed: Its speed. [m/s]
        irregularity: In words, for example ``no irregularities``.
        mesh_level: ``coarse``, ``standard`` or ``fine``; empty where there are no levels.
    """

    train: str
    speed: float
    irregularity: str
    mesh_level: str


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """One criterion, applied.

    Attributes:
        rule: Short name of the criterion, for example ``deck acceleration``.
        clause: Standard and clause.
        title: What is judged, in words.
        limit: The standard's limit, in ``unit``.
        value: The deciding value, in ``unit``.
        unit: SI symbol.
        exceeds: The value is greater than the limit.
        place: Where the deciding value occurs.
        time: When. [s]
        speed: Of the train. [m/s]
        filter: The filter, in words.
        cut_off: Its cut-off. [Hz]
        cut_off_origin: Where the cut-off comes from, in words.
        scope: What it holds for.
        statement: The verdict as a sentence.
        notes: What a reader must know before using it.
        raw: Peak before the filter over the same points: informative, without verdict.
        points: Peaks of the named points.
        spans: Peaks of every span.
    """

    rule: str
    clause: str
    title: str
    limit: float
    value: float
    unit: str
    exceeds: bool
    place: Place
    time: float
    speed: float
    filter: str
    cut_off: float
    cut_off_origin: str
    scope: Scope
    statement: str
    notes: tuple[str, ...]
    raw: Peak
    points: tuple[NamedPeak, ...]
    spans: tuple[SpanPeak, ...]

    @property
    def utilisation(self) -> float:
        """The value over the limit."""
        return self.value / self.limit

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON: dictionaries, lists, strings, numbers and truth values."""
        plain: dict[str, Any] = _plain(asdict(self))
        return plain


def worst(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict that comes nearest to its limit or exceeds it most.

    Args:
        verdicts: Of one run or of several.

    Returns:
        The one with the greatest value over limit; the first of equals.

    Raises:
        ValueError: There is none.
    """
    return max(verdicts, key=lambda verdict: verdict.utilisation)


def _plain(value: Any) -> Any:
    """Tuples become lists; everything else in a verdict is plain already."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return value
