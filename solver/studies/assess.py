"""From the histories of a run to verdicts, peaks and filtered curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import cast

import numpy as np

from solver.arrays import IntVector, Matrix, Vector
from solver.irregularities import describe
from solver.models.beam_bridge import BeamBridge
from solver.models.train import ArticulatedTrain
from solver.results import RunPlan, SlabPeaks
from solver.simulation import Extremes
from solver.standards.deck_acceleration import CutOff, decide, eurocode_cut_off
from solver.standards.low_pass import low_pass
from solver.standards.passenger_comfort import CarPeak, passenger_comfort
from solver.standards.slab_peaks import slab_peaks
from solver.standards.verdict import Scope, Verdict
from solver.studies.study import Study

__all__ = ["Assessment", "assess"]

SlabBlocks = Callable[[], Iterable[tuple[IntVector, Matrix]]]
"""Gives the slab's histories in blocks: point indices (n,), accelerations (n_sample, n)."""
PointHistory = Callable[[int], Vector]
"""Gives the acceleration history of one slab point, shape (n_sample,)."""


@dataclass(frozen=True, kw_only=True)
class Assessment:
    """What a finished run says.

    Attributes:
        verdicts: Plain JSON, one criterion each.
        unjudged: Why there is no verdict, else empty.
        cut_off: Of the filtered histories, 0 without. [Hz]
        filtered: Low-pass filtered acceleration of each named point and of the "deciding point",
            shape (n_sample,). [m/s2]
        peaks: Extremes of each channel since the window opened, plain JSON.
        slab_peaks: Greatest accelerations of the slab's points.
        comfort: Of the passengers, plain JSON; None of a train without cars.
    """

    verdicts: tuple[dict[str, object], ...]
    unjudged: str
    cut_off: float
    filtered: dict[str, Vector]
    peaks: dict[str, dict[str, float]]
    slab_peaks: SlabPeaks
    comfort: dict[str, object] | None


def assess(
    study: Study,
    plan: RunPlan,
    extremes: Extremes,
    slab_blocks: SlabBlocks,
    point_history: PointHistory,
) -> Assessment:
    """Judges a finished run.

    Args:
        study: The study.
        plan: The run's plan.
        extremes: Extremes of the channels, from the simulation.
        slab_blocks: The slab's histories, in blocks that bound the memory.
        point_history: The history of one slab point.

    Returns:
        The assessment.
    """
    peaks = _peaks(plan, extremes)
    comfort = _comfort(study, peaks)
    judged = not isinstance(study.viaduct, BeamBridge)
    cut_off = _cut_off(study, plan) if judged else None
    greatest = slab_peaks(
        slab_blocks(),
        n_point=len(plan.slab.coordinates),
        # The times for which the method gives accelerations.
        times=(np.arange(plan.n_sample) + study.integration.alpha) * plan.time_step,
        window_start=plan.window_start,
        cut_off=None if cut_off is None else cut_off.frequency,
    )
    if cut_off is None:
        return Assessment(
            verdicts=(),
            unjudged=(
                "Not judged: a plain beam is no ballasted deck, "
                "EN 1990:2002/A1 A2.4.4.2.1(4) does not apply."
            ),
            cut_off=0.0,
            filtered={},
            peaks=peaks,
            slab_peaks=greatest,
            comfort=comfort,
        )
    verdict = _verdict(study, plan, greatest, cut_off, _bearings_in_tension(plan, extremes))
    place = verdict.place
    deciding = np.argmin(np.abs(plan.slab.coordinates - (place.x, place.y, place.z)).sum(axis=1))
    points = {**plan.slab.named, "deciding point": int(deciding)}
    filtered = {
        name: low_pass(point_history(index)[:, None], plan.time_step, cut_off.frequency)[:, 0]
        for name, index in points.items()
    }
    return Assessment(
        verdicts=(verdict.to_dict(),),
        unjudged="",
        cut_off=cut_off.frequency,
        filtered=filtered,
        peaks=peaks,
        slab_peaks=greatest,
        comfort=comfort,
    )


def _verdict(
    study: Study,
    plan: RunPlan,
    peaks: SlabPeaks,
    cut_off: CutOff,
    bearings_in_tension: tuple[str, ...],
) -> Verdict:
    """On the deck's acceleration."""
    return decide(
        peaks,
        slab=plan.slab,
        cut_off=cut_off,
        scope=Scope(
            train=study.train.name,
            speed=plan.speed,
            irregularity=describe(study.irregularity),
            mesh_level=study.mesh_level,
        ),
        line_speed=study.line_speed or None,
        highest_speed=max(study.sweep.speeds) if len(study.sweep.speeds) > 1 else None,
        bearings_in_tension=bearings_in_tension,
    )


def _cut_off(study: Study, plan: RunPlan) -> CutOff:
    """The user's cut-off, or the standard's."""
    chosen = study.outputs.cut_off_frequency
    if chosen > 0.0:
        return CutOff(frequency=chosen, origin="chosen by the user")
    first, _, third = cast(Sequence[float], plan.facts["member_frequencies"])
    return eurocode_cut_off(first, third)


def _peaks(plan: RunPlan, extremes: Extremes) -> dict[str, dict[str, float]]:
    return {
        channel.name: {
            "least": float(extremes.least[index]),
            "time_of_least": float(extremes.time_of_least[index] + channel.time_offset),
            "greatest": float(extremes.greatest[index]),
            "time_of_greatest": float(extremes.time_of_greatest[index] + channel.time_offset),
        }
        for index, channel in enumerate(plan.channels)
        if np.isfinite(extremes.least[index])
    }


def _comfort(study: Study, peaks: dict[str, dict[str, float]]) -> dict[str, object] | None:
    """Comfort in the cars of an articulated train."""
    train = study.train
    if not isinstance(train, ArticulatedTrain):
        return None
    types = {vehicle.name: vehicle for vehicle in train.vehicle_types}
    alone = [types[name].articulation == "none" for name in train.consist]
    cars = [
        _car_peak(f"carbody {number:02d}", peaks, passengers=all(alone) or not powered)
        for number, powered in enumerate(alone, start=1)
    ]
    found = [car for car in cars if car is not None]
    if not any(car.passengers for car in found):
        return None
    return asdict(passenger_comfort(found))


def _car_peak(name: str, peaks: dict[str, dict[str, float]], *, passengers: bool) -> CarPeak | None:
    """Greatest magnitude of a car's acceleration; None where it has no sample in the window."""
    peak = peaks.get(f"{name}/acceleration")
    if peak is None:
        return None
    side = "greatest" if peak["greatest"] >= -peak["least"] else "least"
    return CarPeak(
        name=name, peak=abs(peak[side]), time=peak[f"time_of_{side}"], passengers=passengers
    )


def _bearings_in_tension(plan: RunPlan, extremes: Extremes) -> tuple[str, ...]:
    return tuple(
        channel.name.split("/")[0]
        for index, channel in enumerate(plan.channels)
        if channel.group == "bearing" and extremes.greatest[index] > 0.0
    )
