"""The HHT-alpha method in displacements (Neves 2016, equations 2.9 to 2.14 and 4.3 to 4.20).

    M a''(n+1) + (1 + alpha) [C a' + K a - F](n+1) - alpha [C a' + K a - F](n) = 0

with F all forces, contact included. The bracket at step n, here the *imbalance* q(n), needs no
product with K: the equation itself gives it from the accelerations,

    q(n) = (alpha q(n-1) - M a''(n)) / (1 + alpha),

a recursion that damps rounding errors by |alpha / (1 + alpha)| <= 1/2 at each step. The effective
equation then reads

    [A0 M + (1 + alpha) A1 C + (1 + alpha) K] a(n+1)
        = M m + (1 + alpha) C c + alpha q(n) + (1 + alpha) F(n+1),
    m = A0 a + A2 a' + A3 a'',   c = A1 a + A4 a' + A5 a''   (all at n).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Arrays, FloatArray, attributes_of, below, put_back, under
from solver.errors import InputError
from solver.integrators.stability import require_unconditional_stability

__all__ = ["HHT", "CoupledSystem", "HHTIntegrator", "Motion"]


class Kinematics(Protocol):
    """What the histories of a step need of the state before it."""

    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True)
class HHT:
    """Parameters and constants of the method.

    Attributes:
        alpha: In [-1/3, 0]; 0 is Newmark's method without dissipation. [1]
        time_step: [s]
        newmark_beta: beta by hand; None takes (1 - alpha)^2 / 4. [1]
        newmark_gamma: gamma by hand; None takes 1/2 - alpha. [1]

    Raises:
        InputError: alpha outside its range, time step not positive, or a beta and gamma by hand
            that are not unconditionally stable.

    References:
        Neves (2016), equations 2.11 and 4.1 to 4.2, with beta and gamma as corrected in
        Hilber, Hughes and Taylor (1977): the thesis prints them interchanged and with the wrong
        sign of alpha, which is unstable.
    """

    alpha: float
    time_step: float
    newmark_beta: float | None = None
    newmark_gamma: float | None = None

    def __post_init__(self) -> None:
        if not -1.0 / 3.0 <= self.alpha <= 0.0:
            raise InputError(
                "integration.alpha", self.alpha, "is outside [-1/3, 0]: not unconditionally stable",
                "Use -0.05, or 0 for no numerical dissipation.",
            )  # fmt: skip
        if not 0.0 < self.time_step < np.inf:
            raise InputError(
                "integration.time_step", self.time_step, "is not positive",
                "Use 2.5e-4 s for wheels on sleepers.",
            )  # fmt: skip
        if self.newmark_beta is not None or self.newmark_gamma is not None:
            require_unconditional_stability(self.alpha, self.beta, self.gamma)

    @property
    def beta(self) -> float:
        """Newmark's beta."""
        if self.newmark_beta is not None:
            return self.newmark_beta
        return (1.0 - self.alpha) ** 2 / 4.0

    @property
    def gamma(self) -> float:
        """Newmark's gamma."""
        if self.newmark_gamma is not None:
            return self.newmark_gamma
        return 0.5 - self.alpha

    @property
    def force_factor(self) -> float:
        """Weight of the new step's forces, 1 + alpha."""
        return 1.0 + self.alpha

    @property
    def a0(self) -> float:
        """A0 = 1 / (beta dt^2). [1/s2]"""
        return 1.0 / (self.beta * self.time_step**2)

    @property
    def a1(self) -> float:
        """A1 = gamma / (beta dt). [1/s]"""
        return self.gamma / (self.beta * self.time_step)

    @property
    def a2(self) -> float:
        """A2 = 1 / (beta dt). [1/s]"""
        return 1.0 / (self.beta * self.time_step)

    @property
    def a3(self) -> float:
        """A3 = 1 / (2 beta) - 1."""
        return 0.5 / self.beta - 1.0

    @property
    def a4(self) -> float:
        """A4 = gamma / beta - 1."""
        return self.gamma / self.beta - 1.0

    @property
    def a5(self) -> float:
        """A5 = dt / 2 (gamma / beta - 2). [s]"""
        return 0.5 * self.time_step * (self.gamma / self.beta - 2.0)

    def inertia_history(self, motion: Kinematics) -> FloatArray:
        """m = A0 a + A2 a' + A3 a'': the acceleration is A0 a(n+1) - m."""
        return (
            self.a0 * motion.displacement
            + self.a2 * motion.velocity
            + self.a3 * motion.acceleration
        )

    def viscous_history(self, motion: Kinematics) -> FloatArray:
        """c = A1 a + A4 a' + A5 a'': the velocity is A1 a(n+1) - c."""
        return (
            self.a1 * motion.displacement
            + self.a4 * motion.velocity
            + self.a5 * motion.acceleration
        )


@dataclass
class Motion:
    """State of one part at the last step; the integrator advances it in place.

    Attributes:
        displacement: [m, rad]
        velocity: [m/s, rad/s]
        acceleration: [m/s2, rad/s2]
        imbalance: q of the step before the last one. [N, N m]
    """

    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    imbalance: FloatArray

    @classmethod
    def at_rest(cls, displacement: FloatArray) -> Motion:
        """A static state: no velocity, no acceleration, forces in balance."""
        return cls(
            displacement=np.array(displacement),
            velocity=np.zeros_like(displacement),
            acceleration=np.zeros_like(displacement),
            imbalance=np.zeros_like(displacement),
        )


class CoupledSystem(Protocol):
    """What the integrator needs of a system with its effective matrices factorised."""

    def begin(self, part: int, motion: Motion, inertia: FloatArray, viscous: FloatArray) -> None:
        """Takes a part's histories for the step, and updates ``motion.imbalance``."""
        ...

    def couple(self, time: float) -> None:
        """Finds the forces between the parts at the end of the step.

        Raises:
            ConvergenceError: No admissible contact state.
        """
        ...

    def finish(self, part: int) -> FloatArray:
        """The part's displacement at the end of the step."""
        ...


class HHTIntegrator:
    """Advances the motions of a coupled system, one step at a time.

    Args:
        method: The method's parameters.
        system: The system, with effective matrices of the same parameters.
        motions: Initial state of each part; advanced in place.
    """

    def __init__(self, method: HHT, system: CoupledSystem, motions: Sequence[Motion]) -> None:
        self.method = method
        self.motions = tuple(motions)
        self._system = system

    def advance(self, time: float) -> None:
        """Takes one step, to ``time`` at its end. [s]

        Raises:
            ConvergenceError: No admissible contact state.
        """
        method = self.method
        histories = [
            (method.inertia_history(motion), method.viscous_history(motion))
            for motion in self.motions
        ]
        for index, (motion, terms) in enumerate(zip(self.motions, histories, strict=True)):
            self._system.begin(index, motion, *terms)
        self._system.couple(time)
        for index, (motion, terms) in enumerate(zip(self.motions, histories, strict=True)):
            inertia, viscous = terms
            new = self._system.finish(index)
            motion.displacement[:] = new
            motion.velocity[:] = method.a1 * new - viscous
            motion.acceleration[:] = method.a0 * new - inertia

    def state(self) -> Arrays:
        """Copies of the motions: ``<part>/displacement`` and so on."""
        state: Arrays = {}
        for index, motion in enumerate(self.motions):
            state |= under(str(index), attributes_of(motion))
        return state

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Takes the motions that ``state`` gave."""
        for index, motion in enumerate(self.motions):
            put_back(motion, below(str(index), state))
