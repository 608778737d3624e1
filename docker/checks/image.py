"""Carries out the Dockerfile in a folder, without Docker: what its build stage copies and runs, and
what the last stage copies. Its absolute paths lie below the folder; the rest is word for word.

python docker/checks/image.py FOLDER
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from dockerfile import Instruction, Stage, read_dockerfile
from files import DOCKER

_PLACES = re.compile(r"(?<![\w./-])/(?=opt|source|data|certificates|store|tmp/matplotlib)")
"""Absolute paths of the image that the check has below its folder."""
_EXTRA = """
import json
from importlib.metadata import distributions
from packaging.requirements import Requirement
wanted, needs = ["trainbridge"], {}
for item in distributions():
    name = item.metadata["Name"].lower().replace("_", "-")
    needs[name] = [Requirement(text) for text in item.requires or ()]
seen = set()
while wanted:
    name = wanted.pop()
    if name in needs and name not in seen:
        seen.add(name)
        wanted += [need.name.lower().replace("_", "-") for need in needs[name]]
print(json.dumps(sorted(set(needs) - seen)))
"""


def below(folder: Path, text: str) -> str:
    """A text of the image with its paths below the folder."""
    return _PLACES.sub(f"{folder}/", text)


def build(folder: Path, stages: list[Stage]) -> None:
    """Carries out every stage; RUN only where it builds, as the last one makes users."""
    for stage in stages:
        workdir = folder
        environment = {**os.environ, **stage.environment}
        # Other runs of the check may have downloaded the same files.
        environment.pop("PIP_NO_CACHE_DIR", None)
        environment["PATH"] = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        for item in stage.instructions:
            if item.name == "WORKDIR":
                workdir = Path(below(folder, item.rest))
                workdir.mkdir(parents=True, exist_ok=True)
            elif item.name == "COPY":
                _copy(item, folder, workdir)
            elif item.name == "RUN" and stage.name == "build":
                print(f"  RUN {item.rest[:100]}", flush=True)
                subprocess.run(
                    ["sh", "-c", below(folder, item.rest)], check=True, cwd=workdir, env=environment
                )


def _copy(item: Instruction, folder: Path, workdir: Path) -> None:
    *sources, target = item.words
    if "from" in item.flags:
        if sources != [target]:
            raise SystemExit(f"line {item.line}: an environment only works where it was made")
        return
    destination = workdir / below(folder, target)
    for source in sources:
        found = DOCKER.parent / source
        if found.is_dir():
            shutil.copytree(found, destination, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            inside = len(sources) > 1 or target.endswith("/")
            goal = destination / found.name if inside else destination
            goal.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(found, goal)


def check_ignore_file(stages: list[Stage]) -> None:
    """Everything that is copied reaches the builder past the ignore file."""
    lines = (DOCKER / "Dockerfile.dockerignore").read_text(encoding="utf-8").splitlines()
    allowed = {line[1:] for line in lines if line.startswith("!")}
    copied = {
        word
        for stage in stages
        for item in stage.all("COPY")
        if "from" not in item.flags
        for word in item.words[:-1]
    }
    if lines[1] != "*" or allowed != copied:
        raise SystemExit(f"Dockerfile.dockerignore lets through {sorted(allowed ^ copied)}")


def check_lock(folder: Path) -> None:
    """The lock file has no package that trainbridge does not need, and no address."""
    lock = (DOCKER / "requirements.lock").read_text(encoding="utf-8")
    if "://" in lock or "--index" in lock:
        raise SystemExit("requirements.lock names an index")
    answer = subprocess.run(
        [folder / "opt/trainbridge/bin/python", "-c", _EXTRA], check=True, stdout=subprocess.PIPE
    )
    extra = json.loads(answer.stdout)
    if extra:
        raise SystemExit(f"requirements.lock has packages that nothing needs: {extra}")


def main() -> None:
    """Builds, and checks what came out."""
    folder = Path(sys.argv[1])
    stages = read_dockerfile(DOCKER / "Dockerfile")
    check_ignore_file(stages)
    try:
        build(folder, stages)
    except subprocess.CalledProcessError as error:
        raise SystemExit(
            f"  BROKEN  {str(error)[:300]}\n  Where the lock files do not fit pyproject.toml any "
            "more: python3.11 docker/lock.py"
        ) from None
    check_lock(folder)
    packages = (DOCKER / "requirements.lock").read_text(encoding="utf-8").count("==")
    print(f"  {packages} packages by hash, none too few (pip check) and none too many")
    shutil.rmtree(folder / "source")


if __name__ == "__main__":
    main()
