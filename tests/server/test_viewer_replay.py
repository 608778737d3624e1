"""Replays: one self-contained file, bounded, that says what it leaves out."""

from __future__ import annotations

import base64
import re
import threading
from typing import Any

import httpx
import msgspec
import numpy as np
import pytest
import zstandard
from fastapi import FastAPI

from server.errors import install_errors
from server.viewer import FrameSource, router
from server.viewer.replay import ReplayLimits, ReplayOptions, replay
from tests.server.server_case import until
from tests.server.viewer_client import served
from tests.server.viewer_small_runs import BeamRun, ModalRun

LIMITS = ReplayLimits()


def recording(page: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """What viser's player finds in the page: messages with their times, and arrays."""
    found = re.search(rb'__VISER_EMBED_DATA__="([^"]+)"', page)
    assert found is not None
    packed = base64.b64decode(found.group(1))
    inner = zstandard.ZstdDecompressor().decompressobj().decompress(packed[8:])
    length = int.from_bytes(inner[:8], "little")
    content = msgspec.msgpack.decode(inner[8 : 8 + length])
    arrays, at = [], 8 + length
    for size in content["binaryBufferLengths"]:
        at += -at % 8
        arrays.append(inner[at : at + size])
        at += size
    return content, arrays


def decks(page: bytes) -> list[tuple[float, np.ndarray]]:
    """Times and vertices of every deck in the recording."""
    content, arrays = recording(page)
    found = []
    for time, message in content["messages"]:
        values = message.get("props") or message.get("updates") or {}
        if message.get("name") == "/deck" and "vertices" in values:
            data = values["vertices"]
            vertices = np.frombuffer(arrays[data["__binary_index"]], data["dtype"])
            found.append((time, vertices.reshape(-1, 3)))
    return found


def test_every_stored_shape_is_in_it_in_its_turn() -> None:
    run = BeamRun()
    made = replay(run, ReplayOptions(start=0.2, stop=0.3, scale=100.0), LIMITS)
    shown = {round(time * LIMITS.rate): vertices for time, vertices in decks(made.page)}
    assert sorted(shown) == list(range(11))
    for turn, vertices in shown.items():
        stored = run.plan.geometry.vertices + 100.0 * run.frame(20 + turn).displacement
        # float32 on the wire: half a unit in the last place of 20 m.
        np.testing.assert_allclose(vertices, stored, atol=1e-6)
    content, _ = recording(made.page)
    assert content["durationSeconds"] == pytest.approx(11 / LIMITS.rate)
    assert "left out" not in made.caption
    assert "t = 0.200 to 0.300 s at 0.15 × real time" in made.caption
    assert "deformation × 100" in made.caption


def test_too_many_shapes_are_thinned_out_and_the_file_says_so() -> None:
    run = BeamRun()
    made = replay(run, ReplayOptions(), ReplayLimits(pictures=40))
    assert recording(made.page)[0]["durationSeconds"] == pytest.approx(34 / LIMITS.rate)
    assert "every 3rd stored shape: 34 of 101, 67 left out" in made.caption
    assert made.caption.encode() in made.page
    few = replay(run, ReplayOptions(), ReplayLimits(data=10_000))
    assert len(decks(few.page)) < 10
    assert "left out" in few.caption


def test_an_unfinished_run_is_named_so() -> None:
    run = BeamRun()
    run.done = False
    assert "not finished" in replay(run, ReplayOptions(stop=0.05), LIMITS).caption
    run.done, run.committed_frames = True, 20  # it failed: no more will come
    assert "not finished" in replay(run, ReplayOptions(stop=0.05), LIMITS).caption


def test_a_mode_swings_once_around() -> None:
    made = replay(ModalRun("viaduct"), ReplayOptions(mode=1, scale=0.5), LIMITS)
    heights = [vertices[:, 2].max() - 1.0 for _, vertices in decks(made.page)]
    assert made.caption.startswith("mode 2 of 3")
    assert heights[0] == pytest.approx(0.5, abs=1e-6)
    # The shape of a whole wave is its own mirror image: both halves of the cycle look alike.
    middle = len(heights) // 2
    np.testing.assert_allclose(heights[:middle], heights[middle:], atol=1e-6)


def test_the_page_asks_nobody_for_anything() -> None:
    """No element loads from elsewhere; in a browser ``tests/browser`` proves it."""
    page = replay(BeamRun(), ReplayOptions(stop=0.02, colour="displacement"), LIMITS).page
    outside = re.sub(rb"<script[^>]*>.*?</script>", b"", page, flags=re.DOTALL)
    assert not re.search(rb'(src|href)\s*=\s*"(https?:)?//', outside)
    assert b"linear-gradient(to right, #" in outside
    assert b"displacement [mm]" in outside
    assert b"trainbridgeColours" in page


def test_the_server_that_recorded_is_gone() -> None:
    before = threading.active_count()
    replay(BeamRun(), ReplayOptions(stop=0.02), LIMITS)
    # zarr or pools may keep one
    until(threading.active_count, lambda count: count <= before + 1)


def test_a_replay_is_served_as_an_attachment() -> None:
    runs: dict[str, FrameSource] = {"beam": BeamRun()}
    app = FastAPI()
    install_errors(app)
    app.include_router(router(runs.__getitem__))
    with served(app) as address:
        where = f"http://{address}/api/v1/runs/beam/viewer/replay.html"
        answer = httpx.get(where, params={"from": 0.2, "to": 0.3}, timeout=120)
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("text/html")
        disposition = answer.headers["content-disposition"]
        assert disposition == 'attachment; filename="replay-beam.html"'
        assert len(decks(answer.content)) == 11
        refused = httpx.get(where, params={"colour": "peak"}, timeout=60)
        assert [error["pointer"] for error in refused.json()["errors"]] == ["colour"]
        assert httpx.get(where, params={"from": "x"}, timeout=60).status_code == 422


def test_only_so_many_replays_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    go, made = threading.Event(), replay

    def slow(*arguments: Any) -> Any:
        go.wait(120)
        return made(*arguments)

    monkeypatch.setattr("server.viewer.exports.replay", slow)
    app = FastAPI()
    install_errors(app)
    app.include_router(router(lambda run: BeamRun()))
    codes: list[int] = []

    def ask(where: str) -> None:
        codes.append(httpx.get(where, timeout=240).status_code)
        if codes[-1] == 503:
            go.set()

    with served(app) as address:
        where = f"http://{address}/api/v1/runs/beam/viewer/replay.html"
        askers = [threading.Thread(target=ask, args=(where,)) for _ in range(6)]
        for asker in askers:
            asker.start()
        for asker in askers:
            asker.join(240)
    # One is made, four wait, the sixth is told at once to come again.
    assert sorted(codes) == [200] * 5 + [503]
