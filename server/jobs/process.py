"""Child processes: how they start, and how they never outlive their supervisor.

Children come from a forkserver that has numpy and the solver loaded already, so that one starts in
milliseconds. The forkserver's environment holds one BLAS thread a process: the same run gives the
same bits again.
"""

from __future__ import annotations

import ctypes
import faulthandler
import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any

import psutil

from server.jobs.environment import FORKSERVER_OF, SINGLE_THREAD
from server.jobs.orders import Commands, Order

__all__ = [
    "STOPPED",
    "BatchProcess",
    "StoppedError",
    "child_context",
    "end_forkserver",
    "end_with_parent",
]

STOPPED = 143
"""Exit code of a process that ended because it was asked to, as of SIGTERM."""

_PRELOAD = ["server.jobs.preload"]
_STOP = "stop"
"""The command to end; the others are tuples of runs to leave out."""
_PARENT_DEATH_SIGNAL = 1
"""PR_SET_PDEATHSIG of linux/prctl.h."""
_FAREWELL = 1.0
"""Time that a forkserver takes to end, at most. [s]"""
_start = threading.RLock()
"""Held while a child starts: the forkserver must not be ended just then."""


class StoppedError(BaseException):
    """The process was asked to end: no ``Exception``, so that nothing takes it for a failure."""


def child_context() -> Any:
    """The way to start processes: forkserver where there is one, else spawn."""
    methods = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if "forkserver" in methods:
        context.set_forkserver_preload(_PRELOAD)
        _ensure_forkserver()
    return context


def end_forkserver() -> None:
    """Frees the forkserver's memory where it has no child; the next child starts another one."""
    with _start:
        for process in psutil.Process().children():
            try:
                if "forkserver" in " ".join(process.cmdline()) and not process.children():
                    _end(process)
            except psutil.Error:
                continue


def _end(forkserver: psutil.Process) -> None:
    """Not waited for: multiprocessing itself takes note of its end, when it needs another one."""
    forkserver.kill()
    limit = time.monotonic() + _FAREWELL
    while forkserver.status() != psutil.STATUS_ZOMBIE and time.monotonic() < limit:
        time.sleep(0.005)


def end_with_parent() -> None:
    """Ends this process when its parent goes away, even inside a factorisation."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def wait() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait, name="lifeline", daemon=True).start()


class BatchProcess:
    """One batch in its own process.

    Attributes:
        messages: What the batch tells.
        errors: What it and its libraries write to the terminal: read the descriptor itself.
    """

    def __init__(self, order: Order) -> None:
        """Starts the process."""
        with _start:
            self._begin(order)
        # Asked for often: the library's object is kept. Its number is not reused meanwhile.
        self._watched = _watched(self.pid)

    def _begin(self, order: Order) -> None:
        context = child_context()
        self.messages, child_messages = context.Pipe(duplex=False)
        self.errors, child_errors = context.Pipe(duplex=False)
        child_commands, self._commands = context.Pipe(duplex=False)
        self._process = context.Process(
            target=_child,
            args=(child_messages, child_errors, child_commands, order),
            name="trainbridge batch",
            daemon=True,
        )
        self._process.start()
        for end in (child_messages, child_errors, child_commands):
            end.close()

    @property
    def sentinel(self) -> int:
        """Ready when the process has ended."""
        return self._process.sentinel

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._process.pid or 0

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process.is_alive()

    @property
    def exit_code(self) -> int | None:
        """As of ``multiprocessing``: negative for a signal."""
        return self._process.exitcode

    def memory(self) -> int:
        """Resident memory, 0 when the process has ended. [B]"""
        try:
            return 0 if self._watched is None else self._watched.memory_info().rss
        except psutil.Error:
            return 0

    def cancel(self, runs: tuple[str, ...]) -> None:
        """Asks the process to leave out some runs, at their next step."""
        try:
            self._commands.send(runs)
        except OSError:
            return  # It has ended.

    def terminate(self) -> None:
        """Asks the process to end; also one that has just begun and does not take signals yet."""
        try:
            self._commands.send(_STOP)
        except OSError:
            return  # It has ended.

    def kill(self) -> None:
        """Ends the process."""
        self._process.kill()

    def close(self) -> None:
        """Ends the process if it runs, and frees what it held."""
        if self._process.is_alive():
            self._process.kill()
        self._process.join()
        for end in (self.messages, self.errors, self._commands):
            end.close()
        self._process.close()


def _watched(pid: int) -> psutil.Process | None:
    """A process to be looked at, None where it has ended already."""
    try:
        return psutil.Process(pid)
    except psutil.Error:
        return None


def _child(messages: Connection, errors: Connection, commands: Connection, order: Order) -> None:
    """Computes a batch and tells how it ended: ``("failed" | "out_of_memory", "", {"error"})``, or
    nothing more after the runs' own messages."""
    end_with_parent()
    _end_with_forkserver()
    _write_to(errors)
    # A library's lock (numcodecs has one) is then nameless and dies with this process, however it
    # ends; this process starts no other.
    multiprocessing.set_start_method("fork", force=True)
    # The pages stay quick while every core computes.
    os.nice(5)
    # Here, not above: a supervisor on a cluster's worker needs neither solver nor store.
    from server.store import StoreError
    from solver.errors import SolverError

    try:
        order.compute(order, messages.send, _listen(commands))
    except StoppedError:
        os._exit(STOPPED)
    except (SolverError, StoreError) as error:
        messages.send(("failed", "", {"error": str(error)}))
    except MemoryError:
        text = "There was not enough memory. Try a coarser mesh."
        messages.send(("out_of_memory", "", {"error": text}))
    except Exception as error:
        traceback.print_exc(file=sys.stderr)
        text = f"The computation met an unexpected error ({type(error).__name__}: {error})."
        messages.send(("failed", "", {"error": text[:1000]}))
    finally:
        messages.close()


def _end_with_forkserver() -> None:
    """Lets the system end this process with its forkserver, which ends with the server.

    The lifeline is a thread, and some library calls keep every thread waiting.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)


def _write_to(errors: Connection) -> None:
    """Sends what this process prints, its libraries' last words too, to the supervisor."""
    for stream in (1, 2):
        os.dup2(errors.fileno(), stream)
    faulthandler.enable(all_threads=False)


def _listen(commands: Connection) -> Commands:
    """Takes the supervisor's commands from its pipe and from SIGTERM."""
    asked = Commands()

    def read() -> None:
        while True:
            try:
                command = commands.recv()
            except (EOFError, OSError):
                return
            if command == _STOP:
                os.kill(os.getpid(), signal.SIGTERM)
            else:
                asked.cancelled.update(command)

    def stop(number: int, frame: FrameType | None) -> None:
        if asked.stop:
            return  # Once is enough: it is ending.
        asked.stop = True
        if not asked.stepping:
            raise StoppedError

    # Ctrl-C in the terminal reaches every process of the group: the supervisor decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, stop)
    threading.Thread(target=read, name="commands", daemon=True).start()
    return asked


def _ensure_forkserver() -> None:
    """Starts the forkserver with the children's environment, leaving this process's as it is."""
    from multiprocessing.forkserver import ensure_running

    given = {**SINGLE_THREAD, FORKSERVER_OF: str(os.getpid())}
    with _start:
        before = {name: os.environ.get(name) for name in given}
        os.environ.update(given)
        try:
            ensure_running()
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
