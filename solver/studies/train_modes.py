"""Modes of a train that stands on rigid rails, by its contact springs."""

from __future__ import annotations

from math import pi

import numpy as np
import scipy.sparse as sparse
from scipy import linalg

from solver.arrays import Matrix, Vector
from solver.contact.laws import NonlinearHertz
from solver.modal import rayleigh_damping_ratios
from solver.models.train import GRAVITY, Body, TrainModel, build_train
from solver.results import Geometry
from solver.studies.crossing import rail_count
from solver.studies.modal_shapes import PartModes, none_of
from solver.studies.observe import body_geometry, body_rows, drawn_bodies, wheel_geometry
from solver.studies.scene import StageListener
from solver.studies.study import Contact, Study

__all__ = ["train_modes"]

_MASSLESS = 1e-13
"""Freedoms without mass give squares of periods below this share of the greatest."""


def train_modes(study: Study, report: StageListener) -> PartModes:
    """Modes of the study's train on rigid, level rails.

    The wheels stand on their contact springs: the linear law's, the tangent of Hertz's law at the
    mean static load, or none where the contact is rigid.

    Args:
        study: The study; only its train and contact law matter, and of an axle table the rails.
        report: Told each stage.

    Returns:
        The modes.

    References:
        Neves (2016), section 6.2.3.
    """
    report("building the train")
    train = build_train(study.train, rail_count(study))
    spring = _contact_stiffness(study.contact, train)
    report("finding the modes")
    frequencies, shapes = _modes(train, spring, study.modes.count)
    supported = train.stiffness + (spring or 0.0) * train.wheel_rows.T @ train.wheel_rows
    drawn = drawn_bodies(train)
    contact = "rigid contact" if spring is None else f"contact springs of {1e-6 * spring:.4g} MN/m"
    return PartModes(
        frequencies=frequencies,
        damping=rayleigh_damping_ratios(
            shapes, *(sparse.csr_array(part) for part in (train.mass, train.damping, supported))
        ),
        shapes=shapes,
        geometry=Geometry(
            vertices=np.zeros((0, 3)),
            layers=(),
            wheels=wheel_geometry(train, 0.0),
            bodies=body_geometry(drawn),
            spans=np.zeros((0, 2)),
        ),
        surface=none_of(train.n_dof),
        wheels=sparse.csr_array(train.wheel_rows),
        bodies=body_rows(drawn),
        names={k: _name(train, shapes[:, k]) for k in range(frequencies.size)},
        facts={"train": train.name, "wheels": train.n_wheel, "support": f"rigid rails, {contact}"},
    )


def _contact_stiffness(contact: Contact, train: TrainModel) -> float | None:
    """Stiffness under each wheel, None where the contact is rigid. [N/m]"""
    if contact.law == "rigid":
        return None
    if contact.law == "linear_hertz":
        return contact.stiffness
    law = NonlinearHertz(
        coefficient=contact.hertz_constant,
        reference_force=float(train.total_mass * GRAVITY / train.n_wheel),
    )
    # dF/dd of F = K_h d^1.5 at the mean static load.
    return 1.5 * law.coefficient * law.reference_compression**0.5


def _modes(train: TrainModel, spring: float | None, count: int) -> tuple[Vector, Matrix]:
    """Frequencies, ascending, and shapes of unit modal mass; massless freedoms have none."""
    rows = train.wheel_rows
    if spring is None:
        basis, stiffness = linalg.null_space(rows), train.stiffness
    else:
        basis, stiffness = np.eye(train.n_dof), train.stiffness + spring * rows.T @ rows
    mass = basis.T @ train.mass @ basis
    # The other way round: the stiffness is definite, the mass of a massless contact point is not.
    squares, shapes = linalg.eigh(mass, basis.T @ stiffness @ basis)
    order = np.argsort(-squares)[: int(np.sum(squares > _MASSLESS * squares[-1]))][:count]
    scaled = basis @ shapes[:, order] / np.sqrt(squares[order])
    return 1.0 / (2.0 * pi * np.sqrt(squares[order])), scaled


def _name(train: TrainModel, shape: Vector) -> str:
    """The kind of body that has most of the kinetic energy, and how it moves most."""
    kinds = [name.split()[0] for name in train.dof_names]
    energy = shape * (train.mass @ shape)
    share = {kind: energy[[own == kind for own in kinds]].sum() for kind in dict.fromkeys(kinds)}
    kind = max(share, key=lambda key: share[key])
    motion = np.array([_motion(body, shape) for body in train.bodies if body.name.startswith(kind)])
    names = ("bounce", "roll", "pitch")
    return f"{kind} {names[int(np.argmax(np.square(motion).sum(axis=0)))]}"


def _motion(body: Body, shape: Vector) -> Vector:
    """What bounce, roll and pitch move at the body's edges, shape (3,)."""
    return np.abs(body.rows @ shape) * (1.0, 0.5 * body.width, 0.5 * body.length)
