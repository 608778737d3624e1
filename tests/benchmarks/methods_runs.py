"""One crossing by one method, in a process of its own: CPU time, memory, histories."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, SparseMatrix
from solver.contact.laws import LinearHertz, RigidContact
from solver.errors import ConvergenceError
from solver.factorisation import factorise
from solver.integrators.hht import HHT
from solver.irregularities.isolated import BellShapedDefect
from solver.methods.integrate import make_method
from solver.methods.iterative import predict_convergence
from solver.methods.problem import PrescribedSpeed, Problem, Wheels
from solver.methods.settings import Settings
from solver.models.plane_beam import BeamOnSupports, PlaneBeams, plane_beams
from solver.models.solid_beam import SolidBeams, solid_beams
from tests.solver.methods_case import sprung_wheels

LENGTH, MASS, RIGIDITY = 25.0, 2303.0, 2.87e9 * 2.9
"""The beam of section 4.4.1. [m, kg/m, N m2]"""
SPEED = 100.0 / 3.6
SPACING = {1: 0.0, 4: 3.0, 20: 1.0}
"""Distance of the wheels, by their number. [m]"""

VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "direct": ("direct", {}),
    "iterative": ("iterative", {}),
    "iterative, Aitken": ("iterative", {"acceleration": "aitken"}),
    "iterative, Aitken, on the interface": (
        "iterative", {"acceleration": "aitken", "solution": "interface"},
    ),
    "penalty": ("penalty", {}),
    "penalty, updated": ("penalty", {"solution": "update"}),
    "condensation": ("condensation", {}),
}  # fmt: skip
"""Columns of the tables: method and options."""


def beam(n_element: int) -> BeamOnSupports:
    """Beam elements."""
    return plane_beams(
        PlaneBeams(
            spans=(LENGTH,),
            rigidity=RIGIDITY,
            mass_per_length=MASS,
            elements_per_span=n_element,
        ),
        before=5.0,
        after=60.0,
    )


def solids(*elements: int) -> BeamOnSupports:
    """Eight-node solids of a rectangular section with the same stiffness."""
    height = 2.5
    properties = SolidBeams(
        spans=(LENGTH,), width=12.0 * 2.9 / height**3, height=height, young_modulus=2.87e9,
        poisson_ratio=0.2, mass_per_length=MASS, elements=(elements[0], elements[1], elements[2]),
    )  # fmt: skip
    return solid_beams(properties, before=5.0, after=60.0, edge_rows="hermite")


@dataclass(frozen=True, kw_only=True)
class Case:
    """One crossing.

    Attributes:
        mesh: Makes the structure.
        name: Of the mesh, for the tables.
        wheels: Their number.
        unsprung: Mass of each wheel; 0 for the sprung masses of 4.4.1. [kg]
        time_step: [s]
        n_step: Steps to take.
        hertz: Stiffness of a linear Hertz spring; None for rigid contact. [N/m]
    """

    mesh: Callable[[], BeamOnSupports]
    name: str
    wheels: int
    unsprung: float = 0.0
    time_step: float = 2.5e-4
    n_step: int = 400
    hertz: float | None = None

    @property
    def title(self) -> str:
        """Of the row."""
        wheel = f", {self.unsprung:g} kg each" if self.unsprung else ""
        step = f", {1e3 * self.time_step:g} ms"
        spring = ", Hertz" if self.hertz else ""
        return f"{self.name}, {self.wheels} wheel{'s' * (self.wheels > 1)}{wheel}{spring}{step}"

    @property
    def settings(self) -> Settings:
        """HHT with alpha = -0.1."""
        return Settings(method=HHT(-0.1, self.time_step), n_step=self.n_step)

    def build(self) -> tuple[Problem, SparseMatrix]:
        """The problem, and the row of the mid-span deflection."""
        structure = self.mesh()
        vehicle, rows = sprung_wheels(self.wheels, self.unsprung)
        nothing = sparse.csr_array(rows.shape)
        first = 21.0 if self.wheels == 20 else 12.0
        problem = Problem(
            structure=structure.structure,
            vehicle=vehicle,
            wheels=Wheels(
                names=tuple(f"{i + 1}" for i in range(self.wheels)),
                rows=(nothing, nothing, rows),
                chainage=first - SPACING[self.wheels] * np.arange(self.wheels),
            ),
            path=structure.path,
            law=LinearHertz(stiffness=self.hertz) if self.hertz else RigidContact(),
            drive=PrescribedSpeed(speed=SPEED),
            unilateral=False,
            irregularity=BellShapedDefect(amplitude=3e-3, wave_number=1.5, centre=first + 0.5),
        )
        return problem, structure.mid_spans


@dataclass(kw_only=True)
class Run:
    """What one method did.

    Attributes:
        set_up: CPU time before the first step. [s]
        step: CPU time of a step. [s]
        memory: Rise of the resident memory over that of the assembled problem. [B]
        deflection: At mid-span, shape (n_step + 1,). [m]
        forces: Contact forces, shape (n_step + 1, n_wheel). [N]
        iterations: Sweeps of a step, on average.
        failure: Message, if the run stopped.
    """

    set_up: float = 0.0
    step: float = 0.0
    memory: float = 0.0
    deflection: FloatArray = field(default_factory=lambda: np.zeros(0))
    forces: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    iterations: float = 0.0
    failure: str = ""


@dataclass(kw_only=True)
class Result:
    """All methods on one case."""

    case: Case
    unknowns: int
    radius: float
    runs: dict[str, Run]


def _memory(field_name: str) -> float:
    """A line of this process's memory status. [B]"""
    status = Path("/proc/self/status")
    if not status.exists():
        return 0.0
    line = next(line for line in status.read_text().splitlines() if line.startswith(field_name))
    return 1024.0 * float(line.split()[1])


