"""Neves (2016), section 2.2.6: two springs, one contact, and when iteration diverges."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from solver.contact.path import beam_path
from solver.errors import ConvergenceError
from solver.integrators.hht import HHT
from solver.methods.integrate import MethodName, make_method
from solver.methods.iterative import predict_convergence
from solver.methods.problem import PrescribedSpeed, Problem, Wheels
from solver.methods.settings import Settings
from solver.models.subsystem import Subsystem
from solver.verification.case import Case, Findings, Progress, Result

__all__ = ["CASE"]

NAME = "two-springs"
_STRUCTURE, _VEHICLE, _FORCE = 8e7, 2e7, 100e3
"""Stiffnesses [N/m] and the force on each of the two, upwards [N]."""
_ONE_STEP = Settings(method=HHT(0.0, 1.0), n_step=1)
_METHODS: tuple[MethodName, ...] = ("direct", "iterative")


def run(progress: Progress) -> Result:
    """Direct solution; predicted convergence of the iteration and of its permutation."""
    findings = Findings(NAME)
    problem = two_springs(_STRUCTURE, _VEHICLE)
    for name in _METHODS:
        *_, last = make_method(problem, _ONE_STEP, name).states()
        findings.close(
            f"displacement, {name} method", "m", 2e-3, float(last.displacement[0]), 2e-10,
            "Two divisions, or an iteration that stops at 1e-8 of the displacement.",
        )  # fmt: skip
        findings.close(
            f"contact force, {name} method", "N", -60e3, float(last.contact_forces[0]), 6e-3,
            "Rounding, or an iteration that stops at 1e-8; tension by design.",
        )  # fmt: skip
    for name, first, second, radius in (
        ("iteration", _STRUCTURE, _VEHICLE, 0.25), ("permuted", _VEHICLE, _STRUCTURE, 4.0),
    ):  # fmt: skip
        prediction = predict_convergence(two_springs(first, second), _ONE_STEP)
        findings.close(f"spectral radius of the {name}", "", radius,
                       float(prediction.radius), 1e-9,
                       "Ratio of the springs, in a quasi-static step.")  # fmt: skip
    diverged = 0.0
    try:
        list(make_method(two_springs(_VEHICLE, _STRUCTURE), _ONE_STEP, "iterative").states())
    except ConvergenceError:
        diverged = 1.0
    findings.close("the permuted iteration stops with an error (1 = yes)", "", 1.0, diverged, 0.0,
                   "A radius of 4 cannot converge; it must be said, not returned.")  # fmt: skip
    progress(1.0)
    return findings.result()


def two_springs(structure: float, vehicle: float) -> Problem:
    """A spring from the ground and one above it, without mass, both pulled up by 100 kN.

    The forces begin after t = 0, so that a step has something to find.

    Args:
        structure: Stiffness of the spring that stands for the structure. [N/m]
        vehicle: Of the other one. [N/m]
    """
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    both = sparse.csr_array(np.ones((2, 1)))
    path = beam_path(points, both, sparse.csr_array((2, 1)))
    one, none = sparse.csr_array(np.ones((1, 1))), sparse.csr_array((1, 1))
    wheels = Wheels(names=("contact",), rows=(none, none, one), chainage=np.array([0.5]))
    return Problem(
        structure=_spring("the structure", structure),
        vehicle=_spring("the vehicle", vehicle),
        wheels=wheels,
        path=path,
        drive=PrescribedSpeed(speed=0.0),
        unilateral=False,
    )


def _spring(name: str, stiffness: float) -> Subsystem:
    none = sparse.csr_array((1, 1))
    return Subsystem(
        name=name,
        mass=none,
        damping=none,
        stiffness=sparse.csr_array(np.array([[stiffness]])),
        load=lambda time: np.array([_FORCE if time > 0.0 else 0.0]),
    )


CASE = Case(
    name=NAME,
    title="Two springs: direct and iterative solution",
    source="Neves (2016), section 2.2.6",
    weight="fast",
    run=run,
)
