"""Sprung masses: the vehicles of the closed-form comparisons."""

from __future__ import annotations

import numpy as np
import pytest

from solver.models.train import GRAVITY, SprungMasses, build_train


def test_default_is_yang_and_yaus_mass() -> None:
    train = build_train(SprungMasses())
    omega = np.sqrt(train.stiffness[0, 0] / train.mass[0, 0])
    assert omega == pytest.approx(16.66, rel=1e-3), "thesis 4.4.1"
    assert train.mass[1, 1] == 0.0, "the contact point is massless"
    assert train.weight == pytest.approx([-5750 * GRAVITY, 0.0])


def test_masses_follow_each_other_on_the_left_rail() -> None:
    properties = SprungMasses(count=4, spacing=20.0, mass=30e3, stiffness=156.55e6, damping=1e3)
    train = build_train(properties)
    assert train.wheel_offsets == pytest.approx([0, -20, -40, -60])
    assert set(train.wheel_rail) == {0}
    assert train.total_mass == 120e3
    frequency = np.sqrt(train.stiffness[2, 2] / train.mass[2, 2]) / (2 * np.pi)
    assert frequency == pytest.approx(11.5, rel=1e-3), "thesis 5.3.1"
    # Lifting mass and contact point together strains nothing.
    assert train.stiffness @ np.ones(8) == pytest.approx(np.zeros(8), abs=1e-6)
    assert train.damping @ np.ones(8) == pytest.approx(np.zeros(8), abs=1e-9)
    assert train.wheel_rows @ np.arange(8.0) == pytest.approx([1, 3, 5, 7])
