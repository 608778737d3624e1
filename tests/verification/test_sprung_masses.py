"""Neves (2016), sections 4.4.1 and 5.3.1, against semi-analytical solutions without shared code.

``solver.reference`` integrates modal equations (20 modes) by DOP853; ``simulate`` has finite
elements, HHT-alpha and the contact problem.
"""

from __future__ import annotations

import numpy as np
import pytest

from solver.reference import Crossing, SimplySupportedBeam, moving_sprung_masses
from solver.studies import Study, prepare, template


def histories(study: Study) -> tuple[np.ndarray, dict[str, np.ndarray], int]:
    """Times, channels by name, contact status changes."""
    simulation = prepare(study)
    samples = list(simulation.samples())
    values = np.array([sample.channels for sample in samples])
    names = [channel.name for channel in simulation.plan.channels]
    times = np.array([sample.time for sample in samples])
    changes = simulation.effective.state.status_changes
    return times, dict(zip(names, values.T, strict=True)), changes


def reference(study: Study, times: np.ndarray, n_mode: int = 20):
    bridge, train = study.viaduct, study.train
    beam = SimplySupportedBeam(
        length=bridge.spans[0],
        rigidity=bridge.young_modulus * bridge.second_moment,
        mass_per_length=bridge.mass_per_length,
        n_mode=n_mode,
        n_span=len(bridge.spans),
    )
    crossing = Crossing(
        beam=beam,
        speed=study.sweep.speeds[0],
        offsets=-train.spacing * np.arange(train.count),
        times=times,
        points=np.array([0.5 * bridge.spans[0]]),
    )
    return moving_sprung_masses(
        crossing,
        np.full(train.count, train.mass),
        np.full(train.count, train.stiffness),
        unilateral=study.contact.unilateral,
    )


@pytest.mark.slow
def test_one_sprung_mass_follows_the_semi_analytical_solution() -> None:
    """4.4.1 with dt = 2.5e-4 s: displacements within 5e-4 of the peak (the issue's bound)."""
    study = template("sprung-mass-beam").study
    times, channels, _ = histories(study)
    expected = reference(study, times)
    for found, wanted in (
        (channels["mid-span 1/displacement"], expected.displacement[:, 0]),
        (channels["mass 01/displacement"], expected.load_displacement[:, 0]),
    ):
        assert np.abs(found - wanted).max() < 5e-4 * np.abs(wanted).max()


def test_the_fourth_mass_leaves_the_beam_and_returns_the_first_never_does() -> None:
    """5.3.1, rigid contact, alpha = -0.1."""
    study = template("two-span-separation").study
    _, channels, changes = histories(study)
    assert channels["wheel 01/contact force"].min() > 0.0
    fourth = channels["wheel 04/contact force"]
    away = np.flatnonzero(fourth == 0.0)
    returned = fourth[away[0] :]
    assert away.size > 10
    assert returned.max() > 0.5 * 30e3 * 9.81
    assert changes >= 2
    assert np.all(fourth >= 0.0)


@pytest.mark.slow
def test_separation_agrees_with_the_unilateral_reference() -> None:
    """5.3.1: displacement within 1 percent; every loss and return of contact within two steps."""
    study = template("two-span-separation").study
    times, channels, _ = histories(study)
    inside = times <= 0.87
    expected = reference(study, times[inside])
    found = channels["mid-span 1/displacement"][inside]
    wanted = expected.displacement[:, 0]
    assert np.abs(found - wanted).max() < 0.01 * np.abs(wanted).max()
    for wheel in range(4):
        force = channels[f"wheel {wheel + 1:02d}/contact force"][inside]
        events = np.flatnonzero(np.diff((force == 0.0).astype(int)))
        reference_force = expected.contact_force[:, wheel]
        wanted_events = np.flatnonzero(np.diff((reference_force <= 0.0).astype(int)))
        assert events.size == wanted_events.size
        assert np.all(np.abs(events - wanted_events) <= 2)
        assert abs(force.max() - reference_force.max()) < 1e-3 * reference_force.max()
