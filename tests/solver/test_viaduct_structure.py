"""The viaduct with its track: masses, counts, supports, symmetry, damping, seats."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import InputError
from solver.factorisation import factorise
from solver.models.ballasted_track import TrackProperties, pad_stiffness, seat_positions
from solver.models.mesh_level import MeshLevel
from solver.models.structure import build_structure, build_track, estimate_unknowns
from solver.models.structure_model import StructureModel
from solver.models.viaduct import ViaductProperties

VIADUCT, TRACK = ViaductProperties(), TrackProperties()


@pytest.fixture(scope="module")
def coarse() -> StructureModel:
    return build_structure(VIADUCT, TRACK, "coarse")


def _moved(model: StructureModel, load: np.ndarray) -> np.ndarray:
    solution = factorise(model.stiffness, "structure").solve(load)
    return (model.displacement_operator @ solution).reshape(-1, 3)


def test_seats_are_the_sleepers_of_the_thesis(coarse: StructureModel) -> None:
    """128 seats from -18 to 58.2 m, one at x = 0 and one at 27 m (the middle of span 2)."""
    assert coarse.seat_positions == pytest.approx(np.arange(-30, 98) * 0.6)
    moved = np.zeros(coarse.n_dof)
    moved[coarse.seat_dofs[0, 75]] = 1.0
    lifted = (coarse.displacement_operator @ moved).reshape(-1, 3)
    points = coarse.node_coordinates[np.abs(lifted[:, 2]) > 1e-9]
    assert points.mean(axis=0) == pytest.approx([27.0, 0.7175, 1.47 + 0.313 + 0.23])


@pytest.mark.parametrize("level", ["coarse", pytest.param("standard", marks=pytest.mark.slow)])
@pytest.mark.parametrize("phase", [0.0, 0.13])
@pytest.mark.parametrize("spans", [(16.5, 21.0, 21.0), (12.0, 17.37)])
def test_the_unknowns_are_known_beforehand(
    level: MeshLevel, phase: float, spans: tuple[float, ...]
) -> None:
    viaduct, track = replace(VIADUCT, spans=spans), replace(TRACK, sleeper_phase=phase)
    expected = build_structure(viaduct, track, level).n_dof
    assert estimate_unknowns(viaduct, track, level) == expected


def test_mesh_levels_have_their_sizes() -> None:
    counts = [estimate_unknowns(VIADUCT, TRACK, level) for level in ("coarse", "standard", "fine")]
    assert 10_000 <= counts[0] <= 20_000
    assert counts[1] == pytest.approx(110_000, rel=0.05)
    assert counts[2] >= 200_000


def test_weight_is_that_of_plates_ballast_and_sleepers() -> None:
    """On the spans: mid-line lengths times thickness, ballast block, 299.7 kg a sleeper."""
    length, v, t = 58.5, VIADUCT, TRACK
    web_height = v.slab_level - 0.5 * v.bottom_thickness
    section = (
        v.slab_width * v.slab_thickness
        + 2.0 * v.web_position * v.bottom_thickness
        + 2.0 * web_height * v.web_thickness
        + 2.0 * v.wall_height * v.wall_thickness
    )
    deck = length * (section * v.density + 2.0 * v.edge_mass)
    ballast = t.ballast_width * t.ballast_depth * t.ballast_density
    # One layer of elements on the embankment: half its mass is held with its base.
    expected = deck + ballast * length + 128 * 299.7
    model = build_structure(v, t, "coarse")
    embankment = ballast * 18.3
    assert -model.weight.sum() / 9.81 == pytest.approx(expected + 0.5 * embankment, rel=2e-3)


def test_dead_load_is_symmetric_and_arrives_at_the_bearings(coarse: StructureModel) -> None:
    solution = factorise(coarse.stiffness, "structure").solve(coarse.weight)
    tension = coarse.bearing_stiffness * (coarse.bearing_operator @ solution)
    assert np.all(tension < 0.0)
    # The two bearings of an end share alike, and those of the two ends of a span do nearly.
    left, right = tension[0::2], tension[1::2]
    assert left == pytest.approx(right, rel=1e-9)
    for span, length in enumerate(VIADUCT.spans):
        own = -tension[coarse.bearing_span == span].sum() / 9.81
        # 11.92 t/m: 8.27 of concrete, 0.40 along the edges, 2.74 of ballast, 0.50 of sleepers.
        # The ballast that bridges the joints hands some of it to the neighbours.
        assert own / length == pytest.approx(11.92e3, rel=0.02)


def test_a_load_on_the_axis_moves_both_sides_alike(coarse: StructureModel) -> None:
    load = np.zeros(coarse.n_dof)
    load[coarse.seat_dofs[:, 75]] = -1e5
    moved = _moved(coarse, load)
    mirrored = np.lexsort(np.round(coarse.node_coordinates * [1, -1, 1], 6).T)
    straight = np.lexsort(np.round(coarse.node_coordinates, 6).T)
    difference = moved[straight] - moved[mirrored] * [1.0, -1.0, 1.0]
    # Nodes of two spans coincide at joints: compare what is unambiguous.
    inside = np.min(np.abs(coarse.node_coordinates[straight, :1] - VIADUCT.joints), axis=1) > 1e-6
    assert np.abs(difference[inside]).max() < 1e-9 * np.abs(moved).max()


def test_ballast_follows_the_slab_through_half_its_thickness(coarse: StructureModel) -> None:
    """The underside at mid-span: as the slab's mid-plane, moved along by the slope times 0.135."""
    load = np.zeros(coarse.n_dof)
    load[coarse.seat_dofs[:, 70]] = -1e5
    moved = _moved(coarse, load)
    underside = np.flatnonzero(
        np.isclose(coarse.node_coordinates[:, 2], VIADUCT.slab_top)
        & (np.abs(coarse.node_coordinates[:, 0] - 27.0) < 0.5)
        & np.isclose(coarse.node_coordinates[:, 1], 0.7175)
    )
    slab = coarse.slab_nodes[np.isclose(coarse.node_coordinates[coarse.slab_nodes, 1], 0.7175)]
    x = coarse.node_coordinates[slab, 0]
    order = np.argsort(x)
    for node in underside:
        at = coarse.node_coordinates[node, 0]
        expected = np.interp(at, x[order], moved[slab[order], 2])
        assert moved[node, 2] == pytest.approx(expected, rel=1e-9)


