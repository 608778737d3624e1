"""What Dockerfile and compose file must keep to; each rule a line, the first that fails ends it.

python docker/checks/files.py
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from compose import MissingVariableError, Service, read_compose
from dockerfile import Stage, read_dockerfile

DOCKER = Path(__file__).parents[1]
SECRETS = {
    "TRAINBRIDGE_TOKEN": "a-token-of-the-check-only",
    "POSTGRES_PASSWORD": "p@ss/word:of%the check",
    "STORE_SECRET_KEY": "a-key-of-the-check-only",
}
"""Variables that have to be set; the password holds what a URL could not."""
OURS = {"web", "coordinator", "scheduler", "worker", "prepare"}
USER = "10001:10001"


def read_files(**changes: str | None) -> tuple[list[Stage], dict[str, Any]]:
    """Both files, with every secret set but for ``changes``."""
    stages = read_dockerfile(DOCKER / "Dockerfile")
    given = {name: text for name, text in {**SECRETS, **changes}.items() if text is not None}
    return stages, read_compose(DOCKER / "compose.yaml", given, stages[-1])


def require(holds: bool, rule: str) -> None:
    """Says a rule that holds, and ends with one that does not."""
    if not holds:
        raise SystemExit(f"  BROKEN  {rule}")
    print(f"  {rule}")


def check_dockerfile(stages: list[Stage]) -> None:
    """Rules of the image."""
    last = stages[-1]
    tags = [stage.image for stage in stages]
    pinned = all(re.fullmatch(r"python:3\.11\.\d+-slim-\w+", tag) for tag in tags)
    require(pinned and len(set(tags)) == 1, f"each stage begins with {tags[0]}, a full version")
    require(last.last("USER").rest == USER, f"it runs as {USER}, not as root")
    require(last.last("ENTRYPOINT").exec_form == ["trainbridge"], "SIGTERM reaches trainbridge")
    require(last.last("STOPSIGNAL").rest == "SIGTERM", "it is asked to stop by SIGTERM")
    health = last.last("HEALTHCHECK").rest
    require(health.split()[0] == "CMD" and health.endswith('"web"]'), "it has a health check")
    require(last.last("VOLUME").words == ["/data"], "/data is a volume")
    builds = re.compile(r"\b(apt-get|gcc|pip install|make)\b")
    runs = " ".join(item.rest for item in last.all("RUN"))
    require(not builds.search(runs), "the last stage builds and installs nothing")
    parts = [
        part for stage in stages[:-1] for item in stage.all("RUN") for part in item.rest.split("&&")
    ]
    installs = [part for part in parts if "pip" in part and " install " in part]
    exact = all("--require-hashes" in part or "--no-index" in part for part in installs)
    require(exact and len(installs) == 3, "packages come by hash, from the lock files only")
    copied = [word for stage in stages for item in stage.all("COPY") for word in item.words]
    require("." not in copied, "only what is named is copied")


def check_compose(document: dict[str, Any]) -> None:
    """Rules of the services."""
    services: dict[str, Service] = document["services"]
    require({name for name, item in services.items() if item.ours} == OURS, "five are ours")
    others = [item.given["image"] for item in services.values() if not item.ours]
    pinned = all(re.search(r":v?\d+\.\d+[\w.-]*$", tag) for tag in others)
    require(pinned, f"images of others have full versions: {', '.join(others)}")
    publishing = {
        name: item.given["ports"] for name, item in services.items() if "ports" in item.given
    }
    require(publishing == {"web": ["127.0.0.1:8000:8000"]}, "only web publishes, on loopback")
    outside = {
        name for name, network in document["networks"].items() if not network.get("internal")
    }
    there = [
        name for name, item in services.items() if outside & set(item.given.get("networks", ()))
    ]
    require(
        there == ["web"] and outside == {"front"}, "only web is in a network that leads outside"
    )
    for name, item in services.items():
        check_service(name, item)
    workers = services["worker"].given["deploy"]["replicas"]
    require(workers == "2", "two workers, where TRAINBRIDGE_WORKERS says nothing else")
    users = {item.given.get("user", USER).split(":")[0] for item in services.values()}
    require("0" not in users and "root" not in users, "nobody is root")


def check_service(name: str, item: Service) -> None:
    """Rules of each service."""
    given = item.given
    confined = (
        given["read_only"] is True
        and given["cap_drop"] == ["ALL"]
        and given["security_opt"] == ["no-new-privileges:true"]
        and "privileged" not in given
        and (item.ours or "user" in given)
    )
    rule = f"{name}: read-only, no capability, no new privileges, no root"
    if name == "prepare":
        require(confined and given["network_mode"] == "none", f"{rule}, no network, once")
        return
    limits = given["deploy"]["resources"]["limits"]
    kept = (
        {"memory", "cpus", "pids"} == set(limits)
        and bool(item.health_command)
        and "stop_grace_period" in given
        and given["restart"] == "unless-stopped"
    )
    require(confined and kept, f"{rule}, limits, health check, restarted, time to stop")


def check_secrets() -> None:
    """Compose refuses to start without each secret, and with an empty one."""
    for name in SECRETS:
        for given in (None, ""):
            try:
                read_files(**{name: given})
            except MissingVariableError as error:
                said = str(error)
            else:
                said = ""
            state = "missing" if given is None else "empty"
            require(said.startswith(f"{name}: set {name}"), f"{name} {state}: refused")


def main() -> None:
    """Checks both files."""
    stages, document = read_files()
    check_dockerfile(stages)
    check_compose(document)
    check_secrets()


if __name__ == "__main__":
    main()
