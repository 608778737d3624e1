"""The wheel carries the page: built, installed elsewhere, served from there."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel's contents, installed by pip without its dependencies."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder)]
    subprocess.run([*build, str(ROOT)], check=True, capture_output=True, text=True)
    (wheel,) = folder.glob("trainbridge-*.whl")
    target = folder / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(target)]
    subprocess.run([*pip, str(wheel)], check=True, capture_output=True, text=True)
    return target


@pytest.fixture
def address(installed: Path, tmp_path: Path) -> Iterator[str]:
    """A server started from the installed wheel, away from the repository."""
    environment = {**os.environ, "PYTHONPATH": str(installed), "PYTHONUNBUFFERED": "1"}
    command = [sys.executable, "-m", "server", "serve", "--port", "0", "--data", "data"]
    with subprocess.Popen(
        command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            found = re.search(r"http://127\.0\.0\.1:\d+", line)
            if found:
                break
        else:
            pytest.fail("the server did not say where it listens")
        try:
            yield found.group()
        finally:
            process.terminate()
            process.wait(timeout=180)


def test_wheel_holds_page_and_data_and_nothing_else(installed: Path) -> None:
    (wheel,) = installed.parent.glob("trainbridge-*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert "server/static/index.html" in names
    assert "server/viewer/client/colours.mjs" in names
    assert "solver/data/khst.json" in names
    assert not [name for name in names if "node_modules" in name or name.startswith("tests")]


def test_installed_server_serves_page_and_templates(address: str) -> None:
    with httpx.Client(base_url=address, timeout=120) as client:
        page = client.get("/")
        assert page.status_code == 200
        for reference in re.findall(r'(?:src|href)="(/static/[^"]+)"', page.text):
            assert client.get(reference).status_code == 200, reference
        names = [item["name"] for item in client.get("/api/v1/templates").json()["items"]]
        assert "khst-alverca" in names
