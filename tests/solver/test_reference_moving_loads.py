"""The semi-analytical solutions against closed forms and against each other."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from solver.errors import InputError
from solver.irregularities import BellShapedDefect
from solver.reference import (
    Crossing,
    SimplySupportedBeam,
    moving_forces,
    moving_masses,
    moving_sprung_masses,
)

ONE = np.array([0.0])


def yang_and_yau(n_mode: int, n_span: int = 1, damping_ratio: float = 0.0) -> SimplySupportedBeam:
    """The beam of thesis 4.4.1."""
    return SimplySupportedBeam(
        length=25.0,
        rigidity=2.87e9 * 2.90,
        mass_per_length=2303.0,
        damping_ratio=damping_ratio,
        n_mode=n_mode,
        n_span=n_span,
    )


def crossing(beam: SimplySupportedBeam, **changes: object) -> Crossing:
    """A crossing at 100 km/h, one load, mid-span recorded."""
    settings: dict[str, object] = {
        "speed": 100 / 3.6,
        "offsets": ONE,
        "times": np.linspace(0.0, 1.2, 301),
        "points": np.array([12.5]),
    }
    return Crossing(beam=beam, **{**settings, **changes})  # type: ignore[arg-type]


def closed_form_force(setup: Crossing, force: float) -> NDArray[np.float64]:
    """Mid-span displacement under one moving force, undamped (Fryba 1972, chapter 1)."""
    beam, leaving = setup.beam, setup.beam.length / setup.speed
    displacement = np.zeros(len(setup.times))
    for n, omega in enumerate(beam.angular_frequencies, start=1):
        drive = n * np.pi * setup.speed / beam.length
        scale = -force / beam.modal_mass / (omega**2 - drive**2)
        on = np.minimum(setup.times, leaving)
        q = scale * (np.sin(drive * on) - drive / omega * np.sin(omega * on))
        rate = scale * drive * (np.cos(drive * on) - np.cos(omega * on))
        free = np.maximum(setup.times - leaving, 0.0)
        displacement += (q * np.cos(omega * free) + rate / omega * np.sin(omega * free)) * np.sin(
            n * np.pi / 2
        )
    return displacement


def test_first_frequency_of_the_thesis() -> None:
    assert yang_and_yau(1).angular_frequencies[0] == pytest.approx(30.02, abs=0.005)


def test_moving_force_is_the_closed_form() -> None:
    setup = crossing(yang_and_yau(5))
    expected = closed_form_force(setup, 56407.5)
    found = moving_forces(setup, np.array([56407.5])).displacement[:, 0]
    # Only the integrator's tolerance of 1e-10 a step stands between the two.
    assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_soft_springs_make_a_force_and_stiff_springs_a_mass() -> None:
    setup = crossing(yang_and_yau(3))
    mass = np.array([5750.0])
    force = moving_forces(setup, mass * 9.81)
    soft = moving_sprung_masses(setup, mass, np.array([1.0]))
    peak = np.abs(force.displacement).max()
    # The spring's share of the force is k w / (M g), below 1e-7.
    assert soft.displacement == pytest.approx(force.displacement, abs=1e-6 * peak)
    rigid = moving_masses(setup, mass)
    stiff = moving_sprung_masses(setup, mass, np.array([1e10]))
    # The mass on the spring differs by order (omega_beam / omega_spring)^2, and its ringing.
    assert stiff.displacement == pytest.approx(rigid.displacement, abs=1e-3 * peak)
    assert np.abs(rigid.displacement - force.displacement).max() > 0.01 * peak


def test_sprung_mass_of_the_thesis_keeps_its_momentum_and_sign() -> None:
    setup = crossing(yang_and_yau(3))
    response = moving_sprung_masses(setup, np.array([5750.0]), np.array([1.595e6]))
    # Figures 4.7 and 4.9: mid-span down to about -2.4 mm, the mass to about -2.6 mm.
    assert response.displacement.min() == pytest.approx(-2.4e-3, abs=0.05e-3)
    assert response.load_displacement.min() == pytest.approx(-2.6e-3, abs=0.05e-3)
    newton = 5750.0 * (response.load_acceleration + 9.81)
    assert response.contact_force == pytest.approx(newton)
    assert np.all(response.contact_force > 0), "compression is positive"


def test_several_masses_over_two_spans_repeat_what_one_does() -> None:
    # Without damping and far apart, the second span sees the same train one span length later;
    # sprung masses feel the first span, so this is said of forces.
    beam = yang_and_yau(3, n_span=2)
    period = beam.length / (100 / 3.6)
    times = np.arange(0, 401) * period / 200
    setup = crossing(
        beam, times=times, points=np.array([12.5, 37.5]), offsets=np.array([0.0, -20.0])
    )
    response = moving_forces(setup, np.array([1e5, 5e4]))
    first, second = response.displacement.T
    assert second[200:] == pytest.approx(first[:-200], abs=1e-9 * np.abs(first).max())
    assert np.abs(first).max() > 1e-3


def test_irregularity_lifts_the_mass_and_loads_the_beam() -> None:
    # Over ground (no beam under it yet) a slow hump is followed quasi-statically.
    hump = BellShapedDefect(amplitude=0.01, wave_number=0.05, centre=-200.0)
    setup = crossing(yang_and_yau(1), start=-400.0, surface=hump, times=np.linspace(0.0, 12.0, 241))
    response = moving_sprung_masses(setup, np.array([5750.0]), np.array([1.595e6]))
    place = setup.start + setup.speed * setup.times
    # Quasi-static to (k v / omega)^2 = 0.7 percent.
    assert response.load_displacement[:, 0] == pytest.approx(hump.elevation(place), abs=1e-4)


def test_unilateral_contact_never_pulls() -> None:
    dip = BellShapedDefect(amplitude=-0.05, wave_number=2.0, centre=5.0)
    setup = crossing(yang_and_yau(1), surface=dip, times=np.linspace(0.0, 0.6, 301))
    masses, stiffness = np.array([5750.0]), np.array([1.595e6])
    bilateral = moving_sprung_masses(setup, masses, stiffness)
    unilateral = moving_sprung_masses(setup, masses, stiffness, unilateral=True)
    assert bilateral.contact_force.min() < 0
    assert unilateral.contact_force.min() == 0
    before = np.argmax(bilateral.contact_force[:, 0] < 0)
    assert unilateral.displacement[:before] == pytest.approx(bilateral.displacement[:before])


def test_dashpot_beside_the_spring_acts_on_the_convective_rate_too() -> None:
    # A strong dashpot makes the contact point stick to the mass, as a stiff spring does.
    hump = BellShapedDefect(amplitude=0.002, wave_number=0.5, centre=12.5)
    setup = crossing(yang_and_yau(2), surface=hump, times=np.linspace(0.0, 0.9, 91))
    mass, none = np.array([5750.0]), np.array([1.0])
    stuck = moving_sprung_masses(setup, mass, none, np.array([1e7]))
    rigid = moving_masses(setup, mass)
    # The dashpot slips by the integral of M a / c, that is M v / c: 2e-5 m at 0.05 m/s.
    peak = np.abs(rigid.load_displacement).max()
    assert stuck.load_displacement == pytest.approx(rigid.load_displacement, abs=5e-5)
    assert peak > 1e-3
    with pytest.raises(InputError, match="dashpots"):
        moving_sprung_masses(setup, mass, none, np.array([1e3]), unilateral=True)


def test_damping_takes_energy_from_the_free_vibration() -> None:
    setup = crossing(yang_and_yau(1, damping_ratio=0.02), times=np.linspace(0.0, 3.0, 601))
    response = moving_forces(setup, np.array([1e5]))
    omega = setup.beam.angular_frequencies[0]
    free = setup.times > 1.0
    amplitude = np.sqrt(
        response.displacement[free, 0] ** 2 + (response.velocity[free, 0] / omega) ** 2
    )
    decay = np.log(amplitude[0] / amplitude[-1]) / (setup.times[free][-1] - setup.times[free][0])
    # The amplitude itself wobbles by the damping ratio within a cycle.
    assert decay == pytest.approx(0.02 * omega, rel=0.05)


def test_loads_on_the_span_at_the_start_are_refused() -> None:
    with pytest.raises(InputError, match="on the ground"):
        crossing(yang_and_yau(1), start=3.0)
    with pytest.raises(InputError, match="positive"):
        SimplySupportedBeam(length=0.0, rigidity=1.0, mass_per_length=1.0)
