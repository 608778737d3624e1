"""At which speeds a train excites a span in resonance, before anything is computed."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from math import pi, sqrt

import numpy as np

from solver.arrays import BoolVector, Matrix
from solver.models.ballasted_track import TrackProperties
from solver.models.beam_bridge import BeamBridge
from solver.models.train import ArticulatedTrain, AxleTable
from solver.models.train_layout import lay_out
from solver.models.viaduct import ViaductProperties
from solver.studies.study import Study

__all__ = [
    "SpanFrequency",
    "first_frequency",
    "known_frequency",
    "regular_spacing",
    "resonance_speeds",
]

_ORDERS = (1, 2, 3, 4)
"""Loads a period of the span's oscillation, at most."""
_SAME_PLACE = 0.01
"""Tables of axles are rounded: places nearer than a centimetre count as equal. [m]"""
_LIKELY = 50
"""So many of the commonest distances between two axles are looked at."""


def resonance_speeds(study: Study, frequency: float) -> list[tuple[int, float]]:
    """Speeds v = f d / i at which the train's regular distance d excites a frequency f.

    Args:
        study: The study; only its train matters.
        frequency: Of the span, for example the first of a run's ``member_frequencies``. [Hz]

    Returns:
        Pairs (i, v) for i = 1 to 4, v in m/s; none where the train has no regular distance.

    References:
        EN 1991-2:2003 6.4.4, annex F: v = f d / i.
    """
    spacing = regular_spacing(study)
    if spacing is None:
        return []
    return [(order, frequency * spacing / order) for order in _ORDERS]


def regular_spacing(study: Study) -> float | None:
    """The distance of axle groups that a train repeats most often. [m]

    Returns:
        Of an articulated train the commonest distance between neighbouring bogies, of sprung masses
        theirs, of an axle table the distance at which most axles have one ahead and one behind;
        None where nothing repeats.
    """
    train = study.train
    if isinstance(train, ArticulatedTrain):
        return _bogie_spacing(train)
    if isinstance(train, AxleTable):
        return _axle_period(train)
    return train.spacing if train.count > 1 else None


@lru_cache(maxsize=32)
def _bogie_spacing(train: ArticulatedTrain) -> float | None:
    places = np.sort([bogie.offset for bogie in lay_out(train).bogies])
    distances = Counter(round(float(distance), 3) for distance in np.diff(places))
    if not distances:
        return None
    spacing, count = distances.most_common(1)[0]
    return spacing if count > 1 else None


@lru_cache(maxsize=32)
def _axle_period(train: AxleTable) -> float | None:
    """The distance at which most axles have one ahead and one behind: the length of a coach. [m]

    A bogie's own axles repeat nothing so: they are two. Of multiples that come as often, the
    shortest counts.
    """
    between = np.subtract.outer(-train.offsets, -train.offsets)
    # To a tenth of a millimetre: binary fractions of equal distances differ in their last bits.
    distances, counts = np.unique(np.round(between[between > 0], 4), return_counts=True)
    # What repeats is among the commonest distances; of 200 axles there can be 20,000.
    likely = np.sort(distances[np.argsort(-counts, kind="stable")[:_LIKELY]])
    repeats = [
        int(np.sum(_meets(between, distance) & _meets(between, -distance))) for distance in likely
    ]
    if not repeats or max(repeats) == 0:
        return None
    return float(likely[int(np.argmax(repeats))])


def _meets(between: Matrix, distance: float) -> BoolVector:
    """Which axles have another one at a distance, shape (n_axle,)."""
    return np.any(np.abs(between - distance) < _SAME_PLACE, axis=1)


@dataclass(frozen=True, kw_only=True)
class SpanFrequency:
    """First frequency of a span.

    Attributes:
        span: Number of the span, 1 is the first.
        frequency: [Hz]
        origin: Where it is from, in words.
    """

    span: int
    frequency: float
    origin: str


