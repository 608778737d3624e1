"""Studies ready to run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from solver.errors import InputError
from solver.models.beam_bridge import BeamBridge
from solver.models.train import SprungMasses, khst
from solver.models.viaduct import ViaductProperties
from solver.studies.study import Contact, Extent, Integration, NoTrack, Outputs, Study, Sweep

__all__ = ["Template", "template", "templates"]


@dataclass(frozen=True, kw_only=True)
class Template:
    """A named study.

    Attributes:
        name: As used in addresses and on the command line.
        title: What people read.
        description: One or two sentences.
        study: The study, ready to submit.
    """

    name: str
    title: str
    description: str
    study: Study


def _khst_alverca() -> Template:
    return Template(
        name="khst-alverca",
        title="KHST over the Alverca viaduct",
        description=(
            "The Korean high-speed train, 20 cars, crosses the first three spans at 432 km/h, "
            "near the resonance of the 21 m spans. Coarse screening mesh: a verdict in a minute."
        ),
        study=Study(
            name="KHST over the Alverca viaduct",
            train=khst(),
            viaduct=ViaductProperties(),
            integration=Integration(time_step=5e-4),
            mesh_level="coarse",
        ),
    )


def _khst_alverca_standard() -> Template:
    return Template(
        name="khst-alverca-standard",
        title="KHST over the Alverca viaduct, standard mesh",
        description=(
            "The same crossing on the standard mesh of about 110,000 unknowns with a time step "
            "of 0.25 ms. Takes some tens of minutes."
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


_MAKERS: dict[str, Callable[[], Template]] = {
    "khst-alverca": _khst_alverca,
    "khst-alverca-standard": _khst_alverca_standard,
    "sprung-mass-beam": _sprung_mass_beam,
    "two-span-separation": _two_span_separation,
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
