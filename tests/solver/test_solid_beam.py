"""Beams of eight-node solids: the thesis's counts of unknowns, statics, the path on top."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.errors import InputError
from solver.factorisation import factorise
from solver.models.solid_beam import SolidBeams, solid_beams
from solver.verification.spectrum import first_frequencies

BEAM = SolidBeams(
    spans=(20.0, 20.0),
    width=2.45,
    height=2.45,
    young_modulus=25e9,
    poisson_ratio=0.2,
    mass_per_length=30e3,
    elements=(20, 2, 4),
)


@pytest.mark.parametrize(
    ("change", "count"),
    [
        # Section 5.3.2: two spans, 16,000 elements.
        ({"elements": (80, 10, 10)}, 58_696),
        # Section 4.4.2: one span, 10,000 elements, both ends held in all directions.
        ({"spans": (25.0,), "elements": (100, 10, 10), "supports": "pinned_pinned"}, 36_597),
    ],
)
def test_unknowns_are_those_of_the_thesis(change: dict[str, object], count: int) -> None:
    structure = solid_beams(replace(BEAM, **change)).structure
    assert structure.n_dof - structure.prescribed.size == count


def test_uniform_load_bends_it_as_a_timoshenko_beam() -> None:
    bridge = solid_beams(replace(BEAM, spans=(20.0,)))
    structure, vertical = bridge.structure, bridge.vertical
    assert vertical is not None
    free = np.setdiff1d(np.arange(structure.n_dof), structure.prescribed)
    load = structure.mass @ vertical
    moved = np.zeros(structure.n_dof)
    stiffness = sparse.csr_array(structure.stiffness[free][:, free])
    moved[free] = factorise(stiffness, "the beam").solve(load[free])
    rigidity, shear = 25e9 * 2.45**4 / 12.0, 5.0 / 6.0 * 25e9 / 2.4 * 2.45**2
    wanted = 30e3 * (5.0 * 20.0**4 / (384.0 * rigidity) + 20.0**2 / (8.0 * shear))
    # The supported lines give way locally, and two elements across do not shear exactly.
    assert (bridge.mid_spans @ moved)[0] == pytest.approx(wanted, rel=0.01)
    reactions = (structure.stiffness @ moved - load)[structure.prescribed]
    assert reactions.sum() == pytest.approx(-30e3 * 20.0)


def test_first_frequency_is_the_shear_flexible_one() -> None:
    structure = solid_beams(replace(BEAM, spans=(20.0,))).structure
    # 6.07 Hz by Timoshenko's theory, 6.21 Hz without shear; sideways bending is the other one.
    frequencies = first_frequencies(structure, 2)
    assert np.abs(frequencies - 6.07).min() < 0.06


def test_translation_and_mass() -> None:
    bridge = solid_beams(BEAM)
    vertical, structure = bridge.vertical, bridge.structure
    assert vertical is not None
    largest = np.abs(structure.stiffness.data).max()
    assert np.abs(structure.stiffness @ vertical).max() < 1e-11 * largest
    assert vertical @ structure.mass @ vertical == pytest.approx(30e3 * 40.0)


@pytest.mark.parametrize("edge_rows", ["exact", "hermite"])
def test_path_runs_on_top_over_the_middle(edge_rows: str) -> None:
    bridge = solid_beams(BEAM, before=5.0, after=6.0, edge_rows=edge_rows)  # type: ignore[arg-type]
    path = bridge.path
    assert path.chainage[[0, 1, -2, -1]] == pytest.approx([-5.0, 0.0, 40.0, 46.0])
    point = path.at(np.array([7.3]))
    assert point.position[0] == pytest.approx([7.3, 0.0, 1.225])
    places = np.array([3.0, 19.99, 20.01, 33.3])
    rows = path.rows(*path.locate(places)).dense()
    # A rigid translation lifts the path by the same; the spans share no node.
    assert rows @ np.tile([0.0, 0.0, 1.0], BEAM.n_dof // 3) == pytest.approx(np.ones(4))
    half = BEAM.n_dof // 2
    assert np.all(rows[:2, half:] == 0.0)
    assert np.all(rows[2:, :half] == 0.0)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"width": 0.0}, "beam.width"),
        ({"young_modulus": -1.0}, "beam.young_modulus"),
        ({"mass_per_length": float("nan")}, "beam.mass_per_length"),
        ({"spans": ()}, "beam.spans"),
        ({"elements": (20, 3, 4)}, "beam.elements"),
        ({"elements": (20, 2, 0)}, "beam.elements"),
    ],
)
def test_bad_values_are_refused(change: dict[str, object], field: str) -> None:
    with pytest.raises(InputError, match=field):
        replace(BEAM, **change)
