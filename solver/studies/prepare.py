"""From a study to a simulation that is ready to take its first step."""

from __future__ import annotations

from solver.arrays import Cache
from solver.data import load
from solver.errors import InputError
from solver.factorisation import back_end_name
from solver.integrators import HHT
from solver.irregularities import describe
from solver.models.beam_bridge import BeamBridge
from solver.models.mesh_level import MeshLevel
from solver.models.train import GRAVITY, ArticulatedTrain, AxleTable
from solver.results import RunPlan
from solver.simulation import Simulation
from solver.studies.crossing import crossing
from solver.studies.observe import Recording, record
from solver.studies.scene import Scene, StageListener, build_scene
from solver.studies.shared import Shared
from solver.studies.study import Contact, Study

__all__ = ["prepare", "prepare_model", "runs_of"]


def runs_of(study: Study) -> tuple[dict[str, float], ...]:
    """Parameters of each run of the sweep: ``{"speed": ...}`` in m/s."""
    return tuple({"speed": speed} for speed in study.sweep.speeds)


def prepare_model(study: Study, cache: Cache, report: StageListener = lambda stage: None) -> None:
    """Makes what the runs of a study share, and saves it in a cache for ``prepare``.

    What the cache holds already, and fits, is left as it is.

    Args:
        study: The study; ``check`` it first.
        cache: Where it is saved, one of its own for each ``model_key``.
        report: Told the name of each stage as it begins.

    Raises:
        InputError: The parts do not fit together.
        SingularSystemError: Something can move without resistance.
    """
    _prepare(study, 0, report, Shared(cache, saves=True))


def prepare(
    study: Study,
    run_index: int = 0,
    report: StageListener = lambda stage: None,
    cache: Cache | None = None,
) -> Simulation:
    """Builds the models of one run, factorises, and finds the static start.

    Args:
        study: The study; ``check`` it first.
        run_index: Which point of the sweep.
        report: Told the name of each stage as it begins.
        cache: What ``prepare_model`` filled for this study; what is missing in it, or does not
            fit, is made anew. The simulation is the same to the last bit with it and without.

    Returns:
        The simulation.

    Raises:
        InputError: The parts do not fit together, or there is no such run.
        SingularSystemError: Something can move without resistance.
    """
    return _prepare(study, run_index, report, Shared(cache))


def _prepare(study: Study, run_index: int, report: StageListener, shared: Shared) -> Simulation:
    runs = runs_of(study)
    if not 0 <= run_index < len(runs):
        raise InputError(
            "run_index", run_index, f"the study has runs 0 to {len(runs) - 1}", "Choose one."
        )
    speed = runs[run_index]["speed"]
    extent = crossing(study, speed)
    method = HHT(study.integration.alpha, study.integration.time_step)
    scene = build_scene(study, extent, speed, report, shared)
    recording = record(study, scene, method.alpha * method.time_step)
    facts = _facts(study, scene, recording, report, shared)
    step = method.time_step
    plan = RunPlan(
        n_step=extent.n_step,
        time_step=step,
        speed=speed,
        start_position=extent.start,
        window_start=extent.window_start,
        channels=recording.channels,
        slab=recording.slab,
        geometry=recording.geometry,
        frame_stride=max(1, round(study.outputs.frame_interval / step)),
        facts=facts,
        frame_motion=True,
    )
    report("factorising and finding the static start")
    return Simulation(
        plan,
        scene.system,
        method,
        recording.observation,
        static=shared.static_start(scene.system),
        condenser=shared.condense,
    )


def _facts(
    study: Study, scene: Scene, recording: Recording, report: StageListener, shared: Shared
) -> dict[str, object]:
    """What the summary says about the model, in SI units and plain words."""
    line, structure = scene.system.line, scene.structure
    facts: dict[str, object] = {
        "train": study.train.name,
        "irregularity": describe(study.irregularity),
        "unknowns_structure": 0 if structure is None else int(structure.mass.shape[0]),
        "unknowns_rails": int(line.n_dof * line.n_line),
        "unknowns_train": int(scene.train.n_dof),
        "wheels": len(scene.train.wheel_names),
        "static_wheel_load": _static_load(scene),
        "contact_law": _contact_law(study.contact),
        "back_end": back_end_name(),
        "live_channels": list(recording.live),
    }
    assumed = {"assumed": found} if (found := _assumed(study)) else {}
    if isinstance(study.viaduct, BeamBridge):
        return facts | assumed
    assert structure is not None
    report("finding the natural frequencies of the deciding span")
    facts["mesh_level"] = study.mesh_level
    facts["mesh_accuracy"] = _accuracy(study.mesh_level)
    facts |= assumed
    facts["approach_bed_stiffness"] = scene.bed_stiffness
    facts["member_frequencies"] = shared.frequencies(structure, recording.slab.judged_spans)
    return facts


def _contact_law(contact: Contact) -> str:
    """The contact law and its constant, in words."""
    pulling = "" if contact.unilateral else ", also in tension"
    if contact.law == "rigid":
        return f"rigid{pulling}"
    if contact.law == "linear_hertz":
        return f"linear Hertz, k_h = {1e-6 * contact.stiffness:.4g} MN/m{pulling}"
    return f"nonlinear Hertz, K_h = {1e-6 * contact.hertz_constant:.4g} MN/m^1.5{pulling}"


def _static_load(scene: Scene) -> float:
    """Mean static load of a wheel. [N]"""
    return float(scene.train.total_mass * GRAVITY / scene.train.n_wheel)


def _accuracy(level: MeshLevel) -> list[str]:
    """Measured accuracy of a mesh level, in sentences; see tests/validation."""
    measured = load("mesh_accuracy").get(level)
    if measured is None:
        return []
    return [
        f"Measured on {measured['case']}, against the {measured['against']} mesh: displacement of "
        f"mid-span 2 within {100 * measured['displacement']:.1f} percent, its acceleration below "
        f"30 Hz within {100 * measured['acceleration']:.1f} percent, first wheel's contact-force "
        f"band within {1e-3 * measured['contact_force_band']:.1f} kN."
    ]


def _assumed(study: Study) -> list[str]:
    """Inputs that no source prints, as far as the study's parts have them."""
    found: list[str] = [] if isinstance(study.viaduct, BeamBridge) else [*_ASSUMED_OF_THE_DECK]
    train = study.train
    if isinstance(train, ArticulatedTrain):
        found += _ASSUMED_OF_CARS
    elif isinstance(train, AxleTable):
        found += _assumed_of_axles(train)
    return found


def _assumed_of_axles(train: AxleTable) -> list[str]:
    """What stands for the suspension that the rows do not give."""
    percent = f"{100.0 * train.damping_ratio:g} percent of"
    if any(axle.stiffness == 0.0 for axle in train.axles):
        damped = f"with {percent} critical damping" if train.damping_ratio else "without damping"
        bounce = f"sprung masses bounce at {train.bounce_frequency:g} Hz"
        return [f"suspension of the axles: {bounce} {damped}"]
    if any(axle.damping == 0.0 for axle in train.axles):
        damped = f"{percent} the critical one" if train.damping_ratio else "none"
        return [f"damping of the axles: {damped}"]
    return []


_ASSUMED_OF_THE_DECK = ("places of the bearings", "mass of edge beams and safeguards")
_ASSUMED_OF_CARS = ("heights of the inter-car dampers", "roll coupling at the articulations")
"""Inputs that the thesis does not print."""
