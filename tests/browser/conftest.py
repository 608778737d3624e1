"""A real server and a real Chromium for the browser tests.

Pictures go to ``$TRAINBRIDGE_SCREENSHOTS`` where it is set, else to pytest's temporary folder.
"""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.browser.waiting import LAUNCH_MS, patient, patient_expectations, until

ROOT = Path(__file__).parents[2]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
PACKAGES = "apt-get install chromium fonts-dejavu-core libegl1 libegl-mesa0 libgl1-mesa-dri"
START_SECONDS = 120.0
STOP_SECONDS = 60.0
MESA = ("--no-sandbox", "--use-angle=gl-egl", "--ignore-gpu-blocklist")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """All are slow; without Chromium they are skipped, and say how to get it."""
    here = Path(__file__).parent
    for item in items:
        if here not in item.path.parents:
            continue
        item.add_marker(pytest.mark.slow)
        if CHROMIUM is None:
            item.add_marker(pytest.mark.skip(reason=f"Chromium is missing: {PACKAGES}"))


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _wait_until_up(address: str, process: subprocess.Popen[bytes]) -> None:
    def answers() -> bool:
        assert process.poll() is None, "the server ended before it answered"
        try:
            with urllib.request.urlopen(f"{address}/api/v1/meta", timeout=START_SECONDS):
                return True
        except OSError:  # refused, reset, or not within the time
            return False

    until(answers, "an answer of the server", seconds=START_SECONDS)


@contextmanager
def running_server(data: Path, port: int) -> Generator[str]:
    """A server of its own process on a data folder; gives its address.

    Args:
        data: The data folder.
        port: Where it listens.
    """
    command = [sys.executable, "-m", "server", "serve", "--host", "127.0.0.1"]
    command += ["--port", str(port), "--data", str(data)]
    log = (data / "server.log").open("ab")
    process = subprocess.Popen(command, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT)
    address = f"http://127.0.0.1:{port}"
    try:
        _wait_until_up(address, process)
        yield address
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        log.close()


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a server that holds no jobs at first."""
    with running_server(tmp_path_factory.mktemp("data"), _free_port()) as address:
        yield address


@pytest.fixture
def another_server(tmp_path: Path) -> Callable[[], AbstractContextManager[str]]:
    """Starts a server that may be stopped and started again: same data, same address."""
    data, port = tmp_path, _free_port()
    return lambda: running_server(data, port)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    """One browser for each file: two drivers of Playwright cannot run at once."""
    from playwright.sync_api import sync_playwright

    patient_expectations()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=list(MESA), timeout=LAUNCH_MS
        )
        yield browser
        browser.close()


def _note(errors: list[str], error: str) -> None:
    """Keeps an error; viser's page tries to evaluate a string, is refused, and goes on."""
    if not error.startswith("Evaluating a string as JavaScript"):
        errors.append(error)


@pytest.fixture
def new_page(chromium: Any, server: str) -> Iterator[Callable[..., Any]]:
    """Opens pages; afterwards no page may have met an error of its own."""
    contexts: list[Any] = []
    errors: list[str] = []

    def open_page(*, viewer: bool = False, **options: Any) -> Any:
        context = patient(chromium.new_context(base_url=server, **options))
        contexts.append(context)
        if not viewer:  # The 3D view is heavy, and these tests are not about it.
            context.route(
                "**/viewer/*/",
                lambda route: route.fulfill(content_type="text/html", body="<p>3D view</p>"),
            )
        page = context.new_page()
        page.on("pageerror", lambda error: _note(errors, str(error)))
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert errors == []


@pytest.fixture
def page(new_page: Callable[..., Any]) -> Any:
    """One page of a usual size."""
    return new_page(viewport={"width": 1280, "height": 860})


@pytest.fixture(scope="session")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Any, str], None]:
    """Takes a picture of a page, for people to look at."""
    asked = os.environ.get("TRAINBRIDGE_SCREENSHOTS")
    folder = Path(asked) if asked else tmp_path_factory.mktemp("pictures")
    folder.mkdir(parents=True, exist_ok=True)

    def take(page: Any, name: str) -> None:
        page.screenshot(path=str(folder / f"{name}.png"), full_page=True)

    return take
