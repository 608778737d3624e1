"""A run's plan in the store: names and numbers as JSON, arrays as Zarr."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from server.store.documents import read_document, write_document
from server.store.layout import PLAN, PLAN_ARRAYS, open_group
from server.store.place import Place
from solver.results import (
    BodyGeometry,
    ChannelSpec,
    Geometry,
    Layer,
    RunPlan,
    SlabPoints,
    WheelGeometry,
)
from solver.units import Unit

__all__ = ["StoredPlan", "read_plan", "write_plan"]

StoredPlan = RunPlan
"""What a reader gives back is what the simulation stated."""


def write_plan(place: Place, plan: RunPlan) -> None:
    """Stores the plan; the JSON file comes last, so that a plan that exists is complete."""
    _write_arrays(place, plan)
    geometry, slab = plan.geometry, plan.slab
    write_document(
        place,
        PLAN,
        {
            "n_step": plan.n_step,
            "time_step": plan.time_step,
            "speed": plan.speed,
            "start_position": plan.start_position,
            "window_start": plan.window_start,
            "frame_stride": plan.frame_stride,
            "modal": plan.modal,
            "frame_motion": plan.frame_motion,
            "channels": [asdict(channel) for channel in plan.channels],
            "slab": {"judged_spans": slab.judged_spans, "named": slab.named},
            "layers": [layer.name for layer in geometry.layers],
            "wheels": {
                "names": geometry.wheels.names,
                "contact_height": geometry.wheels.contact_height,
                "radius": geometry.wheels.radius,
            },
            "bodies": [asdict(body) for body in geometry.bodies],
            "facts": plan.facts,
        },
    )


def read_plan(place: Place) -> RunPlan | None:
    """The stored plan, or None where a run has not stated it yet (or has none)."""
    document = read_document(place, PLAN)
    if document is None:
        return None
    arrays = _read_arrays(place)
    return RunPlan(
        n_step=document["n_step"],
        time_step=document["time_step"],
        speed=document["speed"],
        start_position=document["start_position"],
        window_start=document["window_start"],
        channels=tuple(_channel(item) for item in document["channels"]),
        slab=SlabPoints(
            coordinates=arrays["slab_coordinates"],
            span=arrays["slab_span"],
            judged_spans=tuple(document["slab"]["judged_spans"]),
            named={name: int(index) for name, index in document["slab"]["named"].items()},
        ),
        geometry=_geometry(document, arrays),
        frame_stride=document["frame_stride"],
        facts=document["facts"],
        # Plans of before know neither.
        modal=document.get("modal", False),
        frame_motion=document.get("frame_motion", False),
    )


def _write_arrays(place: Place, plan: RunPlan) -> None:
    geometry = plan.geometry
    group, store = open_group(place, PLAN_ARRAYS, "w")
    arrays: dict[str, Any] = {
        "vertices": geometry.vertices,
        "wheel_offsets": geometry.wheels.offsets,
        "wheel_lateral": geometry.wheels.lateral,
        "spans": geometry.spans,
        "slab_coordinates": plan.slab.coordinates,
        "slab_span": plan.slab.span,
    }
    arrays |= {f"faces_{i}": layer.faces for i, layer in enumerate(geometry.layers)}
    for name, values in arrays.items():
        group.create_array(name, data=np.ascontiguousarray(values))
    place.sync(store)


def _read_arrays(place: Place) -> dict[str, Any]:
    group, _ = open_group(place, PLAN_ARRAYS, "r")
    return {name: np.asarray(array[...]) for name, array in group.arrays()}


def _channel(item: dict[str, Any]) -> ChannelSpec:
    place = item["place"]
    return ChannelSpec(
        name=item["name"],
        unit=Unit(**item["unit"]),
        title=item["title"],
        group=item["group"],
        place=None if place is None else (place[0], place[1], place[2]),
        time_offset=item["time_offset"],
    )


def _geometry(document: dict[str, Any], arrays: dict[str, Any]) -> Geometry:
    wheels = document["wheels"]
    return Geometry(
        vertices=arrays["vertices"],
        layers=tuple(
            Layer(name=name, faces=arrays[f"faces_{i}"])
            for i, name in enumerate(document["layers"])
        ),
        wheels=WheelGeometry(
            names=tuple(wheels["names"]),
            offsets=arrays["wheel_offsets"],
            lateral=arrays["wheel_lateral"],
            contact_height=wheels["contact_height"],
            radius=wheels["radius"],
        ),
        bodies=tuple(_body(item) for item in document["bodies"]),
        spans=arrays["spans"],
    )


def _body(item: dict[str, Any]) -> BodyGeometry:
    length, width, height = item["size"]
    return BodyGeometry(
        name=item["name"],
        kind=item["kind"],
        offset=item["offset"],
        size=(length, width, height),
        base=item["base"],
    )
