"""Modes, their likeness, identification and damping, on structures with closed forms."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from solver.errors import InputError
from solver.factorisation import factorise
from solver.modal import (
    DeckPoints,
    assurance,
    deck_points,
    global_shapes,
    identify,
    modes,
    rayleigh_damping_ratios,
)
from solver.models.ballasted_track import TrackProperties
from solver.models.structure import build_structure, build_track
from solver.models.viaduct import ViaductProperties


def _chain(count: int) -> tuple[csr_array, csr_array]:
    """Unit masses joined by unit springs, both ends held; the last freedom has no mass."""
    stiffness = diags_array(
        [2.0 * np.ones(count), -np.ones(count - 1), -np.ones(count - 1)], offsets=[0, 1, -1]
    ).tolil()
    stiffness.resize((count + 1, count + 1))
    stiffness[count, count] = 1.0
    mass = diags_array(np.concatenate([np.ones(count), [0.0]]))
    return csr_array(stiffness), csr_array(mass)


def test_a_chain_of_masses_has_its_frequencies_though_one_freedom_has_no_mass() -> None:
    count = 30
    stiffness, mass = _chain(count)
    frequencies, shapes = modes(stiffness, mass, 5)
    exact = 2.0 * np.sin(np.arange(1, 6) * pi / (2 * (count + 1))) / (2.0 * pi)
    assert frequencies == pytest.approx(exact, rel=1e-9)
    sines = np.sin(np.outer(np.arange(1, count + 1), np.arange(1, 6)) * pi / (count + 1))
    assert assurance(shapes[:count], sines) == pytest.approx(np.eye(5), abs=1e-9)
    assert shapes.T @ (mass @ shapes) == pytest.approx(np.eye(5), abs=1e-9)


def test_a_free_chain_is_found_with_a_negative_shift() -> None:
    stiffness, mass = _chain(30)
    free = stiffness.tolil()
    free[0, 0] = free[29, 29] = 1.0
    frequencies, _ = modes(csr_array(free), mass, 2, shift=-1e-3)
    assert frequencies[0] == pytest.approx(0.0, abs=1e-6)
    assert frequencies[1] == pytest.approx(2.0 * np.sin(pi / 60.0) / (2.0 * pi), rel=1e-9)
    with pytest.raises(InputError, match="positive"):
        modes(stiffness, mass, 2, shift=1.0)


def test_rayleigh_damping_gives_its_two_chosen_ratios() -> None:
    """a0 / (2 omega) + a1 omega / 2 = 3 percent at 90 and 160 Hz for the track (Neves, 6.3.5)."""
    omega = 2.0 * pi * np.array([90.0, 160.0])
    mass, stiffness = csr_array(np.eye(2)), csr_array(np.diag(omega**2))
    damping = 21.7 * mass + 3.82e-5 * stiffness
    ratios = rayleigh_damping_ratios(np.eye(2), mass, damping, stiffness)
    assert ratios == pytest.approx([0.03, 0.03], rel=5e-3)


def test_equal_spans_that_share_their_modes_are_told_apart() -> None:
    """Two coupled spans move 0.8 : 0.6 and 0.6 : -0.8; a twist lies between, lower than a third."""
    share = np.tile(np.linspace(0.0, 1.0, 5), 4)
    span = np.repeat([0, 0, 1, 1], 5)
    side = np.tile(np.repeat([1.0, -1.0], 5), 2)
    points = DeckPoints(nodes=np.arange(20), span=span, share=share, side=side)
    sine = np.sin(pi * share)
    columns = [
        sine * np.where(span == 0, 0.6, -0.8),
        sine * np.where(span == 0, 0.8, 0.6),
        sine * side * np.where(span == 0, 0.7, 0.3),
        sine * side * (span == 0),
        sine * side * (span == 1),
    ]
    operator = np.zeros((60, 20))
    operator[np.arange(20) * 3 + 2, np.arange(20)] = 1.0
    targets = [shape for shape in global_shapes(2) if shape.waves == 1]
    chosen, likeness = identify(np.column_stack(columns), csr_array(operator), points, targets)
    names = dict(zip([target.name for target in targets], chosen.tolist(), strict=True))
    assert names == {
        "bending of span 1": 1,
        "bending of span 2": 0,
        "torsion of span 1": 2,
        "torsion of span 2": 4,
    }
    assert likeness == pytest.approx(np.ones(4))


def test_the_deck_alone_bends_near_its_beam_frequency() -> None:
    """One 21 m span without rails against a pinned beam of the section's own stiffness.

    Area and inertia by the mid-lines of figure 7.5, slab and walls weighed by the ratio of moduli;
    length between bearings 19.8 m. Shear (mostly of the webs) lowers the first frequency by 6 to
    10 percent, the overhangs beyond the bearings by less than 1.
    """
    v = ViaductProperties(spans=(21.0,), guided_stiffness=0.0)
    ratio = v.slab_modulus / v.beam_modulus
    web_height = v.slab_level - 0.09
    plates = np.array(
        [
            [ratio * 7.2 * 0.27, v.slab_level, 0.27**2 / 12.0],
            [3.1 * 0.18, 0.09, 0.18**2 / 12.0],
            [2.0 * web_height * 0.2, 0.09 + 0.5 * web_height, web_height**2 / 12.0],
            [ratio * 2.0 * 0.7 * 0.25, v.slab_level + 0.35, 0.7**2 / 12.0],
        ]
    )
    area, height, own = plates.T
    centre = np.sum(area * height) / area.sum()
    rigidity = v.beam_modulus * np.sum(area * (own + (height - centre) ** 2))
    euler = pi / 2.0 / 19.8**2 * np.sqrt(rigidity / 11.92e3)
    model = build_structure(v, TrackProperties(), "coarse")
    frequencies, shapes = modes(model.stiffness, model.mass, 8)
    points = deck_points(
        model.node_coordinates,
        model.slab_nodes,
        model.span_of_slab_node,
        model.bearing_positions,
        model.bearing_span,
        v.wall_position,
    )
    chosen, likeness = identify(shapes, model.displacement_operator, points, global_shapes(1)[:1])
    assert likeness[0] > 0.99
    assert 0.88 * euler < frequencies[chosen[0]] < 0.97 * euler


def test_the_track_of_the_thesis_is_as_stiff_under_one_rail_as_under_two() -> None:
    """A seat pressed by 1 N sinks 5 nm; the sleeper is so long that the other rail hardly matters.

    With rails and pads this makes the static deflection of 3.7 to 4.1 nm/N of the thesis's figure
    6.17 (checked with the rails in test_track_compliance).
    """
    model = build_track(TrackProperties(), 12, "standard")
    loads = np.zeros((model.n_dof, 2))
    loads[model.seat_dofs[0, 6], 0] = 1.0
    loads[model.seat_dofs[:, 6], 1] = 1.0
    seat = factorise(model.stiffness, "track").solve(loads)[model.seat_dofs[0, 6]] * 1e9
    assert seat[0] == pytest.approx(4.95, abs=0.1)
    assert seat[1] / seat[0] == pytest.approx(1.0, abs=0.02)
