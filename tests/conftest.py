"""Rules for the whole suite: one thread per library, repeatable arithmetic, no silent skip."""

from __future__ import annotations

import os

# Before numpy is imported anywhere: results must not depend on the number of cores.
for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import pytest  # noqa: E402 (the environment comes first)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Stored answers of the API change only where that is asked for."""
    parser.addoption(
        "--update-snapshots",
        action="store_true",
        help="write tests/js/snapshots anew where an answer of the API changed",
    )


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Fails the session when a test was skipped and ``TRAINBRIDGE_NO_SKIP`` is set (CI)."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    skipped = [] if reporter is None else reporter.stats.get("skipped", [])
    if os.environ.get("TRAINBRIDGE_NO_SKIP") and skipped and exitstatus == 0:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
        reporter.write_line(f"{len(skipped)} skipped: no test may be skipped here", red=True)
