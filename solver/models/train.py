"""Trains: their properties, and the matrices that follow from them."""

from __future__ import annotations

from typing import TypeAlias

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

TrainProperties: TypeAlias = ArticulatedTrain | SprungMasses
"""Every kind of train, told apart by its ``type``."""


def build_train(properties: TrainProperties) -> TrainModel:
    """Assembles a train.

    Args:
        properties: What it is made of.

    Returns:
        Its matrices, weights and wheels.

    Raises:
        InputError: The cars of the consist cannot be put together.
    """
    if isinstance(properties, SprungMasses):
        return sprung_mass_train(properties)
    return articulated_train(properties)
