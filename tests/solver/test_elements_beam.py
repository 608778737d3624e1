"""Beam in space: patch, closed forms of the cantilever, offsets, loads, frequencies, bad input."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from solver.arrays import FloatArray, Matrix, Vector
from solver.assembly.scatter import ElementMatrices, scatter
from solver.elements import beam
from solver.elements.beam import BeamSection
from solver.errors import InputError

YOUNG, NU, DENSITY = 31e9, 0.2, 2500.0
SHEAR = YOUNG / (2.0 * (1.0 + NU))
EULER = BeamSection(area=0.9, second_moment_y=0.11, second_moment_z=0.06, torsion_constant=0.08)
TIMOSHENKO = replace(EULER, shear_area_y=0.7, shear_area_z=0.5)
SECTIONS = pytest.mark.parametrize("section", [EULER, TIMOSHENKO], ids=["euler", "timoshenko"])
UNEVEN = np.array([0.0, 0.4, 1.9, 2.2, 4.0])
LENGTH = 4.0
SKEW = Rotation.from_euler("xyz", [0.4, -0.9, 1.3]).as_matrix()


def _chain(x: Vector) -> FloatArray:
    points = np.column_stack([x, np.zeros((len(x), 2))])
    return np.stack([points[:-1], points[1:]], axis=1)


def _whole(matrices: FloatArray) -> Matrix:
    """Assembles a chain of elements, node after node."""
    count = len(matrices)
    freedoms = 6 * np.arange(count)[:, None] + np.arange(12)
    blocks = [ElementMatrices(freedoms=freedoms, matrices=matrices)]
    return scatter(blocks, 6 * (count + 1)).toarray()


def _cantilever(section: BeamSection, tip: Vector, x: Vector = UNEVEN) -> Matrix:
    """Motions of all nodes of a chain held at its first node, in global axes, loaded at its tip."""
    stiffness = _whole(beam.stiffness(_chain(x), section, YOUNG, NU))
    motion = np.zeros(6 * len(x))
    load = np.concatenate([np.zeros(6 * (len(x) - 2)), tip])
    motion[6:] = np.linalg.solve(stiffness[6:, 6:], load)
    return motion.reshape(-1, 6)


def _flexibility(section: BeamSection, length: float) -> Matrix:
    """Tip motions of a cantilever along x under unit tip forces and moments (any textbook)."""
    result = np.zeros((6, 6))
    result[0, 0] = length / (YOUNG * section.area)
    result[3, 3] = length / (SHEAR * section.torsion_constant)
    for plane, sign, moment, area in (
        ((1, 5), 1.0, section.second_moment_z, section.shear_area_y),
        ((2, 4), -1.0, section.second_moment_y, section.shear_area_z),
    ):
        shear = 0.0 if area is None else length / (SHEAR * area)
        rigidity = YOUNG * moment
        result[np.ix_(plane, plane)] = [
            [length**3 / (3.0 * rigidity) + shear, sign * length**2 / (2.0 * rigidity)],
            [sign * length**2 / (2.0 * rigidity), length / rigidity],
        ]
    return result


@SECTIONS
def test_a_chain_of_uneven_beams_has_every_textbook_flexibility(section: BeamSection) -> None:
    """Tension, torsion, tip force and tip moment in both planes: 36 numbers at every node."""
    for direction in range(6):
        tip = np.eye(6)[direction] * 1e4
        motions = _cantilever(section, tip)
        for node, x in enumerate(UNEVEN[1:], start=1):
            # The part beyond x hands its load on as a force and a moment at x.
            carried = tip.copy()
            carried[3:] += np.cross([LENGTH - x, 0.0, 0.0], tip[:3])
            exact = _flexibility(section, float(x)) @ carried
            # Machine precision times the condition of a chain of four.
            assert motions[node] == pytest.approx(exact, rel=1e-10, abs=1e-16)


@SECTIONS
def test_constant_strains_pass_through_uneven_beams(section: BeamSection) -> None:
    """Ends moved as in constant extension, twist and curvature: so do all nodes between."""
    strain, twist, in_xy, in_xz = 1e-4, 2e-4, -3e-4, 5e-4
    x = UNEVEN
    exact = np.column_stack(
        [strain * x, in_xy * x**2 / 2, in_xz * x**2 / 2, twist * x, -in_xz * x, in_xy * x]
    )
    stiffness = _whole(beam.stiffness(_chain(x), section, YOUNG, NU))
    inner, ends = np.arange(6, 24), np.array([*range(6), *range(24, 30)])
    load = -stiffness[np.ix_(inner, ends)] @ exact.ravel()[ends]
    motions = np.linalg.solve(stiffness[np.ix_(inner, inner)], load)
    assert motions == pytest.approx(exact.ravel()[inner], rel=1e-9, abs=1e-15)
    forces = (stiffness @ exact.ravel()).reshape(-1, 6)[-1]
    expected = [
        YOUNG * section.area * strain, 0, 0, SHEAR * section.torsion_constant * twist,
        -YOUNG * section.second_moment_y * in_xz, YOUNG * section.second_moment_z * in_xy,
    ]  # fmt: skip
    assert forces == pytest.approx(expected, rel=1e-9, abs=1e-4)


@SECTIONS
def test_a_skew_cantilever_with_offsets_bends_about_its_own_axes(section: BeamSection) -> None:
    """Both nodes lie off the beam's axis; held at one, loaded at the other, in skew axes."""
    offsets = np.array([[[0.1, -0.3, 0.6], [-0.2, 0.5, 0.4]]])
    ends = np.array([[[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0]]])
    nodes = ends - offsets
    stiffness = beam.stiffness(
        nodes @ SKEW.T, section, YOUNG, NU,
        orientation=SKEW @ [0.3, 0.0, 1.0], offsets=offsets @ SKEW.T,
    )[0]  # fmt: skip
    force, moment = np.array([3e4, -5e4, 2e4]), np.array([1e4, 4e4, -2e4])
    turn = np.kron(np.eye(2), SKEW)
    motion = turn.T @ np.linalg.solve(stiffness[6:, 6:], turn @ np.concatenate([force, moment]))
    arm = -offsets[0, 1]
    at_end = _flexibility(section, LENGTH) @ np.concatenate([force, moment + np.cross(arm, force)])
    exact = at_end + np.concatenate([np.cross(at_end[3:], arm), np.zeros(3)])
    assert motion == pytest.approx(exact, rel=1e-11)


