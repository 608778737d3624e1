"""What a user should know before running a study without errors: it runs, but look at this."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from solver.factorisation import back_end_name
from solver.irregularities import IsolatedDefect
from solver.models.ballasted_track import TrackProperties
from solver.models.mesh_level import MESH_LEVELS, MeshLevel
from solver.models.train import GRAVITY, ArticulatedTrain, AxleTable, TrainProperties
from solver.models.viaduct import ViaductProperties
from solver.studies.bounds import Finding
from solver.studies.crossing import element_length
from solver.studies.estimate import estimate
from solver.studies.profile_advice import profile_advice
from solver.studies.rules import allowed_time_step, rounded_down
from solver.studies.study import JobKind, Study

__all__ = ["mesh_frequency", "warnings"]

_DECAY = 40.0
"""Way in which the transient of the static start dies out. [m]"""
_STEPS_PER_WIDTH = 4.0
"""Steps that a wheel takes over the width 1/k of a defect that it feels as it is."""
_STEPS_PER_ELEMENT = 4.0
"""Steps that a wheel takes over a rail element whose passing is still followed."""
_ELEMENTS_PER_WAVE = 6.0
"""Shells along a bending wave of the slab whose shape is still followed."""
_LIGHTEST_AXLE = 30e3
"""Trams have heavier axles. [N]"""


def warnings(study: Study, kind: JobKind = "crossing") -> list[Finding]:
    """What a user should know before running a study without errors.

    Args:
        study: The study.
        kind: What is computed.
    """
    rules = _RULES if kind == "crossing" else _MODAL_RULES.get(study.modes.part, ())
    return [found for rule in rules for found in rule(study, kind)]


def _screening_mesh(study: Study, kind: JobKind) -> Iterator[Finding]:
    """A coarse mesh is for a first look."""
    if study.mesh_level == "coarse" and isinstance(study.viaduct, ViaductProperties):
        yield Finding(
            path=("mesh_level",),
            value="coarse",
            reason="is a screening mesh",
            remedy=(
                "Confirm the verdict on the standard mesh."
                if kind == "crossing"
                else "Confirm the frequencies on the standard mesh."
            ),
        )


def _slow_back_end(study: Study, kind: JobKind) -> Iterator[Finding]:
    """Without MKL the larger meshes take hours."""
    three_dimensional = isinstance(study.viaduct, ViaductProperties)
    if three_dimensional and study.mesh_level != "coarse" and back_end_name() == "SuperLU":
        cost = estimate(study, kind)
        yield Finding(
            path=("mesh_level",),
            value=study.mesh_level,
            reason=(
                "MKL PARDISO is not installed; with SuperLU this mesh needs about "
                f"{cost.seconds / 3600.0:.1f} h and {cost.memory_bytes / 1e9:.1f} GB"
            ),
            remedy="Use the coarse mesh, or install pypardiso.",
        )


def _long_time_step(study: Study, kind: JobKind) -> Iterator[Finding]:
    """Contact forces follow the passing of the rail elements only in steps that are short enough.

    Less than half as many are refused.
    """
    del kind
    allowed = allowed_time_step(study, _STEPS_PER_ELEMENT)
    if allowed is not None:
        fastest, step = max(study.sweep.speeds), study.integration.time_step
        taken = element_length(study) / (fastest * step)
        yield Finding(
            path=("integration", "time_step"),
            value=step,
            reason=(
                f"is coarse: a wheel at {3.6 * fastest:.0f} km/h takes {taken:.1f} steps over a "
                f"rail element of {element_length(study):.3g} m"
            ),
            remedy=f"Use {allowed:.3g} s or less for smooth contact forces.",
        )


def _coarse_for_cut_off(study: Study, kind: JobKind) -> Iterator[Finding]:
    """The mesh must show what the chosen filter lets through."""
    del kind
    asked = study.outputs.cut_off_frequency
    if not isinstance(study.viaduct, ViaductProperties) or asked <= 0.0:
        return
    shown = mesh_frequency(study, study.mesh_level)
    if asked <= shown:
        return
    finer = [level for level in MESH_LEVELS if mesh_frequency(study, level) >= asked]
    yield Finding(
        path=("mesh_level",),
        value=study.mesh_level,
        reason=(
            f"follows bending waves of the slab up to about {shown:.0f} Hz; the cut-off is "
            f"{asked:g} Hz"
        ),
        remedy=(
            f"Use the {finer[0]} mesh."
            if finer
            else f"Use a cut-off of at most {rounded_down(shown):g} Hz."
        ),
    )


def mesh_frequency(study: Study, level: MeshLevel) -> float:
    """Up to which frequency a mesh follows bending waves of the slab with its ballast.

    Args:
        study: The study, with a U-girder viaduct.
        level: Density of the mesh.

    Returns:
        k^2 sqrt(D / m) / 2 pi for a wave 2 pi / k of six elements. [Hz]
    """
    viaduct, track = study.viaduct, study.track
    assert isinstance(viaduct, ViaductProperties)
    wave_number = 2.0 * math.pi / (_ELEMENTS_PER_WAVE * MESH_LEVELS[level].deck_length)
    stiffness = viaduct.slab_modulus * viaduct.slab_thickness**3
    stiffness /= 12.0 * (1.0 - viaduct.poisson_ratio**2)
    mass = viaduct.density * viaduct.slab_thickness
    if isinstance(track, TrackProperties):
        mass += track.ballast_density * track.ballast_depth
    return wave_number**2 * math.sqrt(stiffness / mass) / (2.0 * math.pi)


def _short_run_in(study: Study, kind: JobKind) -> Iterator[Finding]:
    """Peaks count from the first axle's arrival on the three-dimensional track."""
    del kind
    if not isinstance(study.track, TrackProperties):
        return
    needed = study.track.embankment_length + _DECAY
    if study.extent.run_in < needed:
        yield Finding(
            path=("extent", "run_in"),
            value=study.extent.run_in,
            reason=(
                f"leaves less than {_DECAY:.0f} m for the start's transient to die out before "
                f"x = {-study.track.embankment_length:g} m"
            ),
            remedy=f"Use {math.ceil(needed)} m or more.",
        )


