"""Modal analysis of a viaduct, of a track or of a train, stored like a history of shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.arrays import Matrix, Vector
from solver.results import ChannelSpec, Frame, RunPlan, Sample, SlabPoints
from solver.studies.modal_shapes import PartModes
from solver.studies.scene import StageListener
from solver.studies.study import Study
from solver.studies.track_modes import track_modes
from solver.studies.train_modes import train_modes
from solver.studies.viaduct_modes import viaduct_modes
from solver.units import Units

__all__ = ["ModalRun", "modal_analysis", "modal_run"]

_FINDERS: dict[str, Callable[[Study, StageListener], PartModes]] = {
    "viaduct": viaduct_modes,
    "track": track_modes,
    "train": train_modes,
}


@dataclass(frozen=True, kw_only=True)
class ModalRun:
    """A modal analysis in the form of a run.

    Attributes:
        plan: As a crossing's; ``modal`` is set, and sample k is the shape of mode k (from 0).
        summary: Plain JSON: ``{"modes": [{"number", "frequency" [Hz], "damping" [1], "name",
            "assurance"}], "facts": {...}}``.
        found: The modes.
    """

    plan: RunPlan
    summary: dict[str, Any]
    found: PartModes

    def samples(self) -> Iterator[Sample]:
        """One sample and frame a mode; the greatest displacement of each is 1, and upwards where
        it is vertical."""
        for mode in range(self.plan.n_sample):
            yield _sample(self.found, mode)


def modal_run(study: Study, report: StageListener = lambda stage: None) -> ModalRun:
    """Finds the modes of the part that ``study.modes`` names.

    Args:
        study: The study; ``check(study, "modes")`` says what of it matters.
        report: Told each stage.

    Returns:
        The modes, ready to be stored.

    Raises:
        InputError: The part cannot be built.
        SingularSystemError: It can move without resistance.
    """
    found = _FINDERS[study.modes.part](study, report)
    facts: dict[str, object] = {
        "part": study.modes.part,
        "unknowns": int(found.shapes.shape[0]),
        "damping": "damping ratios are the diagonal of the modal damping matrix",
        **found.facts,
    }
    plan = RunPlan(
        n_step=found.frequencies.size - 1,
        time_step=1.0,
        speed=0.0,
        start_position=0.0,
        window_start=0.0,
        channels=tuple(
            ChannelSpec(
                name=f"{name}/displacement", unit=Units.none, group="wheel",
                title=f"Shape of the mode at {name}",
            )
            for name in found.geometry.wheels.names
        ),
        slab=SlabPoints(
            coordinates=np.zeros((0, 3)), span=np.zeros(0, np.int64), judged_spans=(), named={}
        ),
        geometry=found.geometry,
        frame_stride=1,
        facts=facts,
        modal=True,
    )  # fmt: skip
    return ModalRun(plan=plan, summary={"modes": _entries(found), "facts": facts}, found=found)


def modal_analysis(study: Study, report: StageListener = lambda stage: None) -> dict[str, Any]:
    """Modal analysis as plain JSON: frequencies, damping, what each mode looks like.

    Args:
        study: The study; ``study.modes`` says of what, and how many.
        report: Told each stage.

    Returns:
        The ``summary`` of ``ModalRun``.
    """
    return modal_run(study, report).summary


def _entries(found: PartModes) -> list[dict[str, Any]]:
    """The table of modes as plain JSON; modes that look like nothing known have no name."""
    return [
        {
            "number": index + 1,
            "frequency": float(found.frequencies[index]),
            "damping": float(found.damping[index]),
            "name": found.names.get(index, ""),
            "assurance": found.likeness.get(index, 0.0),
        }
        for index in range(found.frequencies.size)
    ]


def _sample(found: PartModes, mode: int) -> Sample:
    """A mode's shape as a sample with its frame."""
    shape = found.shapes[:, mode]
    surface = np.asarray(found.surface @ shape).reshape(-1, 3)
    wheels = np.asarray(found.wheels @ shape)
    bodies = np.asarray(found.bodies @ shape).reshape(-1, 3)
    scale = _scale(surface, wheels, _edges(found, bodies))
    return Sample(
        step=mode,
        time=float(mode),
        channels=wheels / scale,
        slab=np.zeros(0),
        frame=Frame(displacement=surface / scale, bodies=bodies / scale),
    )


def _edges(found: PartModes, bodies: Matrix) -> Vector:
    """What bounce, roll and pitch move at the farthest edge of each body's box, with a sign."""
    sizes = np.array([body.size[:2] for body in found.geometry.bodies]).reshape(-1, 2)
    bounce, roll, pitch = bodies.T
    reach = np.abs(bounce) + 0.5 * np.abs(roll) * sizes[:, 1] + 0.5 * np.abs(pitch) * sizes[:, 0]
    turns = np.where(pitch != 0.0, pitch, roll)
    return np.copysign(reach, np.where(bounce != 0.0, bounce, turns))


def _scale(surface: Matrix, wheels: Vector, edges: Vector) -> float:
    """The greatest displacement, with the sign that makes it point upwards (or forwards)."""
    lengths = np.linalg.norm(surface, axis=1)
    signs = np.sign(surface[:, 2])
    values = np.concatenate([np.where(signs != 0.0, signs, 1.0) * lengths, wheels, edges])
    return float(values[np.argmax(np.abs(values))])
