"""The cameras of a session's clients: where the program puts them, and where their users move them.

Viser tells of every movement, also of those that it was asked for. What comes back as it was put is
an answer; everything else is somebody's hand.
"""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass, field, replace

import numpy as np
import viser

from server.viewer.camera import Mount, Pose, View, posed, set_initial
from solver.arrays import Vector

__all__ = ["Cameras"]

_REMEMBERED = 64
"""Placements whose answers may still be on their way: four seconds of playing."""
_RETURNS = 3
"""How often a page is sent on that goes back to where it opens."""
_UNBORN = ((0.0, 0.0, 5.0), (3.0, 3.0, 3.0))
"""Where viser's page has its camera before it knows of any other place, whichever way is up: its
renderer's, and its own. The magnitudes, in order. [m]"""
_FIELD = 1e-3
"""Fields of view that differ less are one. [rad]"""


@dataclass(frozen=True, kw_only=True)
class _Placement:
    """Where a camera was put.

    Attributes:
        position: Shape (3,). [m]
        target: Shape (3,). [m]
        origin: What the pose is told from, shape (3,). [m]
        pose: What was asked for; None for the preset's own place.
    """

    position: Vector
    target: Vector
    origin: Vector
    pose: Pose | None

    def holds(self, position: Vector, target: Vector) -> bool:
        """Whether a camera is here, but for what rounding does and what viser does not send."""
        far = float(np.abs(np.stack((self.position, self.target))).max())
        reach = 2e-3 + 1e-4 * float(np.linalg.norm(self.position - self.target)) + 2e-5 * far
        off = np.abs(np.stack((position - self.position, target - self.target))).max()
        return bool(off <= reach)


@dataclass(kw_only=True)
class _Seat:
    """One client's camera.

    Attributes:
        client: Whose.
        opening: Where its page has it by itself.
        pose: Where it belongs, told from the mount's origin; None for the preset's own place.
        due: Whether it has not been sent there yet.
        placements: Where it was sent; the last ones, in order.
        returns: How often it went back to its opening after that.
    """

    client: viser.ClientHandle
    opening: _Placement
    pose: Pose | None
    due: bool = True
    placements: deque[_Placement] = field(default_factory=lambda: deque(maxlen=_REMEMBERED))
    returns: int = 0

    def ask(self, pose: Pose | None) -> None:
        """Has it elsewhere from the next placement on; what it tells of here is of before then."""
        self.pose, self.due = pose, True
        camera, newest = self.client.camera, self.placements[-1]
        self.placements.append(
            replace(newest, position=camera.position, target=camera.look_at, pose=None)
        )

    def has_arrived(self) -> None:
        """What was on its way before the last placement has been told."""
        self.placements = deque([self.placements[-1]], maxlen=_REMEMBERED)


