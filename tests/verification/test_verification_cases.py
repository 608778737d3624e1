"""Every verification case passes, and the means of the cases notice what is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver.integrators.hht import HHT
from solver.methods import DirectMethod, PrescribedSpeed, Problem, Settings, StepState
from solver.methods.vehicles import GRAVITY, Vehicle, sprung_masses
from solver.models.plane_beam import PlaneBeams, plane_beams
from solver.verification import Case, cases
from solver.verification.case import Findings
from solver.verification.energy import EnergyAccount
from solver.verification.equilibrium import EquilibriumCheck
from solver.verification.series_spring import SeriesSpring

_SOME_SECONDS = {
    "cycloid", "inclined-beam", "moving-mass", "sprung-mass", "study-two-spans", "time-integration",
}  # fmt: skip
"""Fast cases that the inner loop leaves out."""


def _parameter(case: Case) -> object:
    marks = []
    if case.weight == "slow" or case.name in _SOME_SECONDS:
        marks.append(pytest.mark.slow)
    if case.name == "fifty-masses-solids":
        # 14,000 solves with 36,597 unknowns: five minutes alone, more beside other work.
        marks.append(pytest.mark.timeout(3600))
    return pytest.param(case, id=case.name, marks=marks)


@pytest.mark.parametrize("case", [_parameter(case) for case in cases()])
def test_case_passes(case: Case) -> None:
    told: list[float] = []
    result = case.run(told.append)
    failed = [
        f"{item.quantity}: {item.ours:.9g} for {item.reference:.9g} {item.unit}, "
        f"difference {item.difference:.3g} > {item.tolerance:.3g}"
        for item in result.comparisons
        if not item.passed
    ]
    assert not failed, "\n".join(failed)
    assert result.passed
    assert all(item.case == case.name for item in result.comparisons)
    assert all(item.reason.endswith(".") for item in result.comparisons), "reasons are sentences"
    assert told
    assert 0.0 <= min(told) <= max(told) <= 1.0


def test_names_are_distinct() -> None:
    names = [case.name for case in cases()]
    assert len(set(names)) == len(names)


def test_what_is_not_a_number_never_passes() -> None:
    findings = Findings("none")
    findings.close("nothing", "", 1.0, float("nan"), 1e9, "No tolerance covers it.")
    assert not findings.result().passed
    assert not Findings("empty").result().passed


def _small_run(alpha: float) -> tuple[Problem, HHT, Vehicle, np.ndarray, list[StepState]]:
    """Two masses over a short beam with dampers; 60 steps."""
    bridge = plane_beams(
        PlaneBeams(
            spans=(10.0,), rigidity=1e9, mass_per_length=1e4, elements_per_span=8, mass_damping=2.0,
            stiffness_damping=1e-4,
        ),
        before=6.0, after=6.0,
    )  # fmt: skip
    vehicle = sprung_masses(np.array([0.0, -4.0]), mass=5e3, stiffness=1e7, damping=1e4)
    problem = Problem(
        structure=bridge.structure,
        vehicle=vehicle.subsystem,
        wheels=vehicle.wheels,
        path=bridge.path,
        drive=PrescribedSpeed(speed=40.0),
    )
    method = HHT(alpha, 5e-3)
    assert bridge.vertical is not None
    vertical = np.concatenate([bridge.vertical, vehicle.vertical])
    states = DirectMethod(problem, Settings(method=method, n_step=60)).states()
    kept = [
        replace(
            state,
            displacement=state.displacement.copy(),
            velocity=state.velocity.copy(),
            acceleration=state.acceleration.copy(),
            contact_forces=state.contact_forces.copy(),
            reactions=state.reactions.copy(),
            chainage=state.chainage.copy(),
        )
        for state in states
    ]
    return problem, method, vehicle, vertical, kept


def _imbalances(alpha: float, spoilt: str | None) -> tuple[float, float, float]:
    problem, method, _, vertical, states = _small_run(alpha)
    # Damping proportional to mass is a force to ground, which the vertical balance has to hold.
    check = EquilibriumCheck(
        problem=problem, method=method, vertical=vertical, load=2.0 * 5e3 * GRAVITY
    )
    for state in states:
        if spoilt is not None and state.step == 40:
            setattr(state, spoilt, 1.01 * getattr(state, spoilt))
        check.observe(state)
    found = check.imbalance()
    return found.motion, found.reactions, found.vertical


@pytest.mark.parametrize("alpha", [0.0, -0.1])
def test_equilibrium_is_found_where_it_holds(alpha: float) -> None:
    # Rounding of K times a displacement: 1e12 N/m times 1e-3 m times 1e-16 over 1e5 N.
    assert max(_imbalances(alpha, None)) < 1e-9


@pytest.mark.parametrize(
    ("spoilt", "where"),
    [("contact_forces", 0), ("displacement", 0), ("acceleration", 2), ("reactions", 1)],
)
def test_a_change_of_one_percent_is_noticed(spoilt: str, where: int) -> None:
    assert _imbalances(-0.1, spoilt)[where] > 1e-4


def test_energy_is_balanced_and_a_lost_joule_is_noticed() -> None:
    problem, method, _, _, states = _small_run(-0.1)
    account, spoilt = EnergyAccount(problem, method), EnergyAccount(problem, method)
    for state in states:
        account.observe(state)
        velocity = state.velocity * (1.05 if state.step >= 30 else 1.0)
        spoilt.observe(replace(state, velocity=velocity))
    balance = account.balance()
    # The moving contact and the dampers' quadrature are of order 2 in the step of 5 ms.
    assert np.abs(balance.remainder).max() < 0.02 * balance.exchange
    assert np.all(np.diff(balance.viscous) >= 0.0)
    assert balance.numerical[-1] > 0.0
    wrong = spoilt.balance()
    assert np.abs(wrong.remainder).max() > 2.0 * np.abs(balance.remainder).max()


def test_springs_in_series_carry_the_same_force() -> None:
    spring = SeriesSpring(stiffness=1.5e8, coefficient=8e10)
    forces = np.array([0.0, 1e-3, 1.0, 1e3, 3e5, 1e6])
    # The cube root is found to 1e-14.
    assert spring.force(spring.compression(forces)) == pytest.approx(forces, rel=1e-10)
    assert spring.force(np.array([-1e-3]))[0] == 0.0