def _short_defect(study: Study, kind: JobKind) -> Iterator[Finding]:
    """A wheel must feel a defect as it is."""
    del kind
    defect = study.irregularity
    if not isinstance(defect, IsolatedDefect):
        return
    allowed = 1.0 / (_STEPS_PER_WIDTH * defect.wave_number * max(study.sweep.speeds))
    if study.integration.time_step > allowed:
        yield Finding(
            path=("irregularity", "wave_number"),
            value=defect.wave_number,
            reason="makes a defect so short that a wheel takes few steps over it",
            remedy=(
                f"Use time steps of at most {rounded_down(allowed, 2):.2g} s to resolve its "
                "contact forces."
            ),
        )


def _profile(study: Study, kind: JobKind) -> Iterator[Finding]:
    """Samples of a measured profile must suit speed and time step."""
    del kind
    yield from profile_advice(study)


def _alternating_force(study: Study, kind: JobKind) -> Iterator[Finding]:
    """Without dissipation a massless contact point that is held rigidly never comes to rest.

    Its velocity alternates from step to step after every kink of the rail, as at a beam's end; a
    dashpot makes contact forces of it.
    """
    del kind
    undissipated = study.contact.law == "rigid" and study.integration.alpha == 0.0
    if undissipated and _has_dashpot_without_mass(study.train):
        yield Finding(
            path=("integration", "alpha"),
            value=0.0,
            reason=(
                "lets contact forces alternate from step to step: the train has dashpots without "
                "unsprung mass on a rigid contact"
            ),
            remedy="Use -0.05, or a contact of Hertz's law.",
        )


def _has_dashpot_without_mass(train: TrainProperties) -> bool:
    """Whether a dashpot stands on a massless contact point."""
    if isinstance(train, ArticulatedTrain):
        return False
    if isinstance(train, AxleTable):
        return any(
            axle.unsprung_mass == 0.0 and train.suspension(axle)[1] > 0.0 for axle in train.axles
        )
    return train.damping > 0.0


def _light_axles(study: Study, kind: JobKind) -> Iterator[Finding]:
    """Tables come in tonnes as often as in kilonewtons: no railway's axles weigh a tenth."""
    del kind
    train = study.train
    if not isinstance(train, AxleTable):
        return
    heaviest = max(train.axles, key=lambda axle: axle.load)
    if heaviest.load < _LIGHTEST_AXLE:
        yield Finding(
            path=("train", "axles", train.axles.index(heaviest), "load"),
            value=heaviest.load,
            reason=(
                f"is the heaviest axle, of {1e-3 * heaviest.load:.3g} kN: were tonnes given for "
                "kilonewtons?"
            ),
            remedy=f"Give loads in kilonewtons: a tonne weighs {GRAVITY:g} kN.",
        )


_Advice = Callable[[Study, JobKind], Iterator[Finding]]

_RULES: tuple[_Advice, ...] = (
    _screening_mesh,
    _slow_back_end,
    _long_time_step,
    _coarse_for_cut_off,
    _short_run_in,
    _short_defect,
    _profile,
    _alternating_force,
    _light_axles,
)
"""Of a crossing."""
_MODAL_RULES: dict[str, tuple[_Advice, ...]] = {"viaduct": (_screening_mesh, _slow_back_end)}
"""Of a modal analysis, by its part."""