@SECTIONS
def test_a_uniform_load_is_exact_at_the_nodes(section: BeamSection) -> None:
    """Tip of a cantilever: q L4 / 8 E I + q L2 / 2 G A_s, slope q L3 / 6 E I, in both planes."""
    load = np.array([300.0, -2000.0, 5000.0])
    stiffness = _whole(beam.stiffness(_chain(UNEVEN), section, YOUNG, NU))
    nodal = np.zeros(30)
    for element, values in enumerate(beam.uniform_load(_chain(UNEVEN), load)):
        nodal[6 * element : 6 * element + 12] += values
    tip = np.linalg.solve(stiffness[6:, 6:], nodal[6:])[-6:]
    exact = np.zeros(6)
    exact[0] = load[0] * LENGTH**2 / (2.0 * YOUNG * section.area)
    for axis, about, sign, moment, area in (
        (1, 5, 1.0, section.second_moment_z, section.shear_area_y),
        (2, 4, -1.0, section.second_moment_y, section.shear_area_z),
    ):
        exact[axis] = load[axis] * LENGTH**4 / (8.0 * YOUNG * moment)
        exact[axis] += 0.0 if area is None else load[axis] * LENGTH**2 / (2.0 * SHEAR * area)
        exact[about] = sign * load[axis] * LENGTH**3 / (6.0 * YOUNG * moment)
    assert tip == pytest.approx(exact, rel=1e-10, abs=1e-16)


@SECTIONS
def test_weight_as_a_load_is_weight_as_an_inertia_force(section: BeamSection) -> None:
    """The load vector and the mass matrix must not disagree: M g, with skew axes and offsets."""
    nodes = _chain(UNEVEN) @ SKEW.T
    offsets = np.random.default_rng(3).standard_normal(nodes.shape) * 0.1
    gravity = np.array([0.0, 0.0, -9.81])
    load = beam.uniform_load(nodes, DENSITY * section.area * gravity, offsets=offsets)
    mass = beam.mass(nodes, section, DENSITY, NU, offsets=offsets)
    inertia = mass @ np.tile(np.concatenate([gravity, np.zeros(3)]), 2)
    assert np.allclose(load, inertia, rtol=1e-11, atol=1e-8)


def test_slender_timoshenko_beams_do_not_lock() -> None:
    """One element, ever more slender: the deflection stays P L3 / 3 E I + P L / G A_s."""
    for slenderness in (10.0, 1e3, 1e5):
        depth = LENGTH / slenderness
        section = BeamSection(
            area=depth**2, second_moment_y=depth**4 / 12, second_moment_z=depth**4 / 12,
            torsion_constant=depth**4 / 7, shear_area_y=depth**2 / 1.2, shear_area_z=depth**2 / 1.2,
        )  # fmt: skip
        stiffness = beam.stiffness(_chain(np.array([0.0, LENGTH])), section, YOUNG, NU)[0]
        tip = np.linalg.inv(stiffness[6:, 6:])[2, 2]
        assert tip == pytest.approx(_flexibility(section, LENGTH)[2, 2], rel=1e-9)


