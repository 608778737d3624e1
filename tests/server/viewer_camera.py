"""A page of the viewer that obeys its camera, and tells where it is; for tests of poses."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import zstandard

from tests.server.viewer_client import SceneClient
from tests.server.viewer_waiting import http
from tests.server.viewer_waiting import until as until_received

__all__ = ["OVERVIEW", "Page", "View"]

OVERVIEW = float(np.radians(34.0))
"""Field of view of the preset with which a view opens. [rad]"""


class Page(SceneClient):
    """A page that goes where its camera is sent, and tells where it is as viser's page does.

    Attributes:
        camera: As last sent: position, look_at, fov, near.
        opening: Where it begins by itself.
        sent: How many words about the camera came.
    """

    def __init__(self, address: str, session: str) -> None:
        super().__init__(address, session)
        self.camera: dict[str, Any] = {}
        self.opening: dict[str, Any] = {}
        self.sent = 0

    def __enter__(self) -> Page:
        return self

    def _take(self, packet: bytes) -> None:
        super()._take(packet)
        plain, packed = (int.from_bytes(packet[i : i + 8], "little") for i in (0, 8))
        inner = zstandard.ZstdDecompressor().decompress(packet[16 : 16 + packed], plain)
        for message in msgspec.msgpack.decode(inner)["messages"]:
            kind = message["type"]
            if kind.startswith("SetCamera"):
                (name,) = (key for key in message if key not in ("type", "initial"))
                word = kind.removeprefix("SetCamera").removesuffix("Message").lower()
                (self.opening if message["initial"] else self.camera)[word] = message[name]
                self.sent += not message["initial"]

    def look(self, eye: tuple[float, ...], target: tuple[float, ...]) -> None:
        """Places the camera; it sees as widely as it was last told to."""
        self._send(
            "ViewerCameraMessage",
            wxyz=(1.0, 0.0, 0.0, 0.0),
            position=eye,
            fov=self.camera.get("fov", OVERVIEW),
            near=self.camera.get("near", 0.3),
            far=self.camera.get("far", 1000.0),
            image_height=500,
            image_width=900,
            look_at=target,
            up_direction=(0.0, 0.0, 1.0),
        )

    def tell(self) -> None:
        """Says where the camera is, as the page does after every movement."""
        self.look(tuple(self.camera["position"]), tuple(self.camera["lookat"]))

    def come(self) -> None:
        """Opens as a page does: begins somewhere, is sent to its place, says that it is there."""
        until_received(self, lambda: self._knows(self.opening), "where it begins")
        self.settle()
        self.begin()
        until_received(self, lambda: self._knows(self.camera), "its place")
        self.settle()
        self.tell()

    def begin(self) -> None:
        """Says that it is where it begins."""
        self.look(tuple(self.opening["position"]), tuple(self.opening["lookat"]))

    def forget(self) -> None:
        """Lets go of where the camera was sent, so that it shows when it is sent there again."""
        self.camera["position"] = self.camera["lookat"] = None

    def until_sent(self, before: int) -> None:
        """Waits until more words about the camera came than before, and all that come with them."""
        until_received(self, lambda: self.sent > before, "a word about the camera")
        self.settle()

    def is_at(self, pose: dict[str, list[float]]) -> None:
        """Waits until the camera was sent there."""

        def there() -> bool:
            if not self._knows(self.camera):
                return False
            # viser sends no movement below 1e-5 of a coordinate
            return np.allclose(
                [self.camera["position"], self.camera["lookat"]],
                [pose["position"], pose["look_at"]],
                atol=2e-3,
                rtol=0.0,
            )

        until_received(self, there, f"the camera at {pose}")

    @staticmethod
    def _knows(place: dict[str, Any]) -> bool:
        return place.get("position") is not None and place.get("lookat") is not None


class View:
    """One session over HTTP."""

    def __init__(self, address: str, run: str = "beam") -> None:
        self.address = address
        opened = http.post(f"http://{address}/api/v1/runs/{run}/viewer").json()
        self.session = opened["session"]
        self.resource = f"http://{address}/api/v1/viewer/{self.session}"

    def put(self, **change: object) -> dict[str, Any]:
        answer = http.put(self.resource, json=change)
        assert answer.status_code == 200, answer.text
        return answer.json()

    @property
    def pose(self) -> dict[str, Any] | None:
        return http.get(self.resource).json()["pose"]

    def page(self) -> Page:
        """A page that has opened."""
        page = Page(self.address, self.session)
        page.come()
        return page
