"""Lowest natural frequencies of a subsystem on its supports."""

from __future__ import annotations

import numpy as np

from solver.arrays import Vector
from solver.modal import modes
from solver.models.subsystem import Subsystem

__all__ = ["first_frequencies"]


def first_frequencies(subsystem: Subsystem, count: int) -> Vector:
    """Undamped natural frequencies, ascending, shape (count,). [Hz]"""
    free = np.setdiff1d(np.arange(subsystem.n_dof), subsystem.prescribed)
    stiffness, mass = subsystem.stiffness[free][:, free], subsystem.mass[free][:, free]
    return modes(stiffness, mass, count)[0]
