"""The words of the deck acceleration verdict. It never says more than was computed."""

from __future__ import annotations

from solver.data import load
from solver.models.hslm import hslm_a_names
from solver.standards.verdict import Peak, Scope, SpanPeak

__all__ = ["deck_notes", "deck_statement", "kilometres_per_hour"]

_FASTENING_WORDS = {"ballasted": "ballasted", "direct": "direct fastening"}
_PERFECT = "no irregularities"


def kilometres_per_hour(speed: float) -> str:
    """A speed as people read it.

    Args:
        speed: [m/s]

    Returns:
        For example ``432 km/h``.
    """
    return f"{round(3.6 * speed, 1):g} km/h"


def deck_statement(
    deciding: Peak,
    raw: Peak,
    limit: float,
    clause: str,
    fastening: str,
    cut_off: float,
    scope: Scope,
) -> str:
    """The verdict as a sentence.

    Args:
        deciding: Filtered peak. [m/s2]
        raw: Raw peak. [m/s2]
        limit: Of the standard. [m/s2]
        clause: Standard and clause.
        fastening: ``ballasted`` or ``direct``.
        cut_off: Of the filter. [Hz]
        scope: Of the run.

    Returns:
        For example *exceeds 3.5 m/s2 (EN 1990:2002/A1 A2.4.4.2.1(4), ballasted, below 30 Hz):
        4.02 m/s2 at x = 27.0 m, y = 0.00 m, t = 2.31 s, KHST at 432 km/h, standard mesh; raw 9.7
        m/s2*.
    """
    basis = f"({clause}, {_FASTENING_WORDS[fastening]}, below {cut_off:.3g} Hz)"
    speed = kilometres_per_hour(scope.speed)
    if deciding.value > limit:
        judgement, train = f"exceeds {limit:g} m/s2 {basis}", f"{scope.train} at {speed}"
    else:
        judgement = f"within the limit of {limit:g} m/s2 at {speed} {basis}"
        train = scope.train
    place = deciding.place
    details = [
        f"x = {place.x:.1f} m",
        f"y = {place.y:.2f} m",
        f"t = {deciding.time:.2f} s",
        train,
    ]
    if scope.irregularity and scope.irregularity != _PERFECT:
        details.append(scope.irregularity)
    if scope.mesh_level:
        details.append(f"{scope.mesh_level} mesh")
    value = _beside_limit(deciding.value, limit)
    return f"{judgement}: {value} m/s2 at {', '.join(details)}; raw {raw.value:.1f} m/s2"


def deck_notes(
    scope: Scope,
    spans: tuple[SpanPeak, ...],
    line_speed: float | None,
    highest_speed: float | None,
    bearings_in_tension: tuple[str, ...],
) -> tuple[str, ...]:
    """What a reader must know before using the verdict.

    Args:
        scope: Of the run.
        spans: Every span, those that do not decide included.
        line_speed: Of the line, if stated. [m/s]
        highest_speed: Reached by the sweep, if it is one. [m/s]
        bearings_in_tension: Names of bearings that were pulled.

    Returns:
        One sentence a note.
    """
    notes: list[str] = []
    if scope.mesh_level == "coarse":
        notes.append("Screening mesh: confirm on the standard mesh before using this value.")
    speed_note = _speed_note(scope.speed, line_speed, highest_speed)
    if speed_note:
        notes.append(speed_note)
    notes += _train_notes(scope.train)
    shown = [str(span.number) for span in spans if not span.judged]
    if shown:
        subject = "Span" if len(shown) == 1 else "Spans"
        notes.append(
            f"{subject} {' and '.join(shown)}: end conditions not modelled; shown, not judged."
        )
    if bearings_in_tension:
        notes.append(
            "Bearing in tension, dead load included, while the model holds it down: "
            f"{', '.join(bearings_in_tension)}."
        )
    return tuple(notes)


def _speed_note(speed: float, line_speed: float | None, highest_speed: float | None) -> str:
    """Until a sweep reaches 1.2 times a stated line speed, what EN 1991-2 asks for."""
    rule = load("standards")["maximum_design_speed"]
    factor = float(rule["value"])
    reached = max(speed, highest_speed or 0.0)
    asked = f"{rule['clause']} asks for speeds up to {factor:g} times the line speed"
    if line_speed is None:
        return f"{asked}, which is not stated; this verdict is for {kilometres_per_hour(speed)}."
    # A sweep in km/h meets 1.2 times the line speed but for rounding.
    if highest_speed is not None and reached >= factor * line_speed * (1 - 1e-9):
        return ""
    return (
        f"{asked}: {kilometres_per_hour(factor * line_speed)} for a line speed of "
        f"{kilometres_per_hour(line_speed)}; this verdict is for {kilometres_per_hour(speed)}."
    )


def _beside_limit(value: float, limit: float) -> str:
    """The value with as many decimals as it takes not to read as the limit itself."""
    for decimals in range(2, 7):
        text = f"{value:.{decimals}f}"
        if float(text) != limit or value == limit:
            return text
    return f"{value:.9g}"


def _train_notes(train: str) -> list[str]:
    """One universal train is not the load model.

    References:
        EN 1991-2:2003 6.4.6.1.1(4).
    """
    if train not in {f"HSLM-{name}" for name in hslm_a_names()}:
        return []
    return [
        "EN 1991-2:2003 6.4.6.1.1(4) asks for the critical one of HSLM-A1 to A10 on a simply "
        f"supported span, else for all ten; this verdict is for {train}."
    ]
