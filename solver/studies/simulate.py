"""The Python call: a checked study becomes a simulation."""

from __future__ import annotations

from solver.errors import InputError
from solver.simulation import Simulation
from solver.studies.check import check
from solver.studies.prepare import prepare
from solver.studies.scene import StageListener
from solver.studies.study import Study

__all__ = ["simulate"]


def simulate(
    study: Study, run_index: int = 0, report: StageListener = lambda stage: None
) -> Simulation:
    """Checks a study and makes one of its runs ready; iterate over it to take the steps.

    Args:
        study: The study.
        run_index: Which point of the sweep.
        report: Told the name of each stage as it begins.

    Returns:
        The simulation: an iterable of samples, the first of them the static start.

    Raises:
        InputError: The first error that ``check`` finds.
        SingularSystemError: Something can move without resistance.
    """
    errors = check(study).errors
    if errors:
        first = errors[0]
        field = ".".join(str(part) for part in first.path)
        raise InputError(field, first.value, first.reason, first.remedy)
    return prepare(study, run_index, report)