def test_damping_is_the_decks_on_the_spans_and_the_tracks_before_them(
    coarse: StructureModel,
) -> None:
    """C - a0 M - a1 K vanishes in the rows of a part that has that pair."""
    material = build_structure(replace(VIADUCT, damping="material"), TRACK, "coarse")
    embankment = coarse.seat_dofs[0, coarse.seat_positions < -1.0]
    deck = coarse.seat_dofs[0, coarse.seat_positions > 1.0]
    for model, dofs, mass_factor, stiffness_factor in (
        (coarse, embankment, 21.7, 3.82e-5),
        (coarse, deck, 2.48, 1.58e-4),
        (material, deck, 21.7, 3.82e-5),
    ):
        difference = model.damping - mass_factor * model.mass - stiffness_factor * model.stiffness
        size = abs(model.damping[dofs]).max()
        assert abs(difference[dofs]).max() < 1e-9 * size


def test_bearings_carry_no_damping(coarse: StructureModel) -> None:
    rest = coarse.damping - coarse.mass_proportional * coarse.mass
    rest = rest - coarse.stiffness_proportional * coarse.stiffness
    bearing_rows = coarse.bearing_operator.indices
    expected = -coarse.stiffness_proportional * coarse.bearing_stiffness
    # The drilling penalty of the webs, undamped too, adds a thousandth at most.
    assert rest.diagonal()[bearing_rows] == pytest.approx(expected, rel=1e-3)


def test_pads_soften_towards_the_viaduct_and_behind_it() -> None:
    """Neves (2016), 7.3.1: linear from 500 to 125 MN/m over 6 m, before and after."""
    x = np.array([-6.6, -6.0, -3.0, 0.0, 0.6, 58.2, 58.5, 61.5, 64.5])
    expected = np.array([500.0, 500.0, 312.5, 125.0, 500.0, 500.0, 125.0, 312.5, 500.0]) * 1e6
    assert pad_stiffness(TRACK, 58.5, x) == pytest.approx(expected)
    assert np.all(pad_stiffness(replace(TRACK, transition=False), 58.5, x) == 500e6)


def test_sleepers_stop_at_the_last_that_stands_on_the_span() -> None:
    assert seat_positions(replace(TRACK, sleeper_phase=0.2), 58.5)[-1] == pytest.approx(58.4)
    assert seat_positions(replace(TRACK, sleeper_phase=0.25), 58.5)[-1] == pytest.approx(57.85)


def test_outer_faces_exist_for_every_layer(coarse: StructureModel) -> None:
    assert tuple(coarse.surfaces) == coarse.part_names
    for faces in coarse.surfaces.values():
        assert faces.shape[1] == 4
        assert faces.max() < len(coarse.node_coordinates)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"web_position": 2.12}, "viaduct.web_position"),
        ({"bearing_position": 1.8}, "viaduct.bearing_position"),
        ({"slab_width": 4.2}, "viaduct.wall_position"),
        ({"slab_level": 0.3, "bottom_thickness": 0.3}, "viaduct.slab_level"),
    ],
)
def test_impossible_sections_are_refused(changes: dict[str, float], field: str) -> None:
    with pytest.raises(InputError) as caught:
        replace(VIADUCT, **changes)
    assert caught.value.field == field


def test_ballast_wider_than_the_trough_is_refused() -> None:
    with pytest.raises(InputError, match="walls leave"):
        estimate_unknowns(VIADUCT, replace(TRACK, ballast_width=4.5), "coarse")


def test_a_track_alone_rests_on_its_base() -> None:
    """Between its planes of symmetry a track under equal loads is the same in every bay."""
    model = build_track(TRACK, 6, "coarse")
    load = np.zeros(model.n_dof)
    load[model.seat_dofs] = -1e5
    seats = factorise(model.stiffness, "track").solve(load)[model.seat_dofs]
    assert np.ptp(seats) < 1e-9 * np.abs(seats).max()
    # The ballast spreads the pressure over a bay between 0.2 x 2.6 and 0.6 x 4.3 m.
    column = 2e5 * TRACK.ballast_depth / TRACK.ballast_young_modulus
    assert column / (0.6 * 4.3) < np.abs(seats).max() < column / (0.2 * 2.6)