def _forget_peak() -> None:
    """Lets the kernel's high-water mark of this process start anew."""
    marks = Path("/proc/self/clear_refs")
    if marks.exists():
        marks.write_text("5")


def run(
    case: Case, problem: Problem, middle: SparseMatrix, name: str, options: dict[str, Any]
) -> Run:
    """One method on one problem, in this process."""
    _forget_peak()
    before = _memory("VmRSS")
    start = time.process_time()
    method = make_method(problem, case.settings, name, **options)  # type: ignore[arg-type]
    result = Run(set_up=time.process_time() - start)
    deflection: list[float] = []
    forces: list[FloatArray] = []
    sweeps: list[int] = []
    n_structure = problem.structure.n_dof
    try:
        for state in method.states():
            deflection.append(float((middle @ state.displacement[:n_structure])[0]))
            forces.append(np.array(state.contact_forces))
            sweeps.append(state.iterations)
            if state.step == 1:
                # The first step touches everything for the first time: it is not counted.
                start = time.process_time()
    except ConvergenceError as error:
        result.failure = str(error)
    result.step = (time.process_time() - start) / max(1, len(deflection) - 2)
    result.memory = _memory("VmHWM") - before
    result.deflection, result.forces = np.array(deflection), np.array(forces)
    result.iterations = float(np.mean(sweeps[1:])) if len(sweeps) > 1 else 0.0
    return result


def _report(to: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    to.send(function(*arguments))


def apart(function: Callable[..., Any], *arguments: Any) -> Any:
    """Calls a function in a process of its own, which takes its memory with it when it ends."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=_report, args=(theirs, function, arguments))
    child.start()
    theirs.close()
    try:
        return ours.recv()
    finally:
        child.join()


def warm_up() -> None:
    """Loads the library of the sparse back end, which every later process then has."""
    factorise(sparse.eye_array(400, format="csr"), "warm-up")


def compare(case: Case, isolated: bool = True) -> Result:
    """All methods on one case."""
    problem, middle = case.build()
    call = apart if isolated else _here
    instants = np.linspace(0.0, case.n_step, 9) * case.time_step
    return Result(
        case=case,
        unknowns=problem.structure.n_dof - problem.structure.prescribed.size,
        radius=call(predict_convergence, problem, case.settings, instants).radius,
        runs={title: call(run, case, problem, middle, *how) for title, how in VARIANTS.items()},
    )


def _here(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


def error(run_: Run, reference: Run, quantity: str) -> float:
    """Greatest difference to the direct method over its greatest value, as far as both went."""
    ours, theirs = getattr(run_, quantity), getattr(reference, quantity)
    if len(ours) < 2:
        return np.nan
    return float(np.abs(ours - theirs[: len(ours)]).max() / np.abs(theirs).max())


def cases() -> list[Case]:
    """The rows of the tables."""
    small, fine = partial(beam, 50), partial(beam, 500)
    middle, large = partial(solids, 100, 4, 6), partial(solids, 100, 10, 10)
    light = [Case(mesh=small, name="beam", wheels=n) for n in (1, 4, 20)]
    light += [Case(mesh=fine, name="fine beam", wheels=n, n_step=150) for n in (1, 4, 20)]
    light += [
        Case(mesh=middle, name="solids", wheels=n, n_step=30, time_step=1e-3) for n in (1, 4, 20)
    ]
    light += [
        Case(mesh=large, name="fine solids", wheels=n, n_step=8, time_step=1e-3) for n in (4, 20)
    ]
    heavy = [
        Case(mesh=small, name="beam", wheels=4, unsprung=1800.0, time_step=h, n_step=400)
        for h in (1e-3, 2.5e-4, 5e-5)
    ]
    heavy += [
        Case(mesh=small, name="beam", wheels=4, unsprung=6000.0),
        Case(mesh=middle, name="solids", wheels=4, unsprung=1800.0, n_step=30),
        Case(mesh=middle, name="solids", wheels=4, unsprung=1800.0, n_step=30, hertz=1.2e9),
    ]
    return light + heavy
