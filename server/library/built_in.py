"""The library's entries that come with the solver: read-only, each with source and confidence.

Values are those of the solver itself; only what is known *about* them stands here. The letters of
confidence: A two sources or more, B one source, C from memory or conflicting, D derived here; what
no source prints is called assumed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cache
from typing import Any

from server.library.parts import PARTS
from solver import studies
from solver.data import load
from solver.irregularities import Irregularity, IsolatedDefect, NoIrregularity
from solver.models.hslm import hslm_a, hslm_a_names
from solver.studies import Study

__all__ = ["BuiltInEntry", "Remark", "built_in_entries"]


@dataclass(frozen=True, kw_only=True)
class Remark:
    """What to know of one figure.

    Attributes:
        pointer: JSON pointer into the part.
        confidence: ``assumed``, or a letter.
        text: Why.
    """

    pointer: str
    confidence: str
    text: str


@dataclass(frozen=True, kw_only=True)
class BuiltInEntry:
    """A part that comes with the solver; times of change it has none."""

    id: str
    kind: str
    name: str
    source: str
    confidence: str
    value: Mapping[str, Any]
    remarks: tuple[Remark, ...] = field(default=())


@cache
def built_in_entries() -> tuple[BuiltInEntry, ...]:
    """All of them, in the order in which a page shows them."""
    return (*_trains(), *_viaducts(), *_tracks(), *_irregularities())


def _part(kind: str, study: Study) -> Mapping[str, Any]:
    return studies.to_json(study)[PARTS[kind]]


def _study(template: str) -> Study:
    return studies.template(template).study


def _trains() -> list[BuiltInEntry]:
    data = load("khst")
    return [
        BuiltInEntry(
            id="khst",
            kind="trains",
            name=data["title"],
            source=data["source"],
            confidence=data["confidence"],
            value=_part("trains", _study("khst-alverca")),
            remarks=_KHST_REMARKS,
        ),
        BuiltInEntry(
            id="yang-yau-sprung-mass",
            kind="trains",
            name="One sprung mass of Yang and Yau",
            source="Neves (2016), section 4.4.1, after Yang and Yau (1997)",
            confidence="B: one source; the semi-analytical solution is met (trainbridge verify)",
            value=_part("trains", _study("sprung-mass-beam")),
        ),
        BuiltInEntry(
            id="four-sprung-masses",
            kind="trains",
            name="Four sprung masses, 20 m apart",
            source="Neves (2016), section 5.3.1",
            confidence="B: one source; two independent engines agree on it (trainbridge verify)",
            value=_part("trains", _study("two-span-separation")),
        ),
        *(_hslm_a(name) for name in hslm_a_names()),
    ]


def _hslm_a(name: str) -> BuiltInEntry:
    """A universal train of EN 1991-2."""
    data, study = load("hslm_a"), _study("sprung-mass-beam")
    return BuiltInEntry(
        id=f"hslm-{name.lower()}",
        kind="trains",
        name=f"HSLM-{name} of EN 1991-2",
        source=data["source"],
        confidence=data["confidence"],
        value=_part("trains", replace(study, train=hslm_a(name))),
        remarks=_HSLM_REMARKS,
    )


_HSLM_REMARKS = (
    Remark(
        pointer="/bounce_frequency",
        confidence="assumed",
        text=(
            "The standard's forces are constant; masses on springs of 0.1 Hz press with a force "
            "that varies by one part in ten thousand while the rail moves by some millimetres."
        ),
    ),
    Remark(
        pointer="/damping_ratio",
        confidence="assumed",
        text="Without damping the force depends on the springs alone.",
    ),
)


_KHST_REMARKS = (
    Remark(
        pointer="/damper_heights/upper",
        confidence="assumed",
        text="The heights of the inter-car dampers are not printed.",
    ),
    Remark(
        pointer="/damper_heights/lower",
        confidence="assumed",
        text="The heights of the inter-car dampers are not printed.",
    ),
    Remark(
        pointer="/roll_coupling",
        confidence="assumed",
        text="How cars share the roll springs of their common bogie is not printed.",
    ),
    Remark(
        pointer="/passenger_orientation",
        confidence="D",
        text="A reading: it gives the printed wheel loads, the other one does not.",
    ),
)


def _viaducts() -> list[BuiltInEntry]:
    return [
        BuiltInEntry(
            id="alverca",
            kind="viaducts",
            name="Alverca viaduct, spans of 16.5, 21 and 21 m",
            source="Neves (2016), table 7.1, figures 7.5 to 7.9, sections 6.3.5 and 7.2",
            confidence=(
                "B for materials, spans, bearing stiffnesses and damping (printed); the mid-lines "
                "of the section and the places of the bearings are readings of a figure"
            ),
            value=_part("viaducts", _study("khst-alverca")),
            remarks=_ALVERCA_REMARKS,
        ),
        BuiltInEntry(
            id="yang-yau-beam",
            kind="viaducts",
            name="Simple beam of Yang and Yau, 25 m",
            source="Neves (2016), section 4.4.1, after Yang and Yau (1997)",
            confidence="B: one source; closed forms are met (trainbridge verify)",
            value=_part("viaducts", _study("sprung-mass-beam")),
        ),
        BuiltInEntry(
            id="two-spans",
            kind="viaducts",
            name="Two simple spans of 20 m",
            source="Neves (2016), section 5.3.1",
            confidence="B: one source",
            value=_part("viaducts", _study("two-span-separation")),
            remarks=(
                Remark(
                    pointer="/second_moment",
                    confidence="B",
                    text=(
                        "The printed 6.1 Hz is that of a beam with shear deformation (6.07 Hz); "
                        "this Euler-Bernoulli beam has 6.21 Hz."
                    ),
                ),
            ),
        ),
    ]


_READ_OFF = "Read off figure 7.5; not printed as a number."
_ALVERCA_REMARKS = (
    Remark(
        pointer="/edge_mass",
        confidence="assumed",
        text="The mass of edge beams and safeguards is not printed.",
    ),
    Remark(
        pointer="/bearing_inset",
        confidence="assumed",
        text="The places of the bearings are not printed; the frequencies depend on them.",
    ),
    Remark(
        pointer="/bearing_position",
        confidence="assumed",
        text="The places of the bearings are not printed; under the webs is a reading.",
    ),
    *(
        Remark(pointer=f"/{name}", confidence="D", text=_READ_OFF)
        for name in (
            "slab_level",
            "web_position",
            "web_thickness",
            "bottom_thickness",
            "wall_position",
            "wall_thickness",
            "wall_height",
        )
    ),
    Remark(
        pointer="/damping",
        confidence="D",
        text=(
            "Whose damping the ballast on a span has is not printed; the deck's gives the 3.4 "
            "percent of the first modes."
        ),
    ),
)


def _tracks() -> list[BuiltInEntry]:
    rail = load("rail_60E1")
    return [
        BuiltInEntry(
            id="ballasted-60e1",
            kind="tracks",
            name="Ballasted track with 60E1 rails, Alverca",
            source=(
                "Neves (2016), tables 6.5 to 6.7, figures 6.13 and 6.14, sections 6.3.2, 6.3.5 and "
                "7.3.1"
            ),
            confidence=f"B: one source; rail: {rail['confidence']}",
            value=_part("tracks", _study("khst-alverca")),
            remarks=(
                Remark(
                    pointer="/ballast_depth",
                    confidence="B",
                    text=(
                        "0.313 m is figure 6.14's; a fit to the printed frequencies would give "
                        "0.355 m."
                    ),
                ),
                Remark(
                    pointer="/sleeper_phase",
                    confidence="assumed",
                    text="One sleeper stands at the start of the first span.",
                ),
                Remark(
                    pointer="/embankment_length",
                    confidence="D",
                    text="The extent of the model before the viaduct, not a property of the track.",
                ),
            ),
        ),
        BuiltInEntry(
            id="no-track",
            kind="tracks",
            name="No track: wheels on the beam itself",
            source="Neves (2016), sections 4.4.1 and 5.3.1",
            confidence="A: an idealisation, nothing is measured",
            value=_part("tracks", _study("sprung-mass-beam")),
        ),
    ]


_PROFILE = "Neves (2016), equation 7.3"
_EXPONENT = Remark(
    pointer="/wave_number",
    confidence="B",
    text=(
        "The printed exponent is ambiguous; (k (x - x0))^2 / 2 agrees with the printed widths of "
        "12.1, 8.7 and 6.7 m for k = 0.5, 0.7 and 0.9 1/m."
    ),
)


def _irregularities() -> list[BuiltInEntry]:
    dip = IsolatedDefect()
    return [
        _irregularity("perfect-rail", "Perfect rails", NoIrregularity()),
        _irregularity("isolated-10mm", "Isolated defect, 10 mm, 6.7 m long", dip),
        _irregularity(
            "isolated-16mm", "Isolated defect, 16 mm, 6.7 m long", replace(dip, amplitude=0.016)
        ),
        _irregularity(
            "isolated-10mm-long",
            "Isolated defect, 10 mm, 12.1 m long",
            replace(dip, wave_number=0.5),
        ),
        _irregularity(
            "dip-10mm",
            "Isolated dip, 10 mm, both rails",
            replace(dip, amplitude=-0.010, rail="both"),
        ),
    ]


def _irregularity(name: str, title: str, properties: Irregularity) -> BuiltInEntry:
    defect = isinstance(properties, IsolatedDefect)
    return BuiltInEntry(
        id=name,
        kind="irregularities",
        name=title,
        source=_PROFILE if defect else "An idealisation",
        confidence=(
            "B for the shape (one source); the amplitude is an example, not a measurement"
            if defect
            else "A: an idealisation, nothing is measured"
        ),
        value=asdict(properties),
        remarks=(_EXPONENT,) if defect else (),
    )
