"""Child processes: how they start, and how they never outlive their server.

Children come from a forkserver that has numpy and the solver loaded already, so that one starts in
milliseconds. The forkserver's environment holds one BLAS thread a process and MKL's repeatable
code path: the same run gives the same bits again.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

import psutil

from server.jobs.environment import SINGLE_THREAD, single_threaded
from server.jobs.worker import Send, Task
from solver.errors import SolverError

__all__ = ["BatchProcess", "Compute", "child_context", "end_with_parent"]

Compute = Callable[[Task, Send], None]
"""Computes a batch in its own process; a function of a module, so that it can be named."""

_PRELOAD = ["server.jobs.preload"]
_start = threading.Lock()


def child_context() -> Any:
    """The way to start processes: forkserver where there is one, else spawn."""
    methods = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if "forkserver" in methods:
        context.set_forkserver_preload(_PRELOAD)
        _ensure_forkserver()
    return context


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
    """One batch in its own process."""

    def __init__(self, task: Task, compute: Compute) -> None:
        """Starts the process."""
        context = child_context()
        self.connection, child_end = context.Pipe(duplex=False)
        self._process = context.Process(
            target=_child, args=(child_end, task, compute), name="trainbridge batch", daemon=True
        )
        self._process.start()
        child_end.close()

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
            return psutil.Process(self.pid).memory_info().rss
        except psutil.Error:
            return 0

    def terminate(self) -> None:
        """Asks the process to end."""
        self._process.terminate()

    def kill(self) -> None:
        """Ends the process."""
        self._process.kill()

    def close(self) -> None:
        """Ends the process if it runs, and frees what it held."""
        if self._process.is_alive():
            self._process.kill()
        self._process.join()
        self.connection.close()
        self._process.close()


def _child(connection: Connection, task: Task, compute: Compute) -> None:
    """Computes a batch and tells how it ended: ``("failed" | "out_of_memory", text)``, or nothing
    more after the runs' own messages."""
    end_with_parent()
    # Ctrl-C in the terminal reaches every process of the group: the server decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    # A library's lock (numcodecs has one) is then nameless and dies with this process, however it
    # ends; this process starts no other.
    multiprocessing.set_start_method("fork", force=True)
    # The pages stay quick while every core computes.
    os.nice(5)
    try:
        compute(task, connection.send)
    except SolverError as error:
        connection.send(("failed", str(error)))
    except MemoryError:
        connection.send(("out_of_memory", "There was not enough memory. Try a coarser mesh."))
    except Exception as error:
        traceback.print_exc(file=sys.stderr)
        text = f"The computation met an unexpected error ({type(error).__name__}: {error})."
        connection.send(("failed", text[:1000]))
    finally:
        connection.close()


def _ensure_forkserver() -> None:
    """Starts the forkserver with the children's environment, leaving this process's as it is."""
    from multiprocessing.forkserver import ensure_running

    with _start:
        before = {name: os.environ.get(name) for name in SINGLE_THREAD}
        single_threaded()
        try:
            ensure_running()
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
