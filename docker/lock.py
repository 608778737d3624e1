"""Makes the lock files anew, with pip, from pyproject.toml: python3.11 docker/lock.py

Each names every package and the one file of it that the image installs, by hash: for CPython 3.11
on linux x86_64, where it has to be run. `docker/check.sh` proves that they suffice.
"""

from __future__ import annotations

import json
import platform
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
HEADER = """\
# {purpose}, for CPython 3.11 on linux x86_64.
# Made by `python3.11 docker/lock.py` from pyproject.toml: do not edit.
"""


def resolve(requirements: Sequence[str]) -> list[str]:
    """What pip would install for requirements, a line with version and hash each, sorted."""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--dry-run", "--report", "-"]
    command += ["--ignore-installed", "--only-binary", ":all:", *requirements]
    answer = subprocess.run(command, check=True, stdout=subprocess.PIPE)
    report: dict[str, Any] = json.loads(answer.stdout)
    return sorted(_line(item) for item in report["install"])


def _line(item: dict[str, Any]) -> str:
    name = item["metadata"]["name"].lower().replace("_", "-")
    digest = item["download_info"]["archive_info"]["hashes"]["sha256"]
    return f"{name}=={item['metadata']['version']} --hash=sha256:{digest}"


def main() -> None:
    """Writes both files."""
    here = (sys.version_info[:2], sys.platform, platform.machine())
    if here != ((3, 11), "linux", "x86_64"):
        raise SystemExit("Run it with CPython 3.11 on linux x86_64, which the image has.")
    project = tomllib.loads((HERE.parent / "pyproject.toml").read_text(encoding="utf-8"))
    for name, purpose, requirements in (
        ("requirements.lock", "What trainbridge needs", project["project"]["dependencies"]),
        ("build.lock", "What builds the wheel", project["build-system"]["requires"]),
    ):
        lines = resolve(requirements)
        text = HEADER.format(purpose=purpose) + "\n".join(lines) + "\n"
        (HERE / name).write_text(text, encoding="utf-8")
        print(f"{name}: {len(lines)} packages")


if __name__ == "__main__":
    main()
