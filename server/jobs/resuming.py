"""Checkpoints of a run: when one is stored, and from which one an attempt goes on."""

from __future__ import annotations

import logging
import time
from typing import Any

import numpy as np

from server.jobs.orders import Commands, Order, RunTask, Send
from server.jobs.process import StoppedError
from server.store import (
    Checkpoint,
    CheckpointError,
    Place,
    RunWriter,
    attempt_place,
    earlier_checkpoints,
)
from solver import studies
from solver.errors import InputError
from solver.simulation import Simulation

__all__ = ["CancelledError", "Resumable"]

_log = logging.getLogger("trainbridge.jobs")

_MADE_BY = "made by"


class CancelledError(Exception):
    """The run shall leave its batch."""


class Resumable:
    """An attempt at a run that stores checkpoints and begins at the newest one of those before it.

    Args:
        store: Of all runs.
        order: The batch.
        run: The run.
        send: Told of each checkpoint.
        commands: What the supervisor has asked; its ``stepping`` is set while steps are taken.
    """

    def __init__(
        self, store: Place, order: Order, run: RunTask, send: Send, commands: Commands
    ) -> None:
        self._store = store
        self._order = order
        self._run = run.id
        self._send = send
        self._commands = commands
        self._due = 0.0
        self._writer: RunWriter | None = None

    def begin(self, simulation: Simulation) -> RunWriter:
        """The attempt's writer: at the newest checkpoint of earlier attempts, or at the start.

        Args:
            simulation: Ready for its first step; it is moved to the checkpoint.
        """
        self._writer = self._resumed(simulation)
        if self._writer is None:
            self._writer = RunWriter(self._place(self._order.attempt), simulation.plan)
        self._wait()
        self._commands.stepping = True
        return self._writer

    def after_step(self, simulation: Simulation) -> None:
        """Looks whether a checkpoint is due, or whether somebody asked for something.

        Raises:
            CancelledError: The run was cancelled.
            StoppedError: The process was asked to end; a checkpoint is stored.
        """
        if self._run in self._commands.cancelled:
            self._commands.stepping = False
            raise CancelledError
        if self._commands.stop:
            self._checkpoint(simulation)
            raise StoppedError
        if time.monotonic() >= self._due:
            self._checkpoint(simulation)
            self._wait()

    def end(self) -> None:
        """No more steps: what comes is interrupted at once when the process is asked to end.

        Raises:
            StoppedError: It was asked to already.
        """
        self._commands.stepping = False
        if self._commands.stop:
            raise StoppedError

    def _resumed(self, simulation: Simulation) -> RunWriter | None:
        attempt = self._order.attempt
        for previous, checkpoint in earlier_checkpoints(self._store, self._run, attempt):
            if not _is_ours(checkpoint):
                continue
            state = {name: value for name, value in checkpoint.state.items() if name != _MADE_BY}
            try:
                place = self._place(attempt)
                writer = RunWriter.resumed(place, simulation.plan, previous, checkpoint)
                # Last: a simulation that was moved cannot begin at the start any more.
                simulation.restore(state)
            except (CheckpointError, InputError) as error:
                _log.warning("the checkpoint in %s cannot be used: %s", previous.url, error)
                continue
            self._tell("log", {"text": f"goes on from the checkpoint of step {checkpoint.step}"})
            return writer
        return None

    def _checkpoint(self, simulation: Simulation) -> None:
        assert self._writer is not None
        self._writer.checkpoint({**simulation.state(), _MADE_BY: _maker()})
        self._tell("checkpoint", {"step": self._writer.expected_step - 1})

    def _place(self, attempt: int) -> Place:
        return attempt_place(self._store, self._run, attempt)

    def _wait(self) -> None:
        self._due = time.monotonic() + self._order.limits.checkpoint_seconds

    def _tell(self, kind: str, data: dict[str, Any]) -> None:
        self._send((kind, self._run, data))


def _maker() -> Any:
    return np.frombuffer(studies.source_digest().encode(), dtype=np.uint8)


def _is_ours(checkpoint: Checkpoint) -> bool:
    """Whether this very source made it: another one's state may mean something else."""
    made_by = checkpoint.state.get(_MADE_BY)
    return made_by is not None and bytes(made_by) == bytes(_maker())
