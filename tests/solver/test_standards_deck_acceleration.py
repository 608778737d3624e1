"""The deck acceleration verdict: which points and times decide, and in which words."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from solver.errors import InputError, UnstableError
from solver.results import SlabPeaks, SlabPoints
from solver.standards import (
    CutOff,
    Scope,
    Verdict,
    cut_off_frequency,
    decide,
    eurocode_cut_off,
    slab_peaks,
    under_ballast,
    worst,
)

STEP = 5e-4
TIMES = np.arange(0.0, 3.0, STEP)
WINDOW_START = 1.0
CLAUSE = "EN 1990:2002/A1 A2.4.4.2.1(4)"


def slab() -> SlabPoints:
    """Two points a span on three spans; the middle span decides."""
    x = np.array([8.0, 9.0, 27.0, 28.0, 48.0, 49.0])
    return SlabPoints(
        coordinates=np.column_stack([x, np.full(6, 0.0), np.full(6, 1.335)]),
        span=np.array([0, 0, 1, 1, 2, 2]),
        judged_spans=(1,),
        named={"mid-span 2, axis": 2},
    )


def burst(amplitude: float, centre: float, frequency: float = 6.0) -> NDArray[np.float64]:
    """A short vibration round one instant."""
    late = TIMES - centre
    return amplitude * np.cos(2 * np.pi * frequency * late) * np.exp(-((late / 0.15) ** 2))


def histories() -> NDArray[np.float64]:
    """Point 2: 4.0 at 2 s with strong noise at 200 Hz; louder elsewhere and before the window."""
    history = np.zeros((len(TIMES), 6))
    history[:, 2] = burst(4.0, 2.0) + burst(6.0, 2.0, 200.0)
    history[:, 3] = -burst(3.0, 2.2) + burst(50.0, 0.4)
    history[:, 0] = burst(9.0, 2.1)
    return history


def blocks(history: NDArray[np.float64], size: int) -> Iterator[tuple[NDArray, NDArray]]:
    """The histories, a few points at a time."""
    for start in range(0, history.shape[1], size):
        indices = np.arange(start, min(start + size, history.shape[1]))
        yield indices, history[:, indices]


def verdict(size: int = 6, scale: float = 1.0, **changes: object) -> Verdict:
    """The verdict over the histories above."""
    settings: dict[str, object] = {
        "slab": slab(),
        "cut_off": eurocode_cut_off(6.4, 17.1),
        "scope": Scope(
            train="KHST", speed=120.0, irregularity="no irregularities", mesh_level="standard"
        ),
    }
    settings |= changes
    window_start = settings.pop("window_start", WINDOW_START)
    cut_off = settings["cut_off"].frequency  # type: ignore[attr-defined]
    found = peaks(blocks(scale * histories(), size), cut_off, window_start)  # type: ignore[arg-type]
    return decide(found, **settings)  # type: ignore[arg-type]


def peaks(
    given: Iterable[tuple[NDArray, NDArray]],
    cut_off: float | None = 30.0,
    window_start: float = WINDOW_START,
) -> SlabPeaks:
    """Peaks of the six points."""
    return slab_peaks(given, n_point=6, times=TIMES, window_start=window_start, cut_off=cut_off)


def test_cut_off_is_the_greatest_of_three() -> None:
    assert cut_off_frequency(6.4, 17.1) == 30.0
    assert cut_off_frequency(25.0, 17.1) == 37.5
    assert cut_off_frequency(6.4, 41.0) == 41.0
    assert "1.5 f1 = 9.60 Hz" in eurocode_cut_off(6.4, 17.1).origin
    assert CLAUSE in eurocode_cut_off(6.4, 17.1).origin


def test_points_under_the_ballast() -> None:
    coordinates = np.array([[0, -2.15, 0], [0, 2.15, 0], [0, 2.16, 0], [0, 0, 0]], dtype=float)
    assert list(under_ballast(coordinates)) == [True, True, False, True]


def test_judged_span_decides_inside_the_window() -> None:
    found = verdict()
    # The noise at 200 Hz is gone, the burst of 50 came before the window, span 1 does not decide.
    assert found.value == pytest.approx(4.0, rel=2e-3)
    assert found.time == pytest.approx(2.0, abs=STEP)
    assert (found.place.name, found.place.x) == ("mid-span 2, axis", 27.0)
    assert found.raw.value == pytest.approx(10.0, rel=1e-9)
    assert found.exceeds
    assert found.limit == 3.5


def test_spans_and_named_points_are_shown_beside() -> None:
    found = verdict()
    first, middle, last = found.spans
    assert (first.number, first.judged, first.remark) == (1, False, "end conditions not modelled")
    assert first.filtered.value == pytest.approx(9.0, rel=2e-3)
    assert middle.judged
    assert middle.remark == ""
    assert last.filtered.value == 0.0
    (point,) = found.points
    assert point.name == "mid-span 2, axis"
    assert point.filtered.value == found.value
    assert point.raw.value == pytest.approx(10.0)


def test_block_by_block_is_the_whole() -> None:
    whole = verdict(6).to_dict()
    for size in (1, 4):
        assert verdict(size).to_dict() == whole


def test_statement_that_exceeds() -> None:
    assert verdict().statement == (
        f"exceeds 3.5 m/s2 ({CLAUSE}, ballasted, below 30 Hz): 4.00 m/s2 at x = 27.0 m, "
        "y = 0.00 m, t = 2.00 s, KHST at 432 km/h, standard mesh; raw 10.0 m/s2"
    )


def test_statement_within_the_limit_claims_no_more() -> None:
    found = verdict(scale=0.5)
    assert found.statement == (
        f"within the limit of 3.5 m/s2 at 432 km/h ({CLAUSE}, ballasted, below 30 Hz): "
        "2.00 m/s2 at x = 27.0 m, y = 0.00 m, t = 2.00 s, KHST, standard mesh; raw 5.0 m/s2"
    )
    words = json.dumps(found.to_dict()).lower()
    assert "safe" not in words
    assert "pass" not in words.replace("both passes", "")


def test_value_beside_the_limit_does_not_read_as_the_limit() -> None:
    found = verdict(scale=3.5002 / verdict().value)
    assert found.exceeds
    assert ": 3.5002 m/s2" in found.statement


def test_directly_fastened_track_has_its_own_limit() -> None:
    found = verdict(fastening="direct")
    assert (found.limit, found.exceeds) == (5.0, False)
    assert "direct fastening" in found.statement


def test_irregularity_is_part_of_the_statement() -> None:
    scope = Scope(train="KHST", speed=120.0, irregularity="a dip", mesh_level="")
    assert "KHST at 432 km/h, a dip; raw" in verdict(scope=scope).statement


def test_notes() -> None:
    coarse = Scope(train="KHST", speed=100.0, irregularity="", mesh_level="coarse")
    notes = verdict(scope=coarse, bearings_in_tension=("span 2, start, left",)).notes
    assert notes[0].startswith("Screening mesh")
    assert "EN 1991-2:2003 6.4.6.2(1) asks for speeds up to 1.2 times the line speed" in notes[1]
    assert notes[2] == "Spans 1 and 3: end conditions not modelled; shown, not judged."
    assert "span 2, start, left" in notes[3]
    assert not any("Screening" in note for note in verdict().notes)


@pytest.mark.parametrize(
    ("line_speed", "highest_speed", "asked"),
    [(None, None, True), (100.0, None, True), (100.0, 119.9, True), (100.0, 120.0, False)],
)
def test_speed_note_until_a_sweep_reaches_it(
    line_speed: float | None, highest_speed: float | None, asked: bool
) -> None:
    scope = Scope(train="KHST", speed=100.0, irregularity="", mesh_level="")
    notes = verdict(scope=scope, line_speed=line_speed, highest_speed=highest_speed).notes
    assert any("EN 1991-2" in note for note in notes) == asked
    if line_speed and asked:
        assert any("432 km/h for a line speed of 360 km/h" in note for note in notes)


def test_one_universal_train_is_not_the_load_model() -> None:
    scope = Scope(train="HSLM-A4", speed=100.0, irregularity="", mesh_level="")
    (said,) = [note for note in verdict(scope=scope).notes if "HSLM" in note]
    assert "6.4.6.1.1(4)" in said
    assert said.endswith("this verdict is for HSLM-A4.")
    assert not any("HSLM" in note for note in verdict().notes)


def test_json_is_plain() -> None:
    plain = verdict().to_dict()
    assert json.loads(json.dumps(plain, allow_nan=False)) == plain
    assert plain["scope"]["train"] == "KHST"
    assert plain["cut_off"] == 30.0


def test_worst_is_nearest_to_its_limit() -> None:
    mild, severe = verdict(scale=0.5), verdict()
    direct = verdict(fastening="direct", scale=1.1)
    assert worst([mild, severe, direct]) is severe


def test_not_a_number_is_never_within_the_limit() -> None:
    history = histories()
    history[3000, 4] = np.nan
    with pytest.raises(UnstableError):
        peaks(blocks(history, 6))


def test_missing_or_repeated_points_are_refused() -> None:
    history = histories()
    whole = (np.arange(6), history)
    for given in ([(np.arange(5), history[:, :5])], [whole, whole]):
        with pytest.raises(InputError, match="missing or comes twice"):
            peaks(given)


def test_every_point_has_its_raw_and_its_filtered_peak() -> None:
    found = peaks(blocks(histories(), 4))
    assert found.filtered is not None
    assert found.filtered_time is not None
    # Two bursts of 4 and 6 at one instant; below 30 Hz the one at 200 Hz is gone.
    assert found.raw[2] == pytest.approx(10.0, rel=1e-6)
    assert found.filtered[2] == pytest.approx(4.0, rel=0.005)
    assert found.raw_time[2] == pytest.approx(2.0, abs=1e-9)
    assert found.filtered_time[2] == pytest.approx(2.0, abs=STEP)
    # The burst of 50 came before the window.
    assert found.raw[3] == pytest.approx(3.0, rel=1e-3)
    assert found.raw[4] == found.filtered[4] == 0.0


def test_what_is_not_judged_has_raw_peaks_alone() -> None:
    found = peaks(blocks(histories(), 6), cut_off=None)
    assert found.filtered is None
    assert found.filtered_time is None
    assert found.raw[0] == pytest.approx(9.0, rel=1e-6)
    with pytest.raises(InputError, match=r"peaks\.filtered"):
        decide(
            found,
            slab=slab(),
            cut_off=CutOff(frequency=30.0, origin="by hand"),
            scope=Scope(train="KHST", speed=1.0, irregularity="", mesh_level=""),
        )


def test_window_after_the_end_is_refused() -> None:
    with pytest.raises(InputError, match="no sample lies in the window"):
        verdict(window_start=4.0)
