"""Forces, masses and sprung masses that cross simply supported spans: semi-analytical solutions.

    q_n'' + 2 zeta omega_n q_n' + omega_n^2 q_n = -sum_i phi_n(xi_i) X_i / M_n

with the contact force X_i of each load (compression positive): constant for a force; M (g + w_c'')
for a mass that follows the beam; M g + k (w_c + r - z) + c d/dt(w_c + r - z) for a sprung mass,
whose own equation is M z'' = X - M g. Upwards is positive. Nothing here is shared with the solver's
coupling, time integration or contact: it is what they are compared with.

References:
    Neves (2016), equations 4.52, 4.58, 4.59, 4.62 to 4.65, 4.67, 4.68.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from solver.errors import InputError
from solver.reference.beam import PerfectSurface, SimplySupportedBeam, Surface
from solver.reference.integration import crossing_instants, integrate, piece_edges

__all__ = ["Crossing", "Response", "moving_forces", "moving_masses", "moving_sprung_masses"]

_Array = NDArray[np.float64]
_Spans = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """Loads that cross the spans at constant speed; the beam is at rest at t = 0.

    Attributes:
        beam: The spans.
        speed: Of all loads. [m/s]
        offsets: Shape (n_load,): x of each load minus x of the first, at most 0. [m]
        times: Shape (n_step,): of the output, from 0 upwards. [s]
        points: Shape (n_point,): places of the beam's histories. [m]
        start: x of the first load at t = 0, at most 0. [m]
        surface: Irregularity of the rail.
        gravity: [m/s2]
    """

    beam: SimplySupportedBeam
    speed: float
    offsets: _Array
    times: _Array
    points: _Array
    start: float = 0.0
    surface: Surface = field(default_factory=PerfectSurface)
    gravity: float = 9.81

    def __post_init__(self) -> None:
        if not self.speed > 0:
            raise InputError(
                "crossing.speed", self.speed, "loads must move", "Use a positive speed."
            )
        if self.start > 0 or np.any(np.asarray(self.offsets) > 0):
            raise InputError(
                "crossing.start",
                self.start,
                "every load must start on the ground before the spans",
                "Use start and offsets of at most 0.",
            )

    def positions(self, time: float) -> _Array:
        """Shape (n_load,): x of every load. [m]"""
        return self.start + self.offsets + self.speed * time


@dataclass(frozen=True, kw_only=True)
class Response:
    """Histories, upwards positive, contact forces positive in compression.

    Attributes:
        time: Shape (n_step,). [s]
        displacement: Shape (n_step, n_point): of the beam. [m]
        velocity: Shape (n_step, n_point): of the beam. [m/s]
        acceleration: Shape (n_step, n_point): of the beam. [m/s2]
        load_displacement: Shape (n_step, n_load): of the masses, from their static place on a
            perfect rail; of the contact points for forces. [m]
        load_acceleration: Shape (n_step, n_load): of the masses; zero for forces. [m/s2]
        contact_force: Shape (n_step, n_load). [N]
    """

    time: _Array
    displacement: _Array
    velocity: _Array
    acceleration: _Array
    load_displacement: _Array
    load_acceleration: _Array
    contact_force: _Array


@dataclass(frozen=True, kw_only=True)
class _Instant:
    """The loads at one instant, with the spans that they are on fixed by the smooth piece."""

    beam: SimplySupportedBeam
    position: _Array
    span: _Spans

    def shapes(self, derivative: int = 0) -> _Array:
        """Shape (n_load, n_mode): modal shapes under the loads."""
        return self.beam.shapes(self.position, self.span, derivative)


@dataclass(frozen=True, kw_only=True)
class _Motion:
    """Second derivatives and forces at one instant."""

    modal_acceleration: _Array
    load_displacement: _Array
    load_acceleration: _Array
    contact_force: _Array


class _LoadLaw(Protocol):
    """What a kind of load does: its states follow the beam's q and q' in the state vector."""

    def initial(self, crossing: Crossing) -> _Array:
        """Its states at t = 0: displacements, then velocities; none for forces and masses."""
        ...

    def motion(
        self, crossing: Crossing, now: _Instant, beam: tuple[_Array, _Array], own: _Array
    ) -> _Motion:
        """Accelerations and contact forces."""
        ...


def moving_forces(crossing: Crossing, forces: _Array) -> Response:
    """Constant forces.

    Args:
        crossing: Spans, speed, places.
        forces: Shape (n_load,): downwards positive. [N]

    Returns:
        The histories.

    References:
        Neves (2016), equation 4.52.
    """
    return _solve(crossing, _Forces(forces=np.asarray(forces, dtype=np.float64)))


def moving_masses(crossing: Crossing, masses: _Array) -> Response:
    """Masses that follow beam and rail rigidly, held down where necessary.

    Args:
        crossing: Spans, speed, places.
        masses: Shape (n_load,). [kg]

    Returns:
        The histories.

    References:
        Neves (2016), equations 4.58 and 4.59.
    """
    return _solve(crossing, _Masses(masses=np.asarray(masses, dtype=np.float64)))


def moving_sprung_masses(
    crossing: Crossing,
    masses: _Array,
    stiffness: _Array,
    damping: _Array | None = None,
    *,
    unilateral: bool = False,
) -> Response:
    """Masses on springs with massless contact points.

    Args:
        crossing: Spans, speed, places, irregularity.
        masses: Shape (n_load,). [kg]
        stiffness: Shape (n_load,): of the springs. [N/m]
        damping: Shape (n_load,): of the dashpots beside them; none by default. [N s/m]
        unilateral: The rail cannot pull: contact forces are never negative.

    Returns:
        The histories.

    Raises:
        InputError: Unilateral contact with dashpots: a lifted massless point has no equation here.

    References:
        Neves (2016), equations 4.62 to 4.65, 4.67 and 4.68.
    """
    dashpots = np.zeros(len(masses)) if damping is None else np.asarray(damping, dtype=np.float64)
    if unilateral and np.any(dashpots > 0):
        raise InputError(
            "damping",
            dashpots.tolist(),
            "lifted contact points with dashpots are not part of this solution",
            "Use no damping or bilateral contact.",
        )
    law = _SprungMasses(
        masses=np.asarray(masses, dtype=np.float64),
        stiffness=np.asarray(stiffness, dtype=np.float64),
        damping=dashpots,
        unilateral=unilateral,
    )
    return _solve(crossing, law)


def _free_acceleration(beam: SimplySupportedBeam, q: _Array, rate: _Array) -> _Array:
    """Modal accelerations of the unloaded beam."""
    omega = beam.angular_frequencies
    return -(omega**2) * q - 2 * beam.damping_ratio * omega * rate


@dataclass(frozen=True, kw_only=True)
class _Forces:
    forces: _Array

    def initial(self, crossing: Crossing) -> _Array:
        return np.zeros(0)

    def motion(
        self, crossing: Crossing, now: _Instant, beam: tuple[_Array, _Array], own: _Array
    ) -> _Motion:
        shape = now.shapes()
        pull = shape.T @ self.forces / crossing.beam.modal_mass
        return _Motion(
            modal_acceleration=_free_acceleration(crossing.beam, *beam) - pull,
            load_displacement=shape @ beam[0],
            load_acceleration=np.zeros(len(self.forces)),
            contact_force=self.forces,
        )


@dataclass(frozen=True, kw_only=True)
class _Masses:
    masses: _Array

    def initial(self, crossing: Crossing) -> _Array:
        return np.zeros(0)

    def motion(
        self, crossing: Crossing, now: _Instant, beam: tuple[_Array, _Array], own: _Array
    ) -> _Motion:
        q, rate = beam
        v, shape = crossing.speed, now.shapes()
        # w_c'' = phi q'' + 2 v phi' q' + v^2 phi'' q, and v^2 r'' from the rail's surface.
        convective = (
            2 * v * now.shapes(1) @ rate
            + v**2 * now.shapes(2) @ q
            + v**2 * crossing.surface.curvature(now.position)
        )
        ratio = self.masses / crossing.beam.modal_mass
        matrix = np.eye(len(q)) + shape.T @ (ratio[:, None] * shape)
        pull = shape.T @ (ratio * (crossing.gravity + convective))
        unloaded = _free_acceleration(crossing.beam, q, rate)
        modal = np.asarray(np.linalg.solve(matrix, unloaded - pull), dtype=np.float64)
        acceleration = shape @ modal + convective
        return _Motion(
            modal_acceleration=modal,
            load_displacement=shape @ q + crossing.surface.elevation(now.position),
            load_acceleration=acceleration,
            contact_force=self.masses * (crossing.gravity + acceleration),
        )


@dataclass(frozen=True, kw_only=True)
class _SprungMasses:
    masses: _Array
    stiffness: _Array
    damping: _Array
    unilateral: bool

    def initial(self, crossing: Crossing) -> _Array:
        start = crossing.surface.elevation(crossing.positions(0.0))
        return np.concatenate([start, np.zeros(len(self.masses))])

    def motion(
        self, crossing: Crossing, now: _Instant, beam: tuple[_Array, _Array], own: _Array
    ) -> _Motion:
        q, rate = beam
        place, velocity = own[: len(own) // 2], own[len(own) // 2 :]
        v, surface, shape = crossing.speed, crossing.surface, now.shapes()
        contact = shape @ q + surface.elevation(now.position)
        force = self.masses * crossing.gravity + self.stiffness * (contact - place)
        if np.any(self.damping):
            slope = now.shapes(1) @ q + surface.slope(now.position)
            force += self.damping * (shape @ rate + v * slope - velocity)
        if self.unilateral:
            force = np.maximum(force, 0.0)
        pull = shape.T @ force / crossing.beam.modal_mass
        return _Motion(
            modal_acceleration=_free_acceleration(crossing.beam, q, rate) - pull,
            load_displacement=place,
            load_acceleration=force / self.masses - crossing.gravity,
            contact_force=force,
        )


def _solve(crossing: Crossing, law: _LoadLaw) -> Response:
    """Integrates beam and loads, then evaluates every history at the output times."""
    beam = crossing.beam
    n_mode = len(beam.angular_frequencies)

    @cache
    def span(inside_piece: float) -> _Spans:
        # Inside the smooth piece: at its ends a load is on two spans.
        return beam.span_at(crossing.positions(inside_piece))

    def motion(time: float, inside_piece: float, state: _Array) -> _Motion:
        q, rate, own = state[:n_mode], state[n_mode : 2 * n_mode], state[2 * n_mode :]
        now = _Instant(beam=beam, position=crossing.positions(time), span=span(inside_piece))
        return law.motion(crossing, now, (q, rate), own)

    def derivative(time: float, inside_piece: float, state: _Array) -> _Array:
        now = motion(time, inside_piece, state)
        own = state[2 * n_mode :]
        tail = [own[len(own) // 2 :], now.load_acceleration] if len(own) else []
        return np.concatenate([state[n_mode : 2 * n_mode], now.modal_acceleration, *tail])

    instants = crossing_instants(
        np.asarray(crossing.offsets), beam.joints, crossing.speed, crossing.start
    )
    initial = np.concatenate([np.zeros(2 * n_mode), law.initial(crossing)])
    longest = beam.length / (50 * crossing.speed)
    states = integrate(derivative, initial, crossing.times, instants, longest)
    edges = piece_edges(crossing.times, instants)
    piece = np.clip(np.searchsorted(edges, crossing.times) - 1, 0, len(edges) - 2)
    middles = 0.5 * (edges[piece] + edges[piece + 1])
    motions = [
        motion(float(time), float(middle), state)
        for time, middle, state in zip(crossing.times, middles, states, strict=True)
    ]
    shapes = beam.shapes(crossing.points, beam.span_at(crossing.points))
    return Response(
        time=crossing.times,
        displacement=states[:, :n_mode] @ shapes.T,
        velocity=states[:, n_mode : 2 * n_mode] @ shapes.T,
        acceleration=np.array([now.modal_acceleration for now in motions]) @ shapes.T,
        load_displacement=np.array([now.load_displacement for now in motions]),
        load_acceleration=np.array([now.load_acceleration for now in motions]),
        contact_force=np.array([now.contact_force for now in motions]),
    )
