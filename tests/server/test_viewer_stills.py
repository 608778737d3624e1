"""Stills without WebGL: what is drawn is where geometry says, in the colours of the bar."""

from __future__ import annotations

import io

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.errors import MEDIA_TYPE, install_errors
from server.viewer import FrameSource, Still, StillOptions, draw_still, read_still, router
from server.viewer.camera import View
from server.viewer.colour_map import SEQUENTIAL
from server.viewer.raster import Lines, Mesh, rendered, section_lines
from tests.server.viewer_client import served
from tests.server.viewer_small_runs import BeamRun, ModalRun

image = pytest.importorskip("PIL.Image")

SIZE = (400, 300)
FIELD = float(np.radians(40.0))
BLACK, WHITE = np.zeros(3), np.ones(3)
RED, BLUE = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def eye(distance: float = 10.0, near: float = 0.1) -> View:
    """Looks along +y at the origin; z is up in the picture, x to the right."""
    return View(
        position=np.array([0.0, -distance, 0.0]), target=np.zeros(3), field=FIELD, near=near
    )


def square(half: float, y: float, colour: np.ndarray) -> Mesh:
    a, b, c, d = np.array([(-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)])
    corners = np.array([[a, b, c], [a, c, d]])
    return Mesh(corners=corners, colours=np.broadcast_to(colour, corners.shape), relief=0.0)


def pixels(*meshes: Mesh, view: View | None = None, lines: tuple[Lines, ...] = ()) -> np.ndarray:
    return rendered(view or eye(), meshes, lines, BLACK, SIZE).astype(float) / 255.0


def still(source: FrameSource, options: StillOptions) -> bytes:
    """A PNG of one moment, read and drawn."""
    return draw_still(read_still(source, options))


def opened(png: bytes) -> np.ndarray:
    return np.asarray(image.open(io.BytesIO(png)).convert("RGB"), dtype=float) / 255.0


def test_a_square_is_as_large_as_perspective_says() -> None:
    """Without a hole along the edge that its two triangles share."""
    picture = pixels(square(1.0, 0.0, WHITE))
    side = SIZE[1] / (2.0 * np.tan(FIELD / 2.0)) * 2.0 / 10.0
    # Edges fall between half pixels: a quarter of a pixel along each.
    assert picture[:, :, 0].sum() == pytest.approx(side**2, abs=4 * side * 0.25)
    rows, columns = np.nonzero(picture[:, :, 0] > 0.99)
    inner = picture[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1, 0]
    assert (inner > 0.99).all()
    assert (rows.min() + rows.max()) / 2.0 == pytest.approx(SIZE[1] / 2.0 - 0.5, abs=0.5)


