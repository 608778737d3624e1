"""Positions of the viewer against hand computation."""

from __future__ import annotations

import numpy as np
import pytest

from server.viewer.kinematics import (
    axle_poses,
    body_poses,
    deformed,
    force_arrows,
    nearest_frame,
    pleasing_scale,
    wheel_positions,
)
from server.viewer.picture import axle_pairs
from server.viewer.rail_profile import with_rail_section
from server.viewer.shapes import axle, bogie_frame, carbody, crossed_bars, unit_box, wheel
from server.viewer.surface import feature_edges, surface_of
from solver.results import BodyGeometry, Layer, WheelGeometry

WHEELS = WheelGeometry(
    names=("wheel 01 left", "wheel 01 right"),
    offsets=np.array([0.0, 0.0]),
    lateral=np.array([0.7175, -0.7175]),
    contact_height=2.0,
    radius=0.46,
)
COACH = BodyGeometry(name="car 01", kind="carbody", offset=-9.0, size=(18.0, 2.9, 3.0), base=1.0)


def test_only_displacements_are_exaggerated() -> None:
    rest = np.array([[10.0, 1.0, 0.5]])
    assert deformed(rest, np.array([[1e-3, 0.0, -2e-3]]), 100.0) == pytest.approx(
        np.array([[10.1, 1.0, 0.3]])
    )


def test_a_wheel_stands_on_its_displaced_contact_point() -> None:
    centres = wheel_positions(WHEELS, 27.0, np.array([-1e-3, 2e-3]), 50.0)
    assert centres == pytest.approx(
        np.array([[27.0, 0.7175, 2.46 - 0.05], [27.0, -0.7175, 2.46 + 0.1]])
    )


def test_an_axle_tilts_with_its_wheels() -> None:
    centres = wheel_positions(WHEELS, 0.0, np.array([0.0, 0.01]), 10.0)
    middle, orientation, length = axle_poses(centres, axle_pairs(WHEELS.offsets))
    ends = [middle[0] + sign * length[0] / 2.0 * _rotated(orientation[0], 1) for sign in (-1, 1)]
    assert sorted(map(tuple, np.round(ends, 9))) == sorted(map(tuple, np.round(centres, 9)))


def test_a_positive_pitch_lowers_the_nose_and_a_positive_roll_lifts_the_left_side() -> None:
    """x ahead, y left, z up: a right-handed turn about y carries x towards -z, about x y to z."""
    centres, turned = body_poses((COACH,), 100.0, 2.0, np.array([[1e-3, 2e-4, 1e-4]]), 100.0)
    assert centres[0] == pytest.approx([91.0, 0.0, 2.0 + 1.0 + 1.5 + 0.1])
    assert _rotated(turned[0], 0)[2] == pytest.approx(-np.sin(0.01))
    assert _rotated(turned[0], 1)[2] == pytest.approx(np.sin(0.02) * np.cos(0.01))


def test_arrows_press_on_the_rail_with_a_length_that_is_the_force() -> None:
    centres = wheel_positions(WHEELS, 0.0, np.zeros(2), 1.0)
    arrows = force_arrows(centres, WHEELS.lateral, 0.46, np.array([85e3, 0.0]), 1.0 / 85e3)
    assert arrows[0, 1, 2] == pytest.approx(WHEELS.contact_height)
    assert arrows[0, 0, 2] - arrows[0, 1, 2] == pytest.approx(1.0)
    assert arrows[1, 0, 2] - arrows[1, 1, 2] < 0.01


@pytest.mark.parametrize(
    ("time", "expected"), [(-1.0, 0), (0.0, 0), (0.0049, 0), (0.0051, 1), (0.02, 2), (9.0, 2)]
)
def test_the_nearest_stored_frame_is_shown(time: float, expected: int) -> None:
    assert nearest_frame(time, 0.01, 3) == expected


@pytest.mark.parametrize(
    ("peak", "scale"), [(2.4e-3, 200.0), (1.0e-3, 500.0), (0.0, 1.0), (5.0, 1.0), (0.63, 1.0)]
)
def test_the_first_scale_is_a_round_number(peak: float, scale: float) -> None:
    assert pleasing_scale(peak, 0.63) == scale


def test_a_layer_sends_only_its_own_vertices() -> None:
    surface = surface_of(
        Layer(name="slab", faces=np.array([[10, 11, 21, 20], [11, 12, 21, 21]], dtype=np.int64))
    )
    assert surface.vertices.tolist() == [10, 11, 12, 20, 21]
    corners = {tuple(sorted(surface.vertices[row].tolist())) for row in surface.triangles}
    assert corners == {(10, 11, 21), (10, 20, 21), (11, 12, 21)}


def test_an_outline_has_free_edges_and_folds_but_no_mesh_lines() -> None:
    """Two plates of 4 x 2 quadrilaterals that meet at a right angle: seven straight lines."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij")
    flat = np.minimum(y, 2.0)
    vertices = np.column_stack((x.ravel(), flat.ravel(), np.maximum(y - 2.0, 0.0).ravel()))
    at = np.arange(25).reshape(5, 5)
    faces = np.stack((at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]), axis=2).reshape(-1, 4)
    segments = feature_edges(vertices, faces)
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    assert sorted(lengths.tolist()) == pytest.approx([2.0, 2.0, 2.0, 2.0, 4.0, 4.0, 4.0])


@pytest.mark.parametrize(
    "solid",
    [wheel(0.46), axle(0.08), bogie_frame(), carbody(), unit_box(), crossed_bars()],
)
def test_solids_face_outwards(solid) -> None:
    """A closed surface that faces outwards encloses a positive volume (divergence theorem)."""
    a, b, c = (solid.vertices[solid.triangles[:, i]] for i in range(3))
    assert np.sum(a * np.cross(b, c)) / 6.0 > 0.0


def _rotated(quaternion: np.ndarray, axis: int) -> np.ndarray:
    w, x, y, z = quaternion
    matrix = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return matrix[:, axis]


def test_a_ribbon_becomes_a_rail_that_hangs_below_it() -> None:
    """Two stations of one railhead: the foot is 150 mm wide and 172 mm below, and moves along."""
    y = (0.6815, 0.7535)
    rest = np.array([[0.0, y[0], 2.0], [0.3, y[0], 2.0], [0.3, y[1], 2.0], [0.0, y[1], 2.0]])
    ribbon = surface_of(Layer(name="rails", faces=np.array([[0, 1, 2, 3]])))
    rail = with_rail_section(ribbon, rest)
    moved = rest + np.array([0.0, 0.0, -0.1])
    drawn = rail.placed(moved)
    assert drawn[:4] == pytest.approx(moved)
    foot = drawn[-4:]
    assert np.ptp(foot[:, 1]) == pytest.approx(0.150)
    assert foot[:, 2] == pytest.approx(np.full(4, 1.9 - 0.172))
    # A strip on each of two sides between four rings of the section, and the top.
    assert len(rail.triangles) == 2 + 3 * 2 * 2


def test_rails_that_have_a_section_are_left_alone() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.2], [0.0, 0.0, 0.2]])
    upright = surface_of(Layer(name="rails", faces=np.array([[0, 1, 2, 3]])))
    assert with_rail_section(upright, corners) is upright
