"""Sprung masses over simply supported spans: the engine's run, and rows to record."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sparse

from solver.arrays import FloatArray, Vector
from solver.contact.laws import ContactLaw, RigidContact
from solver.integrators.hht import HHT
from solver.irregularities import PerfectRail, RailIrregularity
from solver.methods.problem import PrescribedSpeed, Problem
from solver.methods.vehicles import GRAVITY, sprung_masses
from solver.models.plane_beam import BeamOnSupports
from solver.verification.case import Progress
from solver.verification.recording import Recording, record

__all__ = ["Crossing", "CrossingHistories", "cross"]


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """Equal sprung masses at constant speed.

    Attributes:
        bridge: Spans between rigid ground.
        mass: [kg]
        stiffness: Of each mass's spring. [N/m]
        count: Number of masses; the first starts at chainage 0, where the spans begin.
        spacing: Distance between neighbours. [m]
        speed: [m/s]
        law: Contact law.
        unilateral: Whether contact may open.
        irregularity: Of the rail.
        damping: Of each mass's dashpot. [N s/m]
    """

    bridge: BeamOnSupports
    mass: float
    stiffness: float
    count: int
    spacing: float
    speed: float
    law: ContactLaw = field(default_factory=RigidContact)
    unilateral: bool = True
    irregularity: RailIrregularity = field(default_factory=PerfectRail)
    damping: float = 0.0

    @property
    def offsets(self) -> Vector:
        """Chainage of the masses at t = 0, shape (count,). [m]"""
        return -self.spacing * np.arange(self.count)


@dataclass(frozen=True, kw_only=True)
class CrossingHistories:
    """What the engine found, time first; displacements count from the static state.

    Attributes:
        time: Shape (n_step + 1,). [s]
        mid_span: Displacement of the middles of the spans, shape (n_step + 1, n_span). [m]
        mid_span_acceleration: Likewise. [m/s2]
        mass: Displacement of the masses, shape (n_step + 1, count). [m]
        mass_acceleration: Likewise. [m/s2]
        contact_point: Displacement of the contact points, shape (n_step + 1, count). [m]
        contact_force: Shape (n_step + 1, count). [N]
        recording: Everything else.
    """

    time: Vector
    mid_span: FloatArray
    mid_span_acceleration: FloatArray
    mass: FloatArray
    mass_acceleration: FloatArray
    contact_point: FloatArray
    contact_force: FloatArray
    recording: Recording


def cross(
    crossing: Crossing, method: HHT, n_step: int, progress: Progress, energy: bool = False
) -> CrossingHistories:
    """Runs a crossing through the direct method, from rest in static equilibrium.

    Args:
        crossing: What crosses what.
        method: Time integration.
        n_step: Steps.
        progress: Told after every step.
        energy: Whether to keep the energy account.
    """
    bridge, count = crossing.bridge, crossing.count
    vehicle = sprung_masses(
        crossing.offsets, mass=crossing.mass, stiffness=crossing.stiffness, damping=crossing.damping
    )
    problem = Problem(
        structure=bridge.structure,
        vehicle=vehicle.subsystem,
        wheels=vehicle.wheels,
        path=bridge.path,
        law=crossing.law,
        drive=PrescribedSpeed(speed=crossing.speed),
        unilateral=crossing.unilateral,
        irregularity=crossing.irregularity,
    )
    of_vehicle = sparse.vstack([vehicle.masses, vehicle.wheels.rows[2]])
    rows = sparse.csr_array(sparse.block_diag([bridge.mid_spans, of_vehicle], format="csr"))
    vertical = None
    if bridge.vertical is not None:
        vertical = np.concatenate([bridge.vertical, vehicle.vertical])
    found = record(
        problem,
        method,
        n_step,
        rows,
        vertical=vertical,
        load=crossing.mass * GRAVITY * count,
        progress=progress,
        energy=energy,
    )
    n_span = bridge.mid_spans.shape[0]
    places = (slice(n_span), slice(n_span, n_span + count), slice(n_span + count, None))
    moved = found.displacement - found.displacement[0]
    return CrossingHistories(
        time=found.time,
        mid_span=moved[:, places[0]],
        mid_span_acceleration=found.acceleration[:, places[0]],
        mass=moved[:, places[1]],
        mass_acceleration=found.acceleration[:, places[1]],
        contact_point=moved[:, places[2]],
        contact_force=found.contact_force,
        recording=found,
    )
