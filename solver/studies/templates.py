"""Studies ready to run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from solver.errors import InputError
from solver.irregularities import IsolatedDefect
from solver.models.beam_bridge import BeamBridge
from solver.models.train import SprungMasses, khst
from solver.models.viaduct import ViaductProperties
from solver.studies.study import (
    Contact,
    Extent,
    Integration,
    JobKind,
    Modes,
    NoTrack,
    Outputs,
    Study,
    Sweep,
)

__all__ = ["Template", "template", "templates"]


@dataclass(frozen=True, kw_only=True)
class Template:
    """A named study.

    Attributes:
        name: As used in addresses and on the command line.
        title: What people read.
        description: One or two sentences.
        study: The study, ready to submit.
        kind: What to compute: a ``crossing`` or ``modes``.
    """

    name: str
    title: str
    description: str
    study: Study
    kind: JobKind = "crossing"


def _khst_alverca() -> Template:
    return Template(
        name="khst-alverca",
        title="KHST over the Alverca viaduct",
        description=(
            "The Korean high-speed train, 20 cars, crosses the first three spans at 432 km/h, "
            "near the resonance of the 21 m spans. Coarse screening mesh: a first verdict."
        ),
        study=Study(
            name="KHST over the Alverca viaduct",
            train=khst(),
            viaduct=ViaductProperties(),
            integration=Integration(time_step=5e-4),
            mesh_level="coarse",
        ),
    )


def _alverca_speed_sweep() -> Template:
    return Template(
        name="alverca-speed-sweep",
        title="Alverca speed sweep",
        description=(
            "The same train at 16 speeds from 300 to 450 km/h: the deck's acceleration through "
            "the resonance v = f d of the 21 m spans (6.5 Hz, bogies every 18.7 m: 437 km/h). "
            "Coarse screening mesh."
        ),
        study=replace(
            _khst_alverca().study,
            name="Alverca speed sweep",
            sweep=Sweep(speeds=tuple(speed / 3.6 for speed in range(300, 451, 10))),
        ),
    )


def _isolated_defect() -> Template:
    return Template(
        name="isolated-defect",
        title="Isolated defect at mid-span 2",
        description=(
            "The same train at 350 km/h over a hump of 16 mm on the right rail at mid-span 2: "
            "wheels leave the rail and strike it again (Neves 2016, equation 7.3). Coarse "
            "screening mesh: a first verdict."
        ),
        study=replace(
            _khst_alverca().study,
            name="Isolated defect at mid-span 2",
            irregularity=IsolatedDefect(amplitude=0.016, position=27.0),
            sweep=Sweep(speeds=(350.0 / 3.6,)),
        ),
    )


def _modes(name: str, title: str, description: str, modes: Modes) -> Template:
    """A modal analysis of a part of the one-click job."""
    study = replace(_khst_alverca().study, name=title, modes=modes)
    return Template(name=name, title=title, description=description, study=study, kind="modes")


def _viaduct_modes() -> Template:
    return _modes(
        "viaduct-modes",
        "Modes of the viaduct",
        "Natural frequencies, damping and shapes of the Alverca viaduct with its track and rails "
        "(Neves 2016, table 7.6). Coarse mesh: some seconds.",
        Modes(part="viaduct", count=24),
    )


def _train_modes() -> Template:
    return _modes(
        "train-modes",
        "Modes of the train",
        "All natural frequencies and shapes of the Korean high-speed train on rigid rails, from "
        "0.69 Hz of the carbodies to 175 Hz of the wheelsets on their contact springs (Neves "
        "2016, section 6.2).",
        Modes(part="train", count=200),
    )


def _track_modes() -> Template:
    return _modes(
        "track-modes",
        "Modes of the track",
        "Natural frequencies and shapes of 30 sleeper bays of the approach track: rail on pads, "
        "sleepers and ballast.",
        Modes(part="track", count=60),
    )


def _khst_alverca_standard() -> Template:
    return Template(
        name="khst-alverca-standard",
        title="KHST over the Alverca viaduct, standard mesh",
        description=(
            "The same crossing on the standard mesh with a time step of 0.25 ms, to confirm what "
            "the screening mesh says."
        ),
        study=Study(
            name="KHST over the Alverca viaduct, standard mesh",
            train=khst(),
            viaduct=ViaductProperties(),
            mesh_level="standard",
        ),
    )


def _sprung_mass_beam() -> Template:
    return Template(
        name="sprung-mass-beam",
        title="One sprung mass on a simple beam",
        description=(
            "The beam of Yang and Yau: one sprung mass over 25 m at 100 km/h "
            "(Neves 2016, section 4.4.1), with a semi-analytical solution to compare."
        ),
        study=Study(
            name="One sprung mass on a simple beam",
            train=SprungMasses(),
            viaduct=BeamBridge(),
            track=NoTrack(),
            contact=Contact(law="rigid", unilateral=False),
            integration=Integration(alpha=0.0, time_step=2.5e-4),
            extent=Extent(run_in=0.0, run_out=0.0),
            outputs=Outputs(frame_interval=0.005),
            sweep=Sweep(speeds=(100.0 / 3.6,)),
        ),
    )


def _two_span_separation() -> Template:
    return Template(
        name="two-span-separation",
        title="Two spans and loss of contact",
        description=(
            "Four sprung masses cross two 20 m spans at 414 km/h; the fourth leaves the beam "
            "and returns (Neves 2016, section 5.3.1)."
        ),
        study=Study(
            name="Two spans and loss of contact",
            train=SprungMasses(
                name="four sprung masses",
                mass=30e3,
                stiffness=156.55e6,
                count=4,
                spacing=20.0,
            ),
            viaduct=BeamBridge(
                spans=(20.0, 20.0), young_modulus=25e9, second_moment=3.0, mass_per_length=30e3
            ),
            track=NoTrack(),
            contact=Contact(law="rigid", unilateral=True),
            integration=Integration(alpha=-0.1, time_step=2.5e-4),
            extent=Extent(run_in=0.0, run_out=0.03),
            outputs=Outputs(frame_interval=0.0025),
            sweep=Sweep(speeds=(115.0,)),
        ),
    )


def _two_span_hertz() -> Template:
    return Template(
        name="two-span-hertz",
        title="Two spans and loss of contact, Hertz's law",
        description=(
            "The same crossing with Hertz's nonlinear spring between each mass and the beam: "
            "contact forces without the jumps of the rigid contact."
        ),
        study=replace(
            _two_span_separation().study,
            name="Two spans and loss of contact, Hertz's law",
            contact=Contact(law="nonlinear_hertz", unilateral=True),
        ),
    )


_MAKERS: dict[str, Callable[[], Template]] = {
    "khst-alverca": _khst_alverca,
    "alverca-speed-sweep": _alverca_speed_sweep,
    "isolated-defect": _isolated_defect,
    "sprung-mass-beam": _sprung_mass_beam,
    "two-span-separation": _two_span_separation,
    "viaduct-modes": _viaduct_modes,
    "train-modes": _train_modes,
    "track-modes": _track_modes,
    "khst-alverca-standard": _khst_alverca_standard,
    "two-span-hertz": _two_span_hertz,
}


def templates() -> dict[str, Template]:
    """All templates by name, the one-click job first."""
    return {name: make() for name, make in _MAKERS.items()}


def template(name: str) -> Template:
    """One template.

    Raises:
        InputError: There is none of that name.
    """
    if name not in _MAKERS:
        raise InputError(
            "template", name, "is not a template", f"Choose one of {', '.join(_MAKERS)}."
        )
    return _MAKERS[name]()
