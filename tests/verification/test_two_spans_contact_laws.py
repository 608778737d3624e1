"""Neves (2016), section 5.3.1: four masses over two spans at 115 m/s, all three contact laws."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solver.studies import prepare, template
from solver.studies.study import Contact, Integration
from solver.system.energy import EnergyBalance

STUDY = template("two-span-separation").study


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.0, -0.1])
@pytest.mark.parametrize("law", ["rigid", "linear_hertz", "nonlinear_hertz"])
def test_the_fourth_mass_leaves_and_returns_and_the_energy_is_accounted_for(
    law: str, alpha: float
) -> None:
    study = replace(
        STUDY, contact=Contact(law=law), integration=Integration(alpha=alpha, time_step=2.5e-4)
    )
    simulation = prepare(study)
    balance = EnergyBalance(
        simulation.effective, simulation.integrator.motions, simulation.plan.time_step
    )
    forces, worst, exchange = [], 0.0, 0.0
    for sample in islice(simulation, 1, None):
        terms = balance.record(sample.time)
        worst, exchange = max(worst, abs(terms.gap)), max(exchange, terms.exchange)
        forces.append(simulation.effective.state.contact_forces.copy())
    first, fourth = np.array(forces)[:, 0], np.array(forces)[:, 3]
    assert first.min() > 0.0
    times = 2.5e-4 * np.arange(1, len(fourth) + 1)
    on_beam = (115.0 * times > 60.0) & (115.0 * times < 80.0)
    away, x = fourth[on_beam] == 0.0, 115.0 * times[on_beam] - 60.0
    # It leaves the first beam before its end, for three metres, and returns on the second.
    assert 17.5 < x[np.argmax(away)] < 19.0
    assert fourth.min() >= 0.0
    landed = (115.0 * times > 82.5) & (115.0 * times < 86.0)
    assert fourth[landed].min() > 0.0
    assert fourth[landed].max() > 2.0 * 30e3 * 9.81
    # Some jumps of four masses; a contact that chatters changes at every step of 3,600.
    assert simulation.status_changes < 30
    # Massless contact points lose nothing when they land; half of the gap is the supports' kinks.
    assert terms.impact == 0.0
    assert worst < 2e-4 * exchange
    assert (terms.integration > 0.0) == (alpha < 0.0)


@pytest.mark.slow
def test_the_linear_law_with_its_stiffness_at_the_static_load_is_the_nonlinear_one() -> None:
    """k_h(294.3 kN) = 1.846e9 N/m (section 3.4): equal to first order, jumps included."""
    found = []
    for contact in (Contact(law="linear_hertz", stiffness=1.846e9), Contact(law="nonlinear_hertz")):
        simulation = prepare(replace(STUDY, contact=contact))
        names = [channel.name for channel in simulation.plan.channels]
        found.append(np.array([sample.channels for sample in simulation]))
    linear, nonlinear = found
    middle = names.index("mid-span 1/displacement")
    peak = np.abs(linear[:, middle]).max()
    assert np.abs(linear - nonlinear)[:, middle].max() < 0.01 * peak
    for wheel in range(4):
        column = names.index(f"wheel {wheel + 1:02d}/contact force")
        # Up to 0.06 where a mass lands with nearly three times its weight.
        assert np.abs(linear - nonlinear)[:, column].max() < 0.1 * 30e3 * 9.81