def test_the_mass_is_the_published_one() -> None:
    """Entries of the consistent mass of a bent beam with shear and rotary inertia.

    References:
        Przemieniecki (1968), Theory of Matrix Structural Analysis, chapter 11.
    """
    length, phi, gyration = 1.7, 0.6, 0.35
    r2 = (gyration / length) ** 2
    scale = 230.0 * length / (1.0 + phi) ** 2
    mass = beam.bending_mass(np.array([length]), 230.0, 230.0 * gyration**2, phi)[0] / scale
    assert mass[0, 0] == pytest.approx(13 / 35 + 7 / 10 * phi + phi**2 / 3 + 6 / 5 * r2)
    assert mass[0, 1] / length == pytest.approx(
        11 / 210 + 11 / 120 * phi + phi**2 / 24 + (1 / 10 - phi / 2) * r2
    )
    assert mass[0, 2] == pytest.approx(9 / 70 + 3 / 10 * phi + phi**2 / 6 - 6 / 5 * r2)
    assert mass[0, 3] / length == pytest.approx(
        -(13 / 420 + 3 / 40 * phi + phi**2 / 24 - (1 / 10 - phi / 2) * r2)
    )
    assert mass[1, 1] / length**2 == pytest.approx(
        1 / 105 + phi / 60 + phi**2 / 120 + (2 / 15 + phi / 6 + phi**2 / 3) * r2
    )
    assert mass[1, 3] / length**2 == pytest.approx(
        -(1 / 140 + phi / 60 + phi**2 / 120 + (1 / 30 + phi / 6 - phi**2 / 6) * r2)
    )


def _first_frequencies(section: BeamSection, span: float, count: int, rotary: bool) -> Vector:
    """Circular frequencies in the vertical plane of a simply supported beam."""
    nodes = _chain(np.linspace(0.0, span, count + 1))
    stiffness = _whole(beam.stiffness(nodes, section, YOUNG, NU))
    mass = _whole(beam.mass(nodes, section, DENSITY, NU, rotary_inertia=rotary))
    kept = np.setdiff1d((6 * np.arange(count + 1)[:, None] + [2, 4]).ravel(), [2, 6 * count + 2])
    values = eigh(
        stiffness[np.ix_(kept, kept)], mass[np.ix_(kept, kept)], eigvals_only=True,
        subset_by_index=[0, 1],
    )  # fmt: skip
    return np.sqrt(values)


def _order(errors: list[float]) -> float:
    """Slope of the last two errors, each mesh twice as fine as the one before."""
    return float(np.log2(errors[-2] / errors[-1]))


def test_euler_frequencies_converge_at_order_four() -> None:
    """Simply supported: omega_n = (n pi / L)^2 sqrt(E I / m), and the error's leading term too.

    The nodes' values being exact in statics, the error is the energy of the element's own bending
    under its inertia force, fixed at its ends: (n pi h / L)^4 / 1440 of the frequency.
    """
    span, counts = 25.0, (4, 8, 16)
    line = DENSITY * EULER.area
    for mode in (1, 2):
        exact = (mode * pi / span) ** 2 * sqrt(YOUNG * EULER.second_moment_y / line)
        found = [_first_frequencies(EULER, span, n, rotary=False)[mode - 1] for n in counts]
        errors = [value / exact - 1.0 for value in found]
        assert _order(errors) == pytest.approx(4.0, abs=0.1)
        assert errors[-1] == pytest.approx((mode * pi / counts[-1]) ** 4 / 1440.0, rel=0.05)


def _timoshenko_frequency(section: BeamSection, span: float, mode: int) -> float:
    """Lower root of the frequency equation of a simply supported Timoshenko beam.

    E I k4 - (m + (m E I / G A_s + rho I) k2) omega2 + (rho I m / G A_s) omega4 = 0, k = n pi / L.

    References:
        Timoshenko (1921); Clough and Penzien (1993), section 18.4.
    """
    assert section.shear_area_z is not None
    line, rotary = DENSITY * section.area, DENSITY * section.second_moment_y
    rigidity, shear = YOUNG * section.second_moment_y, SHEAR * section.shear_area_z
    k2 = (mode * pi / span) ** 2
    linear = line + (line * rigidity / shear + rotary) * k2
    product = rotary * line / shear * rigidity * k2**2
    # The small root without cancellation.
    return sqrt(2.0 * rigidity * k2**2 / (linear + sqrt(linear**2 - 4.0 * product)))