def first_frequency(study: Study) -> SpanFrequency:
    """First bending frequency of the longest span that decides, by a closed form.

    Within some 7 percent of a modal analysis for the spans of Alverca (6.7 against 6.5 Hz): the
    deck counts as a beam of its whole section, on its bearings, with shear in its webs.
    """
    viaduct, number = study.viaduct, _deciding_span(study)
    if isinstance(viaduct, BeamBridge):
        rigidity = viaduct.young_modulus * viaduct.second_moment
        frequency = _beam_frequency(viaduct.spans[number], rigidity, viaduct.mass_per_length)
        return SpanFrequency(
            span=number + 1, frequency=frequency, origin="closed form of a simple beam"
        )
    section = _Section.of(viaduct, study.track)
    length = viaduct.spans[number] - 2.0 * viaduct.bearing_inset
    bending = _beam_frequency(length, section.rigidity, section.mass)
    softening = section.rigidity * pi**2 / (length**2 * section.shear_rigidity)
    return SpanFrequency(
        span=number + 1,
        frequency=bending / sqrt(1.0 + softening),
        origin="estimate as a beam of the deck's section, with shear",
    )


def known_frequency(study: Study, frequency: float) -> SpanFrequency:
    """A first frequency that an earlier run of the same deck has found.

    Args:
        study: The study.
        frequency: The first of the run's ``member_frequencies``. [Hz]
    """
    span = _deciding_span(study) + 1
    return SpanFrequency(
        span=span, frequency=frequency, origin="found by an earlier run on this deck"
    )


def _deciding_span(study: Study) -> int:
    """Index of the longest span that decides; of beams, of the longest."""
    spans = study.viaduct.spans
    # Of three spans and more, the outer ones are shown and do not decide.
    inner = len(spans) > 2 and isinstance(study.viaduct, ViaductProperties)
    deciding = range(1, len(spans) - 1) if inner else range(len(spans))
    return max(deciding, key=lambda index: spans[index])


def _beam_frequency(length: float, rigidity: float, mass: float) -> float:
    """pi / (2 L^2) sqrt(EI / m). [Hz]"""
    return pi / (2.0 * length**2) * sqrt(rigidity / mass)


@dataclass(frozen=True, kw_only=True)
class _Section:
    """The deck as a beam.

    Attributes:
        rigidity: EI about its own centre. [N m2]
        shear_rigidity: G A of the webs. [N]
        mass: Of one metre, with its track. [kg/m]
    """

    rigidity: float
    shear_rigidity: float
    mass: float

    @classmethod
    def of(cls, viaduct: ViaductProperties, track: object) -> _Section:
        """The section of a viaduct under its track."""
        plates = _plates(viaduct)
        modulus, width, height, centre = np.array(plates).T
        area = width * height
        axial = modulus * area
        axis = np.sum(axial * centre) / np.sum(axial)
        own = modulus * width * height**3 / 12.0
        shear_modulus = viaduct.beam_modulus / (2.0 * (1.0 + viaduct.poisson_ratio))
        mass = viaduct.density * np.sum(area) + 2.0 * viaduct.edge_mass
        if isinstance(track, TrackProperties):
            mass += _track_mass(track)
        return cls(
            rigidity=float(np.sum(own + axial * (centre - axis) ** 2)),
            shear_rigidity=float(shear_modulus * area[1]),
            mass=float(mass),
        )


def _plates(viaduct: ViaductProperties) -> tuple[tuple[float, float, float, float], ...]:
    """Slab, webs, bottom, walls: modulus, width, height and height of the centre."""
    bottom = 0.5 * viaduct.bottom_thickness
    web = viaduct.slab_level - bottom
    return (
        (viaduct.slab_modulus, viaduct.slab_width, viaduct.slab_thickness, viaduct.slab_level),
        (viaduct.beam_modulus, 2.0 * viaduct.web_thickness, web, bottom + 0.5 * web),
        (viaduct.beam_modulus, 2.0 * viaduct.web_position, viaduct.bottom_thickness, bottom),
        (
            viaduct.slab_modulus,
            2.0 * viaduct.wall_thickness,
            viaduct.wall_height,
            viaduct.slab_level + 0.5 * viaduct.wall_height,
        ),
    )


def _track_mass(track: TrackProperties) -> float:
    """Ballast, sleepers and rails. [kg/m]"""
    sleeper = (
        0.25
        * (track.sleeper_width + track.sleeper_top_width)
        * (track.sleeper_length + track.sleeper_top_length)
        * track.sleeper_height
        * track.sleeper_density
    )
    ballast = track.ballast_width * track.ballast_depth * track.ballast_density
    return ballast + sleeper / track.sleeper_spacing + 2.0 * track.rail_area * track.rail_density