def test_what_is_nearer_hides_what_is_behind_in_any_order() -> None:
    near, far = square(0.5, -2.0, RED), square(1.5, 2.0, BLUE)
    one, other = pixels(near, far), pixels(far, near)
    assert np.array_equal(one, other)
    middle = one[SIZE[1] // 2, SIZE[0] // 2]
    np.testing.assert_allclose(middle, RED, atol=1e-2)
    assert (one[:, :, 2] > 0.9).any()


def test_slanting_surfaces_cross_where_their_depths_are_equal() -> None:
    """A plane y = x and the plane y = 0 meet in the middle of the picture."""
    a, b, c, d = np.array([(-1, -1, -1), (1, 1, -1), (1, 1, 1), (-1, -1, 1)], dtype=float)
    corners = np.array([[a, b, c], [a, c, d]])
    slanting = Mesh(corners=corners, colours=np.broadcast_to(RED, corners.shape), relief=0.0)
    row = pixels(slanting, square(3.0, 0.0, BLUE))[SIZE[1] // 2]
    red = np.nonzero(row[:, 0] > 0.5)[0]
    assert red.max() == pytest.approx(SIZE[0] / 2.0, abs=1.0)


def test_the_clipping_plane_cuts_triangles_through() -> None:
    """Of a strip from y = -20 to 20 only what lies behind the plane at y = 0 is left."""
    corners = np.array([[[-1.0, -20.0, -1.0], [1.0, -20.0, -1.0], [0.0, 20.0, -1.0]]])
    strip = Mesh(corners=corners, colours=np.broadcast_to(WHITE, corners.shape), relief=0.0)
    picture = pixels(strip, view=eye(near=10.0))
    row = SIZE[1] / 2.0 + SIZE[1] / (2.0 * np.tan(FIELD / 2.0)) * 1.0 / 10.0
    drawn = np.nonzero(picture[:, :, 0].max(axis=1) > 0.5)[0]
    assert drawn.max() + 0.5 == pytest.approx(row, abs=1.0)
    ends = section_lines(eye(near=10.0), corners)
    # The strip is as wide there as half way to its tip.
    np.testing.assert_allclose(np.sort(ends[0, :, 0]), [-0.5, 0.5], atol=1e-3)
    np.testing.assert_allclose(ends[0, :, 1], 0.0, atol=1e-3)


def test_lines_lie_on_surfaces_and_behind_them() -> None:
    ends = np.array([[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]])
    line = Lines(ends=ends, colour=WHITE, width=2.0)
    on = pixels(square(1.0, 0.0, RED), lines=(line,))
    behind = pixels(square(1.0, -1.0, RED), lines=(line,))
    assert on[SIZE[1] // 2, SIZE[0] // 2, 2] > 0.9
    assert behind[SIZE[1] // 2, SIZE[0] // 2, 2] < 0.1


def test_colours_of_corners_blend_over_the_triangle() -> None:
    mesh = square(1.0, 0.0, BLACK)
    colours = np.where(mesh.corners[:, :, :1] > 0, RED, BLUE)
    row = pixels(Mesh(corners=mesh.corners, colours=colours, relief=0.0))[SIZE[1] // 2]
    lit = row[row.sum(axis=1) > 0.5]
    np.testing.assert_allclose(lit[len(lit) // 2], [0.5, 0.0, 0.5], atol=0.02)
    assert (np.diff(lit[3:-3, 0]) > 0.0).all()


def test_the_deck_has_the_colours_of_the_bar() -> None:
    """At 2 Hz the greatest deflection is at an eighth of a second."""
    run = BeamRun()
    options = StillOptions(time=0.12, colour="displacement", camera="side", width=900, height=500)
    drawing = read_still(run, options)
    assert drawing.bar is not None
    picture = opened(draw_still(drawing))
    assert picture.shape == (500, 900, 3)
    top = np.array([int(SEQUENTIAL.stops[-1][i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    # The bar itself has the top colour too: look only above it. Shading takes up to a quarter.
    deck = picture[:400].reshape(-1, 3)
    brightness = deck @ top / (top @ top)
    same_hue = np.linalg.norm(deck - brightness[:, None] * top, axis=1) < 0.06
    assert (same_hue & (brightness > 0.6) & (brightness < 1.05) & (deck[:, 2] < 0.5)).sum() > 20
    flat = opened(still(run, StillOptions(time=0.0, camera="side", width=900, height=500)))
    assert not np.allclose(flat[:400], picture[:400], atol=0.2)


@pytest.mark.parametrize("part", ["viaduct", "track", "train"])
@pytest.mark.parametrize("camera", ["overview", "side", "section", "follow"])
def test_modes_can_be_drawn_from_everywhere(part: str, camera: str) -> None:
    options = StillOptions(mode=1, camera=camera, scale=0.5, width=300, height=200)  # type: ignore[arg-type]
    picture = opened(still(ModalRun(part), options))
    paper = picture[-1, -1]
    drawn = np.mean(np.abs(picture[30:] - paper).max(axis=2) > 0.05)
    assert drawn > 0.01, "something is in the picture"


def test_another_theme_is_another_paper() -> None:
    sizes = {"width": 300, "height": 200}
    light = opened(still(BeamRun(), StillOptions(theme="light", **sizes)))
    dark = opened(still(BeamRun(), StillOptions(theme="dark", **sizes)))
    assert light[-1, -1].min() > 0.95
    assert dark[-1, -1].max() < 0.15


def test_a_still_is_served_and_drawn_where_the_server_says() -> None:
    drawn: list[Still] = []
    runs: dict[str, FrameSource] = {"beam": BeamRun(), "modes": ModalRun("viaduct")}

    async def draw(drawing: Still) -> bytes:
        drawn.append(drawing)
        return draw_still(drawing)

    app = FastAPI()
    install_errors(app)
    app.include_router(router(runs.__getitem__, draw=draw))
    with served(app) as address:
        where = f"http://{address}/api/v1/runs/beam/viewer/still.png"
        answer = httpx.get(where, params={"time": 0.12, "width": 320, "height": 200}, timeout=60)
        assert answer.headers["content-type"] == "image/png"
        assert opened(answer.content).shape == (200, 320, 3)
        assert drawn[0].caption.startswith("t = 0.120 s")
        assert "108 km/h" in drawn[0].caption
        for bad, at in (
            ({"colour": "peak"}, "colour"),
            ({"colour": "red"}, "colour"),
            ({"time": "-1"}, "time"),
            ({"time": "nan"}, "time"),
            ({"width": "9000"}, "width"),
            ({"camera": "behind"}, "camera"),
            ({"mode": "1"}, "mode"),
        ):
            refused = httpx.get(where, params=bad, timeout=60)
            assert refused.status_code == 422, bad
            assert refused.headers["content-type"] == MEDIA_TYPE
            assert [error["pointer"] for error in refused.json()["errors"]] == [at]
        modes = f"http://{address}/api/v1/runs/modes/viewer/still.png"
        assert httpx.get(modes, params={"mode": 2, "width": 200}, timeout=60).status_code == 200
        assert drawn[-1].caption.startswith("mode 3 of 3: 45 Hz, bending 3")
