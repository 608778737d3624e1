"""Trains: their properties, and the matrices that follow from them."""

from __future__ import annotations

from typing import Literal, TypeAlias

from solver.models.axle_table import Axle, AxleTable, axle_table_train
from solver.models.sprung_mass import SprungMasses, sprung_mass_train
from solver.models.train_articulated import articulated_train
from solver.models.train_model import GRAVITY, LEFT, RIGHT, Body, TrainModel
from solver.models.train_properties import (
    ArticulatedTrain,
    DamperHeights,
    InterCarDampers,
    khst,
)
from solver.models.vehicle import VehicleType

__all__ = [
    "GRAVITY",
    "LEFT",
    "RIGHT",
    "ArticulatedTrain",
    "Axle",
    "AxleTable",
    "Body",
    "DamperHeights",
    "InterCarDampers",
    "SprungMasses",
    "TrainModel",
    "TrainProperties",
    "VehicleType",
    "build_train",
    "khst",
]

TrainProperties: TypeAlias = ArticulatedTrain | SprungMasses | AxleTable
"""Every kind of train, told apart by its ``type``."""


def build_train(properties: TrainProperties, rail_count: Literal[1, 2] = 1) -> TrainModel:
    """Assembles a train.

    Args:
        properties: What it is made of.
        rail_count: Rails of the structure that it crosses. Only an axle table asks: sprung masses
            always roll on one, articulated trains on two.

    Returns:
        Its matrices, weights and wheels.

    Raises:
        InputError: The cars of the consist, or the axles of the table, cannot be put together.
    """
    if isinstance(properties, AxleTable):
        return axle_table_train(properties, rail_count)
    if isinstance(properties, SprungMasses):
        return sprung_mass_train(properties)
    return articulated_train(properties)