def _leading_error(section: BeamSection, span: float, mode: int, size: float) -> float:
    """Relative error of the frequency on elements much shorter than the depth.

    The nodes' values being exact in statics, the eigenvalue's error is the energy of elements fixed
    at their ends under the mode's inertia force q and inertia moment m: for short elements
    q^2 h^3 / 12 G A_s + m^2 h^3 / 12 E I each, over the mode's kinetic energy.
    """
    assert section.shear_area_z is not None
    k, line, rotary = mode * pi / span, DENSITY * section.area, DENSITY * section.second_moment_y
    shear = SHEAR * section.shear_area_z
    eigenvalue = _timoshenko_frequency(section, span, mode) ** 2
    rotation = k - eigenvalue * line / (shear * k)
    bending = (rotary * rotation) ** 2 / (YOUNG * section.second_moment_y)
    energy = (line**2 / shear + bending) / (line + rotary * rotation**2)
    return 0.5 * eigenvalue * size**2 / 12.0 * energy


def test_timoshenko_frequencies_converge_to_the_frequency_equation() -> None:
    """A stocky beam, five times as long as deep: order two, at the predicted distance.

    The shear strain is constant in an element, so order four ends where elements are as short as
    the beam is deep.
    """
    span, counts = 6.0, (8, 16, 32, 64)
    for mode in (1, 2):
        exact = _timoshenko_frequency(TIMOSHENKO, span, mode)
        slender = (mode * pi / span) ** 2 * sqrt(
            YOUNG * EULER.second_moment_y / (DENSITY * EULER.area)
        )
        # Shear and rotary inertia matter here: the test would see either of them missing.
        assert exact / slender < 0.93
        found = [_first_frequencies(TIMOSHENKO, span, n, rotary=True)[mode - 1] for n in counts]
        errors = [value / exact - 1.0 for value in found]
        assert _order(errors) == pytest.approx(2.0, abs=0.05)
        predicted = _leading_error(TIMOSHENKO, span, mode, span / counts[-1])
        assert errors[-1] == pytest.approx(predicted, rel=0.03)


def test_slender_timoshenko_frequencies_start_at_order_four() -> None:
    """Elements longer than the depth: bending governs the error, as in Euler-Bernoulli's beam."""
    span, counts = 60.0, (4, 8)
    exact = _timoshenko_frequency(TIMOSHENKO, span, 1)
    errors = [_first_frequencies(TIMOSHENKO, span, n, rotary=True)[0] / exact - 1 for n in counts]
    assert _order(errors) > 3.5
    assert errors[-1] < 3e-5


def test_the_default_axes_of_a_beam_along_the_track_are_the_global_ones() -> None:
    rotation, length = beam.local_frame(np.array([[[1.0, 2.0, 3.0], [3.0, 2.0, 3.0]]]))
    assert np.array_equal(rotation[0], np.eye(3))
    assert length == pytest.approx([2.0])


def test_each_element_may_have_its_own_orientation() -> None:
    nodes = np.array([[[0.0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, 1]]])
    rotation, _ = beam.local_frame(nodes, np.array([[0.0, 1, 0], [1.0, 0, 0.4]]))
    assert rotation[0, 2] == pytest.approx([0, 1, 0])
    assert rotation[1, 2] == pytest.approx([1, 0, 0])
    assert np.linalg.det(rotation) == pytest.approx([1, 1])


UPRIGHT = np.array([[[0.0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, 4.0]]])


def test_an_orientation_along_the_axis_is_refused_with_the_elements_number() -> None:
    with pytest.raises(InputError, match="parallel to the axis of beam element 1"):
        beam.stiffness(UPRIGHT, EULER, YOUNG, NU)


def test_an_orientation_of_zero_is_refused() -> None:
    with pytest.raises(InputError, match="zero or parallel"):
        beam.mass(UPRIGHT, EULER, DENSITY, NU, orientation=np.zeros(3))


def test_a_beam_without_length_is_refused() -> None:
    with pytest.raises(InputError, match="beam element 0 has no length"):
        beam.stiffness(np.ones((1, 2, 3)), EULER, YOUNG, NU)


def test_offsets_that_close_the_gap_between_nodes_leave_no_beam() -> None:
    offsets = np.zeros((2, 2, 3))
    offsets[0, 1] = [-1.0, 0.0, 0.0]
    with pytest.raises(InputError, match="beam element 0 has no length"):
        beam.uniform_load(UPRIGHT, np.zeros(3), offsets=offsets)


@pytest.mark.parametrize("value", [0.0, -0.1, float("nan"), float("inf")])
def test_a_section_property_that_is_not_positive_is_refused(value: float) -> None:
    with pytest.raises(InputError, match=r"section\.shear_area_z"):
        replace(TIMOSHENKO, shear_area_z=value)


def test_a_negative_density_is_refused() -> None:
    with pytest.raises(InputError, match="density"):
        beam.mass(_chain(UNEVEN), EULER, -1.0, NU)
