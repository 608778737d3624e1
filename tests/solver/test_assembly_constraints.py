"""Elimination of constraints, numbering, scatter, outer faces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array

from solver.assembly.constraints import Combination, eliminate
from solver.assembly.faces import outer_faces
from solver.assembly.freedoms import number_freedoms
from solver.assembly.scatter import ElementMatrices, scatter
from solver.elements.rigid_link import offset_rows
from solver.errors import InputError

SPRING = np.array([[1.0, -1.0], [-1.0, 1.0]])


def _follow(dependent: int, master: int, weight: float) -> Combination:
    return Combination(
        dependent=np.array([dependent]),
        masters=np.array([[master]]),
        weights=np.array([[weight]]),
    )


def test_a_lever_turns_one_spring_into_another() -> None:
    """Springs 0-1 and 2-3; 2 follows 1 at ratio 3, 3 and 0 are held: k = k1 + 9 k2."""
    springs = ElementMatrices(
        freedoms=np.array([[0, 1], [2, 3]]), matrices=np.array([2.0, 5.0])[:, None, None] * SPRING
    )
    full = scatter([springs], 4)
    transformation = eliminate(4, np.array([0, 3]), [_follow(2, 1, 3.0)])
    assert transformation.reduce(full).toarray() == pytest.approx(np.array([[2.0 + 9.0 * 5.0]]))
    assert transformation.position.tolist() == [-1, 0, -1, -1]


def test_a_freedom_may_follow_one_that_follows() -> None:
    transformation = eliminate(3, np.zeros(0, np.int64), [_follow(2, 1, 3.0), _follow(1, 0, 2.0)])
    assert transformation.matrix.toarray() == pytest.approx(np.array([[1.0], [2.0], [6.0]]))


@pytest.mark.parametrize(
    ("held", "combinations", "reason"),
    [
        ([1], [_follow(1, 0, 1.0)], "constrained twice"),
        ([], [_follow(1, 0, 1.0), _follow(1, 2, 1.0)], "constrained twice"),
        ([], [_follow(1, 2, 1.0), _follow(2, 1, 1.0)], "follows itself"),
    ],
)
def test_contradictions_are_refused(
    held: list[int], combinations: list[Combination], reason: str
) -> None:
    with pytest.raises(InputError, match=reason):
        eliminate(3, np.array(held, dtype=np.int64), combinations)


def test_only_freedoms_that_exist_are_numbered() -> None:
    freedoms = number_freedoms(np.array([6, 3]), generalised=2)
    assert freedoms.count == 11
    assert freedoms.index[1].tolist() == [6, 7, 8, -1, -1, -1]
    assert freedoms.generalised.tolist() == [9, 10]


def test_an_offset_point_moves_as_a_rigid_body_does() -> None:
    offset = np.array([[0.3, -1.2, 0.5]])
    motion, turn = np.array([0.1, 0.2, -0.4]), np.array([2e-3, -1e-3, 3e-3])
    moved = offset_rows(offset)[0] @ np.concatenate([motion, turn])
    assert moved == pytest.approx(motion + np.cross(turn, offset[0]))


def test_two_solids_show_ten_faces_outwards() -> None:
    lower = np.array([0, 1, 2, 3, 4, 5, 6, 7])
    upper = np.array([4, 5, 6, 7, 8, 9, 10, 11])
    faces, owner = outer_faces(np.vstack([lower, upper]))
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    points = np.array([[x, y, z] for z in (0, 1, 2) for x, y in square], dtype=float)
    corners = points[faces]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    outwards = corners.mean(axis=1) - [0.5, 0.5, 1.0]
    assert len(faces) == 10
    assert np.bincount(owner).tolist() == [5, 5]
    assert np.all(np.sum(normals * outwards, axis=1) > 0.0)


def test_an_empty_sum_is_an_empty_matrix() -> None:
    assert (scatter([], 3) - csr_array((3, 3))).nnz == 0
