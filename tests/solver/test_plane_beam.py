"""Plane beams on supports: statics, frequencies, rows, ground before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sparse

from solver.errors import InputError
from solver.factorisation import factorise
from solver.models.plane_beam import BeamOnSupports, PlaneBeams, plane_beams
from solver.verification.spectrum import first_frequencies

BEAM = PlaneBeams(spans=(20.0, 10.0), rigidity=75e9, mass_per_length=30e3, elements_per_span=20)
FLEXIBLE = replace(BEAM, shear_rigidity=5.2e10, rotary_inertia=15e3)


def deflected(bridge: BeamOnSupports, place: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements under a unit force on the path, and the supports' reactions."""
    structure = bridge.structure
    free = np.setdiff1d(np.arange(structure.n_dof), structure.prescribed)
    load = bridge.path.rows(*bridge.path.locate(np.array([place]))).dense()[0]
    stiffness = sparse.csr_array(structure.stiffness[free][:, free])
    moved = np.zeros(structure.n_dof)
    moved[free] = factorise(stiffness, "the beam").solve(load[free])
    return moved, (structure.stiffness @ moved - load)[structure.prescribed]


@pytest.mark.parametrize("beam", [BEAM, FLEXIBLE])
def test_static_deflection_and_reactions(beam: PlaneBeams) -> None:
    moved, reactions = deflected(plane_beams(beam), 10.0)
    shear = 0.0 if beam.shear_rigidity is None else 20.0 / (4.0 * beam.shear_rigidity)
    # Nodal values of these elements are exact; rounding is magnified by EI / l^3 over EI / L^3.
    wanted = 20.0**3 / (48.0 * beam.rigidity) + shear
    assert (plane_beams(beam).mid_spans @ moved)[0] == pytest.approx(wanted, rel=1e-9)
    # Half the force at either end of the first span, nothing on the second.
    assert reactions == pytest.approx([-0.5, -0.5, 0.0, 0.0], abs=1e-8)


def test_a_force_between_nodes_finds_the_element_in_its_own_shape() -> None:
    """Reciprocity with a point of the path where the deflection is the exact cubic."""
    bridge = plane_beams(FLEXIBLE)
    moved, _ = deflected(bridge, 5.0)
    # At x = 14.3 m, within an element, right of a unit force at 5 m: simply supported beam.
    a, x, length = 5.0, 14.3, 20.0
    bending = a * (length - x) * (length**2 - a**2 - (length - x) ** 2) / (6.0 * length * 75e9)
    wanted = bending + a * (length - x) / (length * 5.2e10)
    row = bridge.path.rows(*bridge.path.locate(np.array([x])))
    assert row.dot(moved)[0] == pytest.approx(wanted, rel=1e-9)


def test_first_frequencies() -> None:
    # Consistent mass with 20 elements: relative error (pi / 20)^4 / 1440, below 1e-6.
    one = replace(BEAM, spans=(20.0,))
    exact = np.pi / 2.0 / 400.0 * np.sqrt(75e9 / 30e3)
    assert first_frequencies(plane_beams(one).structure, 1)[0] == pytest.approx(exact, rel=1e-6)
    # Timoshenko: (omega^4) r^2 / (k G A / m) - omega^2 (1 + (pi/L)^2 (r^2 + s)) + omega_0^2 = 0.
    soft = plane_beams(replace(FLEXIBLE, spans=(20.0,))).structure
    wave, radius, shear = (np.pi / 20.0) ** 2, 15e3 / 30e3, 75e9 / 5.2e10
    middle = 1.0 + wave * (radius + shear)
    leading = radius * 30e3 / 5.2e10
    root = (middle - np.sqrt(middle**2 - 4 * leading * (2 * np.pi * exact) ** 2)) / (2 * leading)
    wanted = np.sqrt(root) / (2.0 * np.pi)
    # The shear strain is constant in an element: order 2, (pi / 20)^2 / 720 times the shear's part.
    assert first_frequencies(soft, 1)[0] == pytest.approx(wanted, rel=5e-5)


def test_vertical_translation_costs_nothing_and_weighs_all() -> None:
    bridge = plane_beams(FLEXIBLE)
    vertical, structure = bridge.vertical, bridge.structure
    assert vertical is not None
    largest = np.abs(structure.stiffness.data).max()
    assert np.abs(structure.stiffness @ vertical).max() < 1e-12 * largest
    assert vertical @ structure.mass @ vertical == pytest.approx(30e3 * 30.0)


def test_ground_before_and_after_keeps_the_chainage_of_the_spans() -> None:
    uphill = replace(BEAM, inclination=0.3)
    bridge = plane_beams(uphill, before=7.0, after=9.0)
    assert bridge.vertical is None
    path = bridge.path
    assert path.chainage[[0, 1, -2, -1]] == pytest.approx([-7.0, 0.0, 30.0, 39.0])
    point = path.at(np.array([-7.0, 25.0, 38.5]))
    along = np.array([np.cos(0.3), 0.0, np.sin(0.3)])
    assert point.position == pytest.approx(np.outer([-7.0, 25.0, 38.5], along), abs=1e-12)
    assert np.all(path.rows(*path.locate(np.array([-3.0, 35.0]))).dense() == 0.0)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"spans": ()}, "beam.spans"),
        ({"spans": (20.0, -1.0)}, r"beam.spans\[1\]"),
        ({"rigidity": 0.0}, "beam.rigidity"),
        ({"mass_per_length": -1.0}, "beam.mass_per_length"),
        ({"elements_per_span": 0}, "beam.elements_per_span"),
        ({"shear_rigidity": 0.0}, "beam.shear_rigidity"),
        ({"rotary_inertia": -1.0}, "beam.rotary_inertia"),
        ({"inclination": 2.0}, "beam.inclination"),
    ],
)
def test_bad_values_are_refused(change: dict[str, object], field: str) -> None:
    with pytest.raises(InputError, match=field):
        replace(BEAM, **change)