class Cameras:
    """Places the cameras of all clients, and knows the one that was moved last."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._lock = threading.Lock()
        self._seats: dict[int, _Seat] = {}
        self._opening: _Placement | None = None
        self._pose: Pose | None = None

    def open_at(self, first: View) -> None:
        """Where the camera of a new client is until it is welcomed."""
        self._opening = _Placement(
            position=first.position, target=first.target, origin=np.zeros(3), pose=None
        )
        set_initial(self._server, first)

    def pose(self, mount: Mount) -> Pose | None:
        """Where the camera is that was moved last; None while all are where the preset has them."""
        pose = self._pose
        return None if pose is None else pose.shifted(mount.origin)

    def ask(self, pose: Pose | None, mount: Mount) -> None:
        """Has all cameras at a pose from the next ``place`` on, or at the preset's own place.

        Args:
            pose: None for the preset's.
            mount: At the pose's time.
        """
        with self._lock:
            self._pose = None if pose is None else pose.shifted(-mount.origin)
            for seat in self._seats.values():
                seat.ask(self._pose)

    def release(self, mount: Mount) -> None:
        """Leaves every camera where it is, to stand there on its own.

        Args:
            mount: What they stood on so far.
        """
        seats = self._here()
        with self._lock:
            usual = Mount(preset="free", geometry=mount.geometry, first_axle=mount.first_axle)
            for seat in seats:
                seen = self._wanted(seat, mount)
                pose = Pose.of(seen.position, seen.target, _unusual(seen.field, usual))
                if self._pose is None or seat.pose is self._pose:
                    self._pose = pose
                seat.ask(pose)

    def welcome(self, client: viser.ClientHandle, mount: Mount) -> None:
        """Aims the camera of a new client: only now the shape of its picture is known."""
        self._here()
        if self._opening is None:
            return
        with self._lock:
            seat = _Seat(client=client, opening=self._opening, pose=self._pose)
            seat.placements.append(seat.opening)
            self._seats[client.client_id] = seat
        self._aim(seat, mount)

    def place(self, mount: Mount) -> None:
        """Puts every camera where it belongs now."""
        for seat in self._here():
            self._aim(seat, mount)

    def notice(self, client: viser.ClientHandle, mount: Mount, *, running: bool) -> None:
        """A client has told where its camera is.

        Args:
            client: Which.
            mount: What it stands on.
            running: Whether the time runs, so that what it tells is of a little before.
        """
        with self._lock:
            seat = self._seats.get(client.client_id)
            if seat is None or seat.due:
                return
            # The latest, not what this call was made for: calls may overtake each other.
            position, target = client.camera.position, client.camera.look_at
            if _is_unborn(position):
                return
            newest = seat.placements[-1]
            arrived = newest.holds(position, target)
            went_back = not arrived and seat.opening.holds(position, target)
            if arrived:
                seat.has_arrived()
                pose = newest.pose
            elif went_back or any(placed.holds(position, target) for placed in seat.placements):
                pose = seat.pose
            else:
                pose = _moved(seat, mount, running)
            if pose != seat.pose:
                seat.pose = self._pose = pose
        if went_back and seat.returns < _RETURNS:
            # A page that is slow to open takes up its first place after it was sent elsewhere.
            seat.returns += 1
            self._aim(seat, mount)

    def _here(self) -> list[_Seat]:
        """Those of clients that are connected; the others are forgotten."""
        with self._lock:
            # Looked at under the lock: one that is welcomed meanwhile must not be forgotten.
            clients = self._server.get_clients()
            self._seats = {key: seat for key, seat in self._seats.items() if key in clients}
            return list(self._seats.values())

    def _aim(self, seat: _Seat, mount: Mount) -> None:
        camera = seat.client.camera
        with self._lock:
            wanted, seat.due = self._wanted(seat, mount), False
            stays = mount.preset == "free" and seat.pose is None
            if not stays:
                seat.placements.append(
                    _Placement(
                        position=wanted.position,
                        target=wanted.target,
                        origin=mount.origin,
                        pose=seat.pose,
                    )
                )
        with seat.client.atomic():
            camera.near, camera.far = wanted.near, wanted.far
            if not stays:
                camera.fov = wanted.field
                camera.position = wanted.position
                camera.look_at = wanted.target

    @staticmethod
    def _wanted(seat: _Seat, mount: Mount) -> View:
        """The preset's view, as the shape of the client's picture asks, or the client's pose."""
        camera = seat.client.camera
        aspect = camera.image_width / max(camera.image_height, 1) or 1.0
        pose = None if seat.pose is None else seat.pose.shifted(mount.origin)
        return posed(mount.view(aspect), pose)


def _is_unborn(position: Vector) -> bool:
    """Whether a page tells of its camera before it has put it anywhere."""
    magnitudes = np.sort(np.abs(position))
    return any(np.allclose(magnitudes, place, rtol=0.0, atol=1e-4) for place in _UNBORN)


def _moved(seat: _Seat, mount: Mount, running: bool) -> Pose:
    """Where somebody moved a camera to, told from the mount's origin.

    One that rides is told from the train as it was when the camera was put there, for its word is a
    little late. While the time runs it cannot be shifted against the train, only turned.
    """
    camera, newest = seat.client.camera, seat.placements[-1]
    position, target = camera.position, camera.look_at
    told = next((p for p in reversed(seat.placements) if p.holds(p.position, target)), None)
    about = target - (told or newest).origin
    if told is None and running and mount.rides:
        about = newest.target - newest.origin
    seen = _unusual(float(camera.fov), mount)
    return Pose.of(about + position - target, about, seen)


def _unusual(seen: float, mount: Mount) -> float | None:
    """A field of view that the preset does not have by itself. [rad]"""
    return None if abs(seen - mount.view(1.0).field) < _FIELD else seen
