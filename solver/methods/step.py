"""One step's equations without contact: histories, loads, and what follows from a displacement.

With q = C a' + R(a) - F, the imbalance without inertia (contact forces in F), equation 4.3 reads

    M a''(n+1) + (1 + alpha) q(n+1) - alpha q(n) = 0,

which gives q(n+1) from the accelerations without a product with K; over P the same recursion,
reactions in F, is equation 4.13.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Vector
from solver.integrators.hht import HHT
from solver.methods.settings import StepState
from solver.methods.stacked import Stacked

__all__ = ["StepEquations", "begin_step", "imbalance_after", "motion_after", "reactions_after"]


@dataclass(frozen=True, kw_only=True)
class StepEquations:
    """What is known of a step before its contact forces.

    Attributes:
        method: The method, with this step's length.
        time: At the end of the step. [s]
        load: Right-hand side of the effective equation over F, contact excluded (4.19). [N]
        external: External force on F at the end of the step. [N]
        supports: Displacement and velocity of P at the end of the step, acceleration at
            t + alpha dt.
        inertia: m of all freedoms: a'' = A0 a - m.
        viscous: c of all freedoms: a' = A1 a - c.
    """

    method: HHT
    time: float
    load: Vector
    external: Vector
    supports: tuple[Vector, Vector, Vector]
    inertia: Vector
    viscous: Vector


def begin_step(stacked: Stacked, method: HHT, state: StepState, time: float) -> StepEquations:
    """Histories and loads of a step that ends at ``time`` (4.14, 4.19)."""
    inertia, viscous = method.inertia_history(state), method.viscous_history(state)
    free, new = stacked.free, method.force_factor
    external, _ = stacked.load(time)
    load = stacked.mass_ff @ inertia[free] + method.alpha * state.imbalance + new * external
    if stacked.damping_ff.nnz:
        load += new * (stacked.damping_ff @ viscous[free])
    supports = _supports(stacked, method, state.time, time)
    if stacked.supports_move:
        load -= stacked.mass_fp @ supports[2]
        load -= new * (stacked.damping_fp @ supports[1] + stacked.stiffness_fp @ supports[0])
    return StepEquations(
        method=method, time=time, load=load, external=external, supports=supports,
        inertia=inertia, viscous=viscous,
    )  # fmt: skip


def _supports(
    stacked: Stacked, method: HHT, before: float, time: float
) -> tuple[Vector, Vector, Vector]:
    """Motion of P at the end of a step, its acceleration at t + alpha dt.

    The accelerations that the method finds over F belong to t + alpha dt. Equation 4.14 takes
    those of P at the end of the step, which makes it of order one wherever mass couples F to P;
    weighted like the forces, they are of the same time and the method keeps its order two.
    """
    displacement, velocity, acceleration = stacked.support_motion(time)
    if stacked.supports_move and method.alpha:
        last = stacked.support_motion(before)[2]
        acceleration = method.force_factor * acceleration - method.alpha * last
    return displacement, velocity, acceleration


def motion_after(
    stacked: Stacked, step: StepEquations, displacement: Vector
) -> tuple[Vector, Vector, Vector]:
    """Displacement, velocity, acceleration of all freedoms from the free displacements.

    The prescribed freedoms follow their given motion, not the recurrence.
    """
    method, supports = step.method, step.supports
    whole = stacked.whole(displacement, supports[0])
    velocity = method.a1 * whole - step.viscous
    acceleration = method.a0 * whole - step.inertia
    velocity[stacked.prescribed] = supports[1]
    acceleration[stacked.prescribed] = supports[2]
    return whole, velocity, acceleration


def imbalance_after(
    stacked: Stacked, method: HHT, state: StepState, acceleration: Vector
) -> tuple[Vector, Vector]:
    """q over F and over P at the end of a step, by the recursion."""
    free = acceleration[stacked.free]
    inertia = stacked.mass_ff @ free
    if stacked.supports_move:
        inertia = inertia + stacked.mass_fp @ acceleration[stacked.prescribed]
    inertia_p = stacked.mass_p @ acceleration
    return (
        (method.alpha * state.imbalance - inertia) / method.force_factor,
        (method.alpha * state.imbalance_prescribed - inertia_p) / method.force_factor,
    )


def reactions_after(
    stacked: Stacked, time: float, motion: tuple[Vector, Vector, Vector], contact: Vector,
    imbalance_prescribed: Vector,
) -> Vector:  # fmt: skip
    """Reactions S over P (4.13).

    Args:
        stacked: The stack.
        time: [s]
        motion: Displacement, velocity, acceleration of all freedoms.
        contact: H' X over all freedoms. [N]
        imbalance_prescribed: q over P. [N]
    """
    if stacked.prescribed.size == 0:
        return np.zeros(0)
    displacement, velocity, _ = motion
    _, external = stacked.load(time)
    internal = stacked.stiffness_p @ displacement + stacked.damping_p @ velocity
    return internal - external - contact[stacked.prescribed] - imbalance_prescribed
