"""The surface that moves: fewer vertices, the same shape; and squares in place of elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from server.viewer.decimation import lightened, snapped
from server.viewer.rail_profile import SECTION_POINTS, with_rail_section
from server.viewer.scene_elements import element_poses
from server.viewer.scenery import piers, rigid_rails
from server.viewer.surface import surface_of
from solver.results import Geometry, Layer, WheelGeometry
from tests.server.viewer_run import ExampleRun

NO_WHEELS = WheelGeometry(
    names=(), offsets=np.zeros(0), lateral=np.zeros(0), contact_height=0.0, radius=0.46
)


class Sheets:
    """Level sheets and boxes of quadrilaterals."""

    def __init__(self) -> None:
        self.vertices = np.empty((0, 3))
        self.layers: list[Layer] = []

    def sheet(self, name: str, x: np.ndarray, y: np.ndarray, z: float) -> None:
        """One sheet as a layer."""
        grid = np.stack(np.meshgrid(x, y, [z], indexing="ij"), axis=-1).reshape(-1, 3)
        at = np.arange(len(grid)).reshape(len(x), len(y)) + len(self.vertices)
        corners = (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:])
        self._add(name, grid, np.stack(corners, axis=2).reshape(-1, 4))

    def box(self, name: str, low: tuple[float, ...], high: tuple[float, ...], n: int) -> None:
        """Four sides of a box, n elements long across the track."""
        y = np.linspace(low[1], high[1], n + 1)
        ring = [(low[0], low[2]), (high[0], low[2]), (high[0], high[2]), (low[0], high[2])]
        grid = np.array([(x, at, z) for at in y for x, z in ring])
        row = np.arange(n)[:, None] * 4
        one, other = np.arange(4), np.roll(np.arange(4), -1)
        faces = np.stack((row + one, row + other, row + 4 + other, row + 4 + one), axis=2)
        self._add(name, grid, faces.reshape(-1, 4) + len(self.vertices))

    def _add(self, name: str, grid: np.ndarray, faces: np.ndarray) -> None:
        self.vertices = np.concatenate((self.vertices, grid))
        before = [layer.faces for layer in self.layers if layer.name == name]
        self.layers = [layer for layer in self.layers if layer.name != name]
        self.layers.append(Layer(name=name, faces=np.concatenate([*before, faces])))

    @property
    def geometry(self) -> Geometry:
        """All of it."""
        return Geometry(
            vertices=self.vertices,
            layers=tuple(self.layers),
            wheels=NO_WHEELS,
            bodies=(),
            spans=np.array([[0.0, 30.0]]),
        )


def count(layers: tuple[Layer, ...]) -> dict[str, int]:
    """Vertices drawn, by layer."""
    return {layer.name: len(np.unique(layer.faces)) for layer in layers}


def area(faces: np.ndarray, vertices: np.ndarray) -> float:
    """Of quadrilaterals. [m2]"""
    a, b, c, d = (vertices[faces[:, i]] for i in range(4))
    halves = np.cross(b - a, c - a), np.cross(c - a, d - a)
    return float(sum(np.linalg.norm(half, axis=1).sum() for half in halves) / 2.0)


def bridge(across: int) -> Geometry:
    """A slab, ballast and sleepers, as fine as asked."""
    sheets = Sheets()
    x = np.linspace(0.0, 30.0, 301)
    sheets.sheet("slab", x, np.linspace(-3.6, 3.6, across), 1.335)
    sheets.sheet("ballast", x, np.linspace(-2.1, 2.1, 41), 1.8)
    for at in np.arange(0.3, 30.0, 0.6):
        sheets.box("sleepers", (at - 0.13, -1.3, 1.8), (at + 0.13, 1.3, 2.0), 20)
    return sheets.geometry


def test_a_small_surface_stays_whole() -> None:
    geometry = bridge(9)
    assert lightened(geometry, {}, np.empty((0, 3)), 100_000) == geometry.layers


def test_the_track_gives_way_first_and_the_bridge_stays_whole() -> None:
    geometry = bridge(33)
    assert sum(count(geometry.layers).values()) > 20_000
    light = lightened(geometry, {}, np.empty((0, 3)))
    assert sum(count(light).values()) <= 20_000
    assert light[0].faces is geometry.layers[0].faces, "the slab is what is judged"
    for before, after in zip(geometry.layers[:2], light[:2], strict=True):
        assert area(after.faces, geometry.vertices) == pytest.approx(
            area(before.faces, geometry.vertices)
        )
    assert count(light)["sleepers"] == 8 * 50, "boxes"


def test_a_very_fine_bridge_keeps_its_edges_and_the_point_of_its_peak() -> None:
    geometry = bridge(101)
    far = np.linalg.norm(geometry.vertices - (14.3, 0.36, 1.3), axis=1)
    peak = geometry.vertices[np.argmin(far)]
    light = lightened(geometry, {"ballast": 2}, peak[None, :])
    assert sum(count(light).values()) <= 20_000
    slab = geometry.vertices[np.unique(light[0].faces)]
    assert np.min(np.linalg.norm(slab - peak, axis=1)) == 0.0
    assert slab[:, :2].min(axis=0).tolist() == [0.0, -3.6]
    assert slab[:, :2].max(axis=0).tolist() == [30.0, 3.6]
    assert area(light[0].faces, geometry.vertices) == pytest.approx(30.0 * 7.2)


def test_two_spans_that_touch_stay_two() -> None:
    sheets = Sheets()
    for begin, end in ((0.0, 10.0), (10.0, 20.0)):
        sheets.sheet("slab", np.linspace(begin, end, 21), np.linspace(-1.0, 1.0, 5), 0.0)
    (layer,) = sheets.layers
    faces = snapped(layer.faces, sheets.vertices, 3.0, np.empty((0, 3)))
    sides = sheets.vertices[faces][:, :, 0]
    assert np.all((sides.max(axis=1) <= 10.0) | (sides.min(axis=1) >= 10.0))
    joint = np.unique(faces[sheets.vertices[faces][:, :, 0] == 10.0])
    assert len(joint) == 2 * len(np.unique(sheets.vertices[joint, 1])), "each span has its own end"


def test_a_drawn_rail_has_as_many_vertices_as_the_budget_counts() -> None:
    sheets = Sheets()
    sheets.sheet("rails", np.linspace(0.0, 3.0, 11), np.array([0.68, 0.75]), 2.1)
    ribbon = surface_of(sheets.layers[0])
    drawn = with_rail_section(ribbon, sheets.vertices)
    assert len(drawn.vertices) == SECTION_POINTS * len(ribbon.vertices)


def test_a_square_covers_its_element() -> None:
    """Turned by its quaternion, the stretched unit square has the element's corners."""
    generator = np.random.default_rng(5)
    axes = np.linalg.qr(generator.normal(size=(20, 3, 3)))[0]
    axes[:, :, 2] = np.cross(axes[:, :, 0], axes[:, :, 1])
    size = generator.uniform(0.1, 2.0, size=(20, 2))
    unit = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    flat = np.concatenate((unit[None] * size[:, None], np.zeros((20, 4, 1))), axis=2)
    middle = generator.normal(size=(20, 3))
    corners = np.einsum("nij,nkj->nki", axes, flat) + middle[:, None]
    centres, turned, sizes = element_poses(corners)
    np.testing.assert_allclose(centres, middle, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1.0, atol=1e-12)
    square = np.column_stack((unit, np.zeros(4)))
    for index in range(20):
        drawn = (square * sizes[index]) @ _rotation(turned[index]).T + centres[index]
        np.testing.assert_allclose(drawn, corners[index], atol=1e-12)


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_piers_and_rigid_rails_stand_beside_what_is_modelled() -> None:
    """The live view and the stills ask the same: neither may fail on a surface off the spans."""
    geometry = ExampleRun().plan.geometry
    centres, sizes = piers(geometry)
    assert centres[:, 0].tolist() == [0.0, 16.5, 37.5, 58.5]
    beside = replace(geometry, spans=geometry.spans + 1000.0)
    assert np.isfinite(piers(beside)[0]).all()
    top = centres[:, 2] + sizes[:, 2] / 2.0
    on_spans = geometry.vertices[geometry.vertices[:, 0] >= 0.0]
    assert np.all(top < on_spans[:, 2].min())
    ends = rigid_rails(geometry, 0.0)
    assert ends.shape == (4, 2, 3)
    low, high = geometry.vertices[:, 0].min(), geometry.vertices[:, 0].max()
    assert not np.any((ends[:, :, 0] > low) & (ends[:, :, 0] < high))
    assert ends[:, :, 0].min() < low + geometry.wheels.offsets.min()
