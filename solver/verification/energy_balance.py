"""Energy balance of whole runs, the drive's work included (Neves 2016, section 5.3.1)."""

from __future__ import annotations

import numpy as np

from solver.arrays import Vector
from solver.contact.laws import ContactLaw, LinearHertz, NonlinearHertz, RigidContact
from solver.integrators.hht import HHT
from solver.methods.vehicles import GRAVITY
from solver.verification.case import Case, Findings, Progress, Result, Role, Series
from solver.verification.crossings import CrossingHistories, cross
from solver.verification.energy import EnergyBalance
from solver.verification.recording import add_equilibrium, part_of
from solver.verification.two_spans import (
    CONTACT_COEFFICIENT,
    CONTACT_STIFFNESS,
    DURATION,
    MASS,
    two_span_crossing,
)

__all__ = ["CASES"]

UNBROKEN, SEPARATION = "energy-unbroken-contact", "energy-separation"
_LINEAR = LinearHertz(stiffness=CONTACT_STIFFNESS)


def run_unbroken(progress: Progress) -> Result:
    """The first mass alone never leaves: nothing may be lost, and the balance closes at order 2."""
    findings = Findings(UNBROKEN)
    steps = (1e-3, 5e-4, 2.5e-4)
    parts = ((0.0, 0.15), (0.15, 0.45), (0.45, 1.0))
    runs = [
        _run(_LINEAR, HHT(0.0, step), 1, part_of(progress, *part))
        for step, part in zip(steps, parts, strict=True)
    ]
    balances = [_energy(run) for run in runs]
    errors = [_error(balance) for balance in balances]
    findings.close(
        "greatest remainder, dt = 0.25 ms", "of the exchange", 0.0, errors[-1], 1e-4,
        "Undamped, alpha = 0, linear Hertz: only the discretisation of the constraint is left.",
    )  # fmt: skip
    findings.at_least(
        "order of the remainder from dt = 0.5 to 0.25 ms", "", 1.8,
        float(np.log2(errors[1] / errors[2])),
        "Newmark's method keeps the energy of a linear system; the moving contact is of order 2.",
    )  # fmt: skip
    last = balances[-1]
    findings.at_least(
        "work of the drive, dt = 0.25 ms", "J", 10.0 * errors[-1] * last.exchange,
        float(np.abs(last.drive).max()),
        "Ten times the remainder at least: else the balance would not notice if it were left out.",
    )  # fmt: skip
    add_equilibrium(findings, *(run.recording for run in runs))
    _draw(findings, "one mass, linear Hertz, alpha = 0", runs[-1].time, last)
    return findings.result()


def run_separation(progress: Progress) -> Result:
    """All four masses, with loss and return of contact."""
    findings = Findings(SEPARATION)
    hertz = NonlinearHertz(coefficient=CONTACT_COEFFICIENT, reference_force=MASS * GRAVITY)
    laws: tuple[tuple[str, ContactLaw], ...] = (
        ("rigid", RigidContact()), ("linear Hertz", _LINEAR), ("nonlinear Hertz", hertz),
    )  # fmt: skip
    kept: list[CrossingHistories] = []
    for number, (name, law) in enumerate(laws):
        for half, alpha in enumerate((0.0, -0.1)):
            place = (2 * number + half) / 6.0
            run = _run(law, HHT(alpha, 5e-4), 4, part_of(progress, place, place + 1.0 / 6.0))
            balance = _energy(run)
            findings.close(
                f"greatest remainder, {name}, alpha = {alpha:g}", "of the exchange", 0.0,
                _error(balance), 1e-3,
                "At loss and return of contact the force has a kink inside a step: what is left "
                "falls with the step, to below 0.1 percent at 0.5 ms.",
            )  # fmt: skip
            scale = balance.exchange
            findings.at_least(
                f"loss of the HHT method, {name}, alpha = {alpha:g}", "of the exchange", -1e-9,
                float(balance.numerical[-1]) / scale,
                "The method may only take energy away.",
            )  # fmt: skip
            if alpha == 0.0:
                lost = float(np.abs(balance.numerical).max()) / scale
                findings.close(f"loss of Newmark's method, {name}", "of the exchange", 0.0, lost,
                               1e-8, "It takes nothing away; rounding is left.")  # fmt: skip
            kept.append(run)
    add_equilibrium(findings, *(run.recording for run in kept))
    _draw(findings, "four masses, rigid, alpha = 0", kept[0].time, _energy(kept[0]))
    _draw(findings, "four masses, nonlinear Hertz, alpha = -0.1", kept[-1].time, _energy(kept[-1]))
    return findings.result()


def _run(law: ContactLaw, method: HHT, count: int, progress: Progress) -> CrossingHistories:
    steps = round(DURATION / method.time_step)
    return cross(two_span_crossing(law, count=count), method, steps, progress, energy=True)


def _energy(run: CrossingHistories) -> EnergyBalance:
    balance = run.recording.energy
    assert balance is not None
    return balance


def _error(balance: EnergyBalance) -> float:
    return float(np.abs(balance.remainder).max()) / balance.exchange


def _draw(findings: Findings, name: str, time: Vector, balance: EnergyBalance) -> None:
    curves: tuple[tuple[str, Vector, Role], ...] = (
        ("work of gravity and drive", balance.loads + balance.drive, "reference"),
        ("stored and lost", balance.stored + balance.lost, "ours"),
        ("of which drive", balance.drive, "other"),
    )
    findings.figure(
        f"Energy: {name}", "Time [s]", "Energy [kJ]",
        *(Series(name=title, x=time, y=1e-3 * values, role=role) for title, values, role in curves),
    )  # fmt: skip


CASES = (
    Case(
        name=UNBROKEN,
        title="Energy balance, one mass over two spans in unbroken contact",
        source="Conservation of energy; Neves (2016), section 5.3.1",
        weight="slow",
        run=run_unbroken,
    ),
    Case(
        name=SEPARATION,
        title="Energy balance, four masses over two spans with loss of contact",
        source="Conservation of energy; Neves (2016), section 5.3.1",
        weight="slow",
        run=run_separation,
    ),
)
