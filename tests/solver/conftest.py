"""A small crossing that every test of the coupled system can afford."""

from __future__ import annotations

from dataclasses import replace

import pytest

from solver.models.ballasted_track import TrackProperties
from solver.models.train import ArticulatedTrain, khst
from solver.models.viaduct import ViaductProperties
from solver.studies import Study
from solver.studies.study import Extent, Integration, Outputs, Sweep


def short_train() -> ArticulatedTrain:
    """Both power cars and both trailers of the KHST, with two passenger cars between them."""
    train = khst()
    consist = (*train.consist[:2], train.consist[2], train.consist[2], *train.consist[-2:])
    return replace(train, name="KHST of six cars", consist=consist)


@pytest.fixture(scope="session")
def small_study() -> Study:
    """One 12 m span, one defect-free crossing at 70 m/s on the coarse mesh, 0.2 s of it."""
    return Study(
        name="small crossing",
        train=short_train(),
        viaduct=ViaductProperties(spans=(12.0,)),
        track=TrackProperties(embankment_length=6.0),
        extent=Extent(run_in=20.0, run_out=0.0),
        integration=Integration(time_step=5e-4),
        mesh_level="coarse",
        outputs=Outputs(frame_interval=0.05),
        sweep=Sweep(speeds=(70.0,)),
    )
