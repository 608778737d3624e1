"""Point mass: kinetic energy of a rigid body, weight, bad input."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.arrays import Matrix
from solver.elements import point_mass
from solver.errors import InputError

MASSES = np.array([850.0, 1200.0])
OFFSETS = np.array([[0.3, -0.2, 0.9], [0.0, 1.1, -0.4]])
_FACTORS = np.random.default_rng(4).standard_normal((2, 3, 3))
INERTIA = 300.0 * _FACTORS @ _FACTORS.transpose(0, 2, 1)
TURNS = [np.eye(3), Rotation.from_euler("xyz", [0.3, -0.7, 1.1]).as_matrix()]


@pytest.mark.parametrize("turn", TURNS)
def test_kinetic_energy_is_that_of_the_rigid_body(turn: Matrix) -> None:
    """Half m v^2 at the centre of gravity plus half omega' J omega, for any motion of the node."""
    inertia = turn @ INERTIA @ turn.T
    matrices = point_mass.mass(MASSES, inertia, OFFSETS @ turn.T)
    velocity, spin = np.array([3.0, -1.0, 2.0]), np.array([0.4, 0.9, -0.6])
    motion = np.concatenate([velocity, spin])
    for body in range(2):
        at_centre = velocity + np.cross(spin, turn @ OFFSETS[body])
        exact = 0.5 * MASSES[body] * at_centre @ at_centre + 0.5 * spin @ inertia[body] @ spin
        assert 0.5 * motion @ matrices[body] @ motion == pytest.approx(exact, rel=1e-13)


def test_matrices_turn_with_the_body_and_are_positive_definite() -> None:
    turn = TURNS[1]
    block = np.kron(np.eye(2), turn)
    matrices = point_mass.mass(MASSES, INERTIA, OFFSETS)
    turned = point_mass.mass(MASSES, turn @ INERTIA @ turn.T, OFFSETS @ turn.T)
    assert np.allclose(turned, block @ matrices @ block.T, rtol=0, atol=1e-12 * turned.max())
    assert np.array_equal(matrices, matrices.transpose(0, 2, 1))
    assert np.all(np.linalg.eigvalsh(matrices)[:, 0] > 0.0)


def test_the_parallel_axis_theorem_about_the_node() -> None:
    matrices = point_mass.mass(MASSES, INERTIA, OFFSETS)
    for body, arm in enumerate(OFFSETS):
        steiner = MASSES[body] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        assert matrices[body, 3:, 3:] == pytest.approx(INERTIA[body] + steiner)
        assert matrices[body, :3, :3] == pytest.approx(MASSES[body] * np.eye(3))


def test_weight_turns_the_node_about_which_it_hangs_off_centre() -> None:
    weight = point_mass.mass(MASSES, None, OFFSETS) @ [0.0, 0.0, -9.81, 0.0, 0.0, 0.0]
    force = np.column_stack([np.zeros((2, 2)), -9.81 * MASSES])
    assert weight[:, :3] == pytest.approx(force)
    assert weight[:, 3:] == pytest.approx(np.cross(OFFSETS, force))


def test_without_inertia_and_offset_only_displacements_have_mass() -> None:
    matrix = point_mass.mass(MASSES)[0]
    assert np.array_equal(matrix, np.diag([850.0] * 3 + [0.0] * 3))


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
def test_a_mass_that_is_negative_or_no_number_is_refused(value: float) -> None:
    with pytest.raises(InputError, match="point mass 1"):
        point_mass.mass(np.array([1.0, value]))


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        ([[1.0, 0.2, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "not symmetric"),
        ([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "negative principal inertia"),
    ],
)
def test_an_impossible_inertia_tensor_is_refused(entry: list[list[float]], reason: str) -> None:
    with pytest.raises(InputError, match=f"point mass 1 .*{reason}"):
        point_mass.mass(MASSES, np.stack([np.eye(3), np.array(entry)]))
