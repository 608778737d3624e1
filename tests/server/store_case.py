"""Small runs whose stored values tell their own step."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.results import (
    BodyGeometry,
    ChannelSpec,
    Frame,
    Geometry,
    Layer,
    RunPlan,
    Sample,
    SlabPoints,
    WheelGeometry,
)
from solver.units import Units

N_POINT = 150
N_VERTEX = 12


def make_plan(n_step: int, *, n_point: int = N_POINT, frame_stride: int = 20) -> RunPlan:
    """A small plan with every part that is stored."""
    channels = tuple(
        ChannelSpec(
            name=f"wheel {i:02d} right/contact force",
            unit=Units.force,
            title=f"Contact force, wheel {i}",
            group="wheel",
            place=(27.0, 0.0, 1.3) if i == 0 else None,
            time_offset=-1e-5,
        )
        for i in range(37)
    )
    return RunPlan(
        n_step=n_step,
        time_step=1e-3,
        speed=120.0,
        start_position=-18.0,
        window_start=0.1,
        channels=channels,
        slab=SlabPoints(
            coordinates=np.arange(3.0 * n_point).reshape(n_point, 3),
            span=np.zeros(n_point, np.int64),
            judged_spans=(0,),
            named={"mid-span 2, axis": 3} if n_point else {},
        ),
        geometry=Geometry(
            vertices=np.linspace(0.0, 1.0, 3 * N_VERTEX).reshape(N_VERTEX, 3),
            layers=(Layer(name="slab", faces=np.array([[0, 1, 2, 3]])),),
            wheels=WheelGeometry(
                names=("wheel 01 right",),
                offsets=np.zeros(1),
                lateral=np.array([-0.7175]),
                contact_height=1.6,
                radius=0.46,
            ),
            bodies=(
                BodyGeometry(name="car 01", kind="carbody", offset=0.0, size=(13, 3, 3), base=1.0),
            ),
            spans=np.array([[0.0, 16.5]]),
        ),
        frame_stride=frame_stride,
        facts={"mesh level": "coarse"},
        frame_motion=True,
    )


def samples_of(plan: RunPlan, start: int = 0) -> Iterator[Sample]:
    """Values that tell their own step, from one on."""
    n_point = plan.slab.coordinates.shape[0]
    for step in range(start, plan.n_sample):
        frame = None
        if step % plan.frame_stride == 0:
            frame = Frame(
                displacement=np.full((N_VERTEX, 3), float(step)),
                bodies=np.full((1, 3), -step),
                velocity=step + np.arange(N_VERTEX) / 100.0,
                acceleration=-step - np.arange(N_VERTEX) / 100.0,
            )
        yield Sample(
            step=step,
            time=step * plan.time_step,
            channels=step + np.arange(len(plan.channels)) / 100.0,
            slab=step + np.arange(n_point) / 1000.0,
            frame=frame,
        )
