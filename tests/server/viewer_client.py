"""A browser's part of the viewer, for tests: an app, and a client that keeps viser's scene."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import uvicorn
import viser
import zstandard
from fastapi import FastAPI
from websockets.sync.client import ClientConnection, connect

PROTOCOL = f"viser-v{viser.__version__}"


@contextlib.contextmanager
def served(app: FastAPI) -> Iterator[str]:
    """Serves an app on a free port of this machine, and stops it as a signal would."""
    server = uvicorn.Server(
        uvicorn.Config(
            app,
            port=0,
            log_level="warning",
            ws_per_message_deflate=False,
            ws_max_size=64 * 1024 * 1024,
            timeout_graceful_shutdown=3,
        )
    )
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    try:
        yield f"127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join(timeout=60.0)
        assert not thread.is_alive()


class SceneClient:
    """Decodes what a browser would receive.

    Attributes:
        nodes: Properties of every scene node, as last sent.
        poses: Positions of the nodes that were moved as a whole.
        messages: Number of messages so far.
    """

    def __init__(self, address: str, session: str) -> None:
        self.connection: ClientConnection = connect(
            f"ws://{address}/viewer/{session}",
            subprotocols=[PROTOCOL],
            max_size=None,
            compression=None,
            proxy=None,
            open_timeout=60.0,
        )
        self.nodes: dict[str, dict[str, Any]] = {}
        self.poses: dict[str, tuple[float, float, float]] = {}
        self.messages = 0

    def __enter__(self) -> SceneClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.connection.close()

    def settle(self, quiet: float = 0.4) -> int:
        """Receives until nothing comes for a while; says how many messages came."""
        before = self.messages
        while True:
            try:
                self._take(self.connection.recv(timeout=quiet))
            except TimeoutError:
                return self.messages - before

    def look(self, eye: tuple[float, ...], target: tuple[float, ...]) -> None:
        """Places the camera; viser counts a client only from then on."""
        self._send(
            "ViewerCameraMessage",
            wxyz=(1.0, 0.0, 0.0, 0.0),
            position=eye,
            fov=0.6,
            near=0.1,
            far=1000.0,
            image_height=500,
            image_width=900,
            look_at=target,
            up_direction=(0.0, 0.0, 1.0),
        )

    def click(self, origin: tuple[float, ...], direction: tuple[float, ...]) -> None:
        """Clicks, as the page does after it has told clicks from drags."""
        self._send(
            "ScenePointerMessage",
            event_type="click",
            ray_origin=origin,
            ray_direction=direction,
            screen_pos=((0.5, 0.5),),
            modifier=None,
        )

    def _send(self, kind: str, **fields: Any) -> None:
        self.connection.send(msgspec.msgpack.encode({"type": kind, **fields}))

    def _take(self, packet: bytes) -> None:
        """Undoes viser's framing: msgpack under zstd, then arrays at multiples of eight bytes."""
        plain, packed = (int.from_bytes(packet[i : i + 8], "little") for i in (0, 8))
        inner = zstandard.ZstdDecompressor().decompress(packet[16 : 16 + packed], plain)
        content = msgspec.msgpack.decode(inner)
        arrays, at = [], 16 + packed
        for length in content["binaryBufferLengths"]:
            at += -at % 8
            arrays.append(packet[at : at + length])
            at += length
        for message in content["messages"]:
            self.messages += 1
            if "props" in message:
                self.nodes[message["name"]] = _restored(message["props"], arrays)
            elif message["type"] == "SceneNodeUpdateMessage":
                self.nodes[message["name"]].update(_restored(message["updates"], arrays))
            elif message["type"] == "SetPositionMessage":
                self.poses[message["name"]] = message["position"]


def _restored(properties: dict[str, Any], arrays: list[bytes]) -> dict[str, Any]:
    return {
        name: np.frombuffer(arrays[value["__binary_index"]], value["dtype"])
        if isinstance(value, dict) and "__binary_index" in value
        else value
        for name, value in properties.items()
    }
