"""Small problems that the four methods of chapter 2 solve in the tests."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, Vector
from solver.contact.path import beam_path
from solver.integrators.hht import HHT
from solver.irregularities.isolated import BellShapedDefect
from solver.methods.integrate import make_method
from solver.methods.problem import PrescribedSpeed, Problem, Wheels
from solver.methods.settings import Settings
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.models.subsystem import Subsystem

GRAVITY = 9.81
SPEED = 100.0 / 3.6


def sprung_wheels(count: int, unsprung: float = 0.0) -> tuple[Subsystem, Any]:
    """Masses of 4.4.1 with a dashpot, each over a wheel of its own: (wheel, mass) in turn."""
    mass, stiffness, damping = 5750.0, 1595e3, 5e3
    spring = sparse.kron(sparse.eye_array(count), np.array([[1.0, -1.0], [-1.0, 1.0]]), "csr")
    masses = np.tile([unsprung, mass], count)
    vehicle = Subsystem(
        name="the vehicle",
        mass=sparse.diags_array(masses, format="csr"),
        damping=damping * spring,
        stiffness=stiffness * spring,
        load=-GRAVITY * masses,
    )
    return vehicle, sparse.eye_array(2 * count, format="csr")[0::2]


def pitching_car() -> tuple[Subsystem, Any]:
    """A rigid body on two axles, without freedoms of their own at the wheels.

    Freedoms: bounce and pitch of the body, bounce and pitch of a rigid frame below it; the wheels
    stand at the frame's ends, so that their rows mix two freedoms.
    """
    half, suspension, dashpot = 1.5, 2e6, 2e4
    body, frame = np.diag([20e3, 30e3]), np.diag([1500.0, 2000.0])
    ends = np.array([[1.0, half], [1.0, -half]])
    between = np.hstack([ends, -ends])
    vehicle = Subsystem(
        name="the vehicle",
        mass=sparse.block_diag([body, frame], format="csr"),
        damping=sparse.csr_array(dashpot * between.T @ between),
        stiffness=sparse.csr_array(suspension * between.T @ between),
        load=-GRAVITY * np.array([20e3, 0.0, 1500.0, 0.0]),
    )
    return vehicle, sparse.csr_array(np.hstack([np.zeros((2, 2)), ends]))


def crossing(vehicle: Subsystem, rows: Any, **changes: Any) -> Problem:
    """A vehicle over the beam of 4.4.1 (25 m, 20 elements), wheels 3 m apart, irregular rail.

    The first wheel starts from rest at 10 m, smoothly: the irregularity is a bell at 13 m.
    """
    beam = plane_beams(
        PlaneBeams(
            spans=(25.0,), rigidity=2.87e9 * 2.9, mass_per_length=2303.0, elements_per_span=20
        ),
        before=70.0,
        after=40.0,
    )
    count = rows.shape[0]
    nothing = sparse.csr_array(rows.shape)
    given: dict[str, Any] = {
        "structure": beam.structure,
        "vehicle": vehicle,
        "wheels": Wheels(
            names=tuple(f"wheel {i + 1}" for i in range(count)),
            rows=(nothing, nothing, rows),
            chainage=10.0 - 3.0 * np.arange(count),
        ),
        "path": beam.path,
        "drive": PrescribedSpeed(speed=SPEED),
        "unilateral": False,
        "irregularity": BellShapedDefect(amplitude=3e-3, wave_number=1.5, centre=13.0),
    }
    return Problem(**(given | changes))


def two_springs(structure: float, vehicle: float) -> Problem:
    """Section 2.2.6: two springs to ground, 100 kN on each, ends that stay together.

    Args:
        structure: Stiffness of the spring that plays the structure. [N/m]
        vehicle: Of the one that plays the vehicle. [N/m]
    """

    def spring(name: str, stiffness: float) -> Subsystem:
        none = sparse.csr_array((1, 1))
        return Subsystem(
            name=name, mass=none, damping=none, stiffness=sparse.csr_array([[stiffness]]),
            load=np.array([100e3]),
        )  # fmt: skip

    one, none = sparse.csr_array([[1.0]]), sparse.csr_array((1, 1))
    path = beam_path(
        np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        sparse.csr_array([[1.0], [1.0]]),
        sparse.csr_array((2, 1)),
    )
    return Problem(
        structure=spring("the structure", structure),
        vehicle=spring("the vehicle", vehicle),
        wheels=Wheels(names=("the joint",), rows=(none, none, one), chainage=np.array([0.5])),
        path=path,
        drive=PrescribedSpeed(speed=0.0),
        unilateral=False,
        start="consistent",
    )


def steps(n_step: int, time_step: float = 5e-4, alpha: float = -0.1) -> Settings:
    """HHT with a fixed number of steps."""
    return Settings(method=HHT(alpha, time_step), n_step=n_step)


def histories(
    problem: Problem, settings: Settings, method: Any = "direct", **options: Any
) -> tuple[FloatArray, FloatArray, Vector]:
    """Displacements and contact forces at every step, and the iterations of each."""
    displacement, forces, iterations = [], [], []
    for state in make_method(problem, settings, method, **options).states():
        displacement.append(np.array(state.displacement))
        forces.append(np.array(state.contact_forces))
        iterations.append(state.iterations)
    return np.array(displacement), np.array(forces), np.array(iterations[1:])


def difference(ours: FloatArray, reference: FloatArray) -> float:
    """Greatest difference over the greatest value of the reference."""
    return float(np.abs(ours - reference).max() / np.abs(reference).max())
