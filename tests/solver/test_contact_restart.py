"""The algebra of a restart of rigid contact, against bodies that can be computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from solver.contact.restart import force_ripple, restart_forces, restart_impulses

MASS, HALF_BASE = 3000.0, 1.5
"""A frame on two wheels. [kg, m]"""


def frame(inertia_ratio: float) -> np.ndarray:
    """Mobility between the wheels of a frame whose inertia is the ratio times m a^2."""
    direct = (1.0 + 1.0 / inertia_ratio) / MASS
    cross = (1.0 - 1.0 / inertia_ratio) / MASS
    return np.array([[direct, cross], [cross, direct]])


def test_a_mass_takes_the_rate_of_its_path() -> None:
    found = restart_impulses(np.array([[1 / 900.0]]), np.array([-0.05]), np.zeros(1), True)
    assert found.change[0] == pytest.approx(45.0)
    assert found.total[0] == pytest.approx(45.0)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_what_the_step_has_spent_counts_whatever_its_share(share: float) -> None:
    """A kink within the step: Newmark's velocity is anything from 0 to twice the path's."""
    compliance = np.array([[1 / 900.0]])
    spent = np.array([2.0 * share * 45.0])
    rate = np.array([2.0 * share * 0.05 - 0.05])
    found = restart_impulses(compliance, rate, spent, True)
    assert found.closed.all()
    assert found.total[0] == pytest.approx(45.0)
    assert rate[0] + found.change[0] / 900.0 == pytest.approx(0.0, abs=1e-15)


def test_a_wheel_that_was_dragged_down_is_let_go_and_keeps_its_velocity() -> None:
    """A kink downwards: only tension would keep the wheel on its path."""
    found = restart_impulses(np.array([[1 / 900.0]]), np.array([-0.05]), np.array([-90.0]), True)
    assert not found.closed.any()
    assert found.change[0] == 0.0
    assert found.total[0] == 0.0


def test_a_long_frame_is_thrown_off_its_other_wheel_a_short_one_is_not() -> None:
    """A blow under one wheel lifts the other if J > m a^2: the rail does not pull it back."""
    blow = np.array([-0.05, 0.0])
    thrown = restart_impulses(frame(2.0), blow, np.zeros(2), True)
    np.testing.assert_array_equal(thrown.closed, [True, False])
    assert thrown.total[0] == pytest.approx(0.05 / frame(2.0)[0, 0])
    pressed = restart_impulses(frame(0.5), blow, np.zeros(2), True)
    assert pressed.closed.all()
    assert pressed.total.min() > 0.0
    held = restart_impulses(frame(2.0), blow, np.zeros(2), False)
    assert held.closed.all()
    assert held.total[1] < 0.0


def test_forces_belong_to_the_candidates_only() -> None:
    down = np.full(2, -9.81)
    both, closed, _ = restart_forces(frame(2.0), down, np.ones(2, bool), True)
    np.testing.assert_allclose(both, MASS * 9.81 / 2)
    assert closed.all()
    one, closed, _ = restart_forces(frame(2.0), down, np.array([True, False]), True)
    assert one[0] == pytest.approx(9.81 / frame(2.0)[0, 0])
    np.testing.assert_array_equal(closed, [True, False])
    none, closed, solves = restart_forces(frame(2.0), -down, np.ones(2, bool), True)
    np.testing.assert_array_equal(none, 0.0)
    assert not closed.any()
    assert solves > 0


def test_nothing_in_question_needs_nothing() -> None:
    found = restart_impulses(np.zeros((0, 0)), np.zeros(0), np.zeros(0), True)
    assert found.total.size == found.closed.size == 0
    _, _, solves = restart_forces(np.eye(2), np.ones(2), np.zeros(2, bool), True)
    assert solves == 0


def test_ripple_is_the_force_that_the_error_calls_for() -> None:
    error = np.array([[0.1, 0.0], [0.0, 0.0]])
    ripple = force_ripple(frame(1.0), error)
    np.testing.assert_allclose(ripple[:, 0], [0.1 * MASS / 2, 0.0])
    np.testing.assert_array_equal(ripple[:, 1], 0.0)
