"""Sprung masses on Hertz springs over simply supported spans, by modes and DOP853.

A mass on a linear spring k_v over a massless contact point with Hertz's spring below it: both
carry the contact force X, and their compressions add up,

    X / k_v + (X / K_h)^(2/3) = c_0 + w + r - z,        X = 0 where the right-hand side is negative,

c_0 the static compression, w the beam's deflection under the wheel, z the mass's displacement from
its static place. Nothing here is shared with the engine; the modal equations are those of
``solver.reference`` (4.62 to 4.68), which has no spring of this kind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.reference import SimplySupportedBeam
from solver.reference.integration import crossing_instants, integrate

__all__ = ["SeriesSpring", "SpringResponse", "moving_masses_on_hertz_springs"]

_Array = NDArray[np.float64]
_MOST_ITERATIONS = 60
_GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True)
class SeriesSpring:
    """A linear spring and a Hertz spring in series.

    Attributes:
        stiffness: k_v. [N/m]
        coefficient: K_h. [N/m^1.5]
    """

    stiffness: float
    coefficient: float

    def compression(self, force: _Array) -> _Array:
        """Of both springs together under a force. [m]"""
        return force / self.stiffness + (force / self.coefficient) ** (2.0 / 3.0)

    def force(self, compression: _Array) -> _Array:
        """Contact force, 0 without compression; Newton's method on the cube root of X. [N]"""
        wanted = np.maximum(compression, 0.0)
        soft = self.coefficient ** (-2.0 / 3.0)
        # From above the function is convex, so the iteration falls onto the root.
        root = np.minimum(np.cbrt(wanted * self.stiffness), np.sqrt(wanted / soft))
        root = np.where(wanted > 0.0, root, 1.0)
        for _ in range(_MOST_ITERATIONS):
            excess = root**3 / self.stiffness + soft * root**2 - wanted
            change = excess / (3.0 * root**2 / self.stiffness + 2.0 * soft * root)
            root = root - change
            if np.all(np.abs(change) <= 1e-14 * np.abs(root) + 1e-14):
                break
        return np.where(wanted > 0.0, root**3, 0.0)


@dataclass(frozen=True, kw_only=True)
class SpringResponse:
    """Histories, time first.

    Attributes:
        time: Shape (n_step,). [s]
        displacement: Of the point asked for, shape (n_step,). [m]
        mass_displacement: Shape (n_step, n_mass). [m]
        contact_force: Shape (n_step, n_mass). [N]
    """

    time: _Array
    displacement: _Array
    mass_displacement: _Array
    contact_force: _Array


def moving_masses_on_hertz_springs(
    beam: SimplySupportedBeam,
    spring: SeriesSpring,
    *,
    mass: float,
    offsets: _Array,
    speed: float,
    times: _Array,
    point: float,
) -> SpringResponse:
    """Equal masses that start where ``offsets`` say and cross at constant speed.

    Args:
        beam: The spans.
        spring: Under every mass.
        mass: [kg]
        offsets: x of each mass at t = 0, shape (n_mass,). [m]
        speed: [m/s]
        times: Of the output, from 0 upwards, shape (n_step,). [s]
        point: Place of the beam's history. [m]
    """
    n_mode, n_mass = len(beam.angular_frequencies), len(offsets)
    static = float(spring.compression(np.array([mass * _GRAVITY]))[0])

    def forces(time: float, inside: float, state: _Array) -> tuple[_Array, _Array]:
        shapes = beam.shapes(offsets + speed * time, beam.span_at(offsets + speed * inside))
        place = state[2 * n_mode : 2 * n_mode + n_mass]
        return spring.force(static + shapes @ state[:n_mode] - place), shapes

    def rate(time: float, inside: float, state: _Array) -> _Array:
        force, shapes = forces(time, inside, state)
        modal = -(beam.angular_frequencies**2) * state[:n_mode] - shapes.T @ force / beam.modal_mass
        return np.concatenate(
            [state[n_mode : 2 * n_mode], modal, state[2 * n_mode + n_mass :],
             force / mass - _GRAVITY]
        )  # fmt: skip

    instants = crossing_instants(offsets, beam.joints, speed, 0.0)
    initial = np.zeros(2 * (n_mode + n_mass))
    states = integrate(rate, initial, times, instants, beam.length / (50.0 * speed))
    found = [forces(float(t), float(t), state)[0] for t, state in zip(times, states, strict=True)]
    shape = beam.shapes(np.array([point]), beam.span_at(np.array([point])))[0]
    return SpringResponse(
        time=times,
        displacement=states[:, :n_mode] @ shape,
        mass_displacement=states[:, 2 * n_mode : 2 * n_mode + n_mass],
        contact_force=np.array(found),
    )
