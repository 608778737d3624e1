"""Natural frequencies of the span that decides: they set the cut-off of its acceleration."""

from __future__ import annotations

import numpy as np

from solver.modal import modes
from solver.models.structure_model import StructureModel

__all__ = ["member_frequencies"]

_COUNT = 12


def member_frequencies(structure: StructureModel, spans: tuple[int, ...]) -> list[float]:
    """Frequencies of the modes in which the deciding spans move most.

    Args:
        structure: Viaduct and track, pads and rails absent.
        spans: The deciding spans.

    Returns:
        The three lowest, ascending (f1, f2, f3). [Hz]

    References:
        EN 1990:2002/A1 A2.4.4.2.1(4): 30 Hz, 1.5 f1 and f3 of the member.
    """
    frequencies, shapes = modes(structure.stiffness, structure.mass, _COUNT)
    rows = structure.displacement_operator[3 * structure.slab_nodes + 2]
    motion = np.asarray(rows @ shapes) ** 2
    own = np.isin(structure.span_of_slab_node, spans)
    share = motion[own].sum(axis=0) / np.maximum(motion.sum(axis=0), np.finfo(float).tiny)
    chosen = np.flatnonzero(share > 0.5)
    if chosen.size < 3:
        chosen = np.argsort(-share)[:3]
    return [float(value) for value in np.sort(frequencies[chosen])[:3]]
