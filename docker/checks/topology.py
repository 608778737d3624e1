"""Runs compose.yaml's services as processes on loopback, and a study through them.

Commands, health checks and variables are those of the file; only addresses and folders are
replaced. PostgreSQL is Debian's, and `moto` stands for the object store.

python docker/checks/topology.py FOLDER, where image.py has built
"""

from __future__ import annotations

import json
import os
import re
import signal
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from urllib.parse import quote

from compose import Service
from files import OURS, SECRETS, read_files
from image import below
from processes import CheckError, Process, free_port, object_store, postgresql, run, until

SPEEDS = (25.0, 30.0, 35.0)
"""Of the sweep. [m/s]"""
CHANNEL = "mid-span 1/displacement"
TIME_STEP = 1e-4
"""Small, so that a run takes seconds. [s]"""
START_SECONDS = 40.0
JOB_SECONDS = 90.0
STOP_SECONDS = 15.0


class Topology:
    """The services, started one by one as ``depends_on`` has it."""

    def __init__(self, folder: Path, services: Mapping[str, Service]) -> None:
        """Starts nothing yet."""
        self.folder = folder
        self.services = services
        self.processes: list[Process] = []
        self.addresses = {
            name: f"127.0.0.1:{free_port()}" for name in ("scheduler:8786", "web:8000")
        }
        self.health: list[tuple[Process, list[str], dict[str, str]]] = []

    @property
    def url(self) -> str:
        """Of the web service."""
        return f"http://{self.addresses['web:8000']}"

    def start(self, name: str, number: int = 0) -> None:
        """Starts one container's process."""
        service = self.services[name]
        label = f"{name}-{number}" if number else name
        environment = self.environment(service)
        # Folders of its own, as a container has them.
        environment["TRAINBRIDGE_DATA"] += f"-{label}"
        process = Process(label, self.here(service.command, name), environment, self.folder)
        self.processes.append(process)
        check = self.here(service.health_command, name)
        if "connected" in check:
            check += ["--of", str(process.pid)]
        self.health.append((process, check, environment))

    def replace(self, label: str) -> None:
        """Kills a container's processes, and starts it again as Docker does."""
        place = next(i for i, process in enumerate(self.processes) if process.name == label)
        self.processes[place].kill()
        name, _, number = label.partition("-")
        self.start(name, int(number))
        self.processes[place] = self.processes.pop()
        self.health[place] = self.health.pop()

    def environment(self, service: Service) -> dict[str, str]:
        """A service's variables, with addresses and folders of this machine, and no others."""
        own = {key: self.address(text) for key, text in service.environment.items()}
        own = {key: below(self.folder, text) for key, text in own.items()}
        own["PATH"] = f"{own['PATH']}:{os.environ['PATH']}"
        return {"HOME": str(self.folder), "LANG": "C.UTF-8", **own}

    def here(self, command: list[str], name: str) -> list[str]:
        """A service's command, with addresses, ports and folders of this machine."""
        given = [below(self.folder, self.address(word)) for word in command]
        program = self.folder / "opt/trainbridge/bin" / given[0]
        given[0] = str(program) if program.exists() else given[0]
        given = ["127.0.0.1" if word == "0.0.0.0" else word for word in given]
        ports = {
            address.split(":")[1]: own.split(":")[1] for address, own in self.addresses.items()
        }
        given = [ports.get(word, word) for word in given]
        # In a container the usual port is free.
        usual = {"web": "8000", "scheduler": "8786"}.get(name)
        if usual is not None and ports[usual] not in given:
            given += ["--port", ports[usual]]
        return given

    def address(self, text: str) -> str:
        """A text with the services' addresses replaced."""
        for address, own in self.addresses.items():
            text = re.sub(rf"\b{address}\b", own, text)
        return text

    def well(self) -> bool:
        """Whether every health check of what was started says so."""
        for process, check, environment in self.health:
            process.require_alive()
            try:
                run(check, environment)
            except CheckError:
                return False
        return True

    def stop(self) -> None:
        """Ends all as Compose does: those first that depend on others, each by SIGTERM alone."""
        for process in reversed(self.processes):
            begin = time.monotonic()
            process.terminate()
            status = process.wait(STOP_SECONDS)
            if status not in (0, -signal.SIGTERM):
                raise CheckError(f"{process.name} ended with {status}:\n{process.tail()}")
            say(f"{process.name} has ended {time.monotonic() - begin:.1f} s after SIGTERM")


def say(text: str) -> None:
    """One line of what is done."""
    print(f"  {text}", flush=True)


def ask(topology: Topology, path: str, token: str) -> bytes:
    """An answer of the API."""
    request = urllib.request.Request(f"{topology.url}/api/v1{path}")
    if token:
        request.add_header("Authorization", f"Bearer {token}")
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(request, timeout=30) as answer:
        return answer.read()


def prepare(topology: Topology) -> None:
    """Runs the service that comes first, twice: the second time it leaves all as it is."""
    service = topology.services["prepare"]
    for place in ("certificates", "store", "tmp"):
        (topology.folder / place).mkdir(exist_ok=True)
    command = topology.here(service.command, "prepare")
    environment = topology.environment(service)
    say(f"prepare: {run(command, environment).strip()}")
    certificate = topology.folder / "certificates/certificate.pem"
    before = certificate.read_bytes()
    run(command, environment)
    if certificate.read_bytes() != before:
        raise CheckError("prepare replaced a valid certificate")
    key = topology.folder / "certificates/key.pem"
    if key.stat().st_mode & 0o077:
        raise CheckError("the key can be read by others")
    bucket = re.match(r"s3://(\w+)", topology.services["web"].environment["TRAINBRIDGE_STORE"])
    if bucket is None or not (topology.folder / "store" / bucket[1]).is_dir():
        raise CheckError("the bucket that prepare makes is not the one that web uses")


def check_commands(topology: Topology) -> None:
    """Every command has help, the settings can be read, and web refuses to listen without token."""
    web = topology.services["web"]
    environment = topology.environment(web)
    program = str(topology.folder / "opt/trainbridge/bin/trainbridge")
    for service in (topology.services[name] for name in sorted(OURS - {"prepare"})):
        command = topology.here(service.command, service.name)
        run([*command[:2], "--help"], environment)
        shown = json.loads(run([program, "config", "--json"], topology.environment(service)))
        secrets = [text for text in SECRETS.values() if text in json.dumps(shown)]
        if secrets:
            raise CheckError(f"`trainbridge config` of {service.name} shows a secret")
    say("every command is there, and every variable is a setting (trainbridge config)")
    environment.pop("TRAINBRIDGE_TOKEN")
    try:
        run([program, *web.command[1:]], environment)
    except CheckError as error:
        if "TRAINBRIDGE_TOKEN" not in str(error):
            raise
        say("web refuses to listen to the network without a token")
    else:
        raise CheckError("web listens to the network without a token")


def check_study(topology: Topology, token: str) -> None:
    """A sweep of three speeds from `trainbridge submit` to curves, past a worker's death."""
    program = str(topology.folder / "opt/trainbridge/bin/trainbridge")
    base = topology.environment(topology.services["web"])
    client = {name: base[name] for name in ("HOME", "LANG", "PATH", "TRAINBRIDGE_TOKEN")}
    client["TRAINBRIDGE_SERVER"] = topology.url
    study = json.loads(run([program, "templates", "sprung-mass-beam"], client))
    study["sweep"]["speeds"] = list(SPEEDS)
    study["integration"]["time_step"] = TIME_STEP
    file = topology.folder / "study.json"
    file.write_text(json.dumps(study), encoding="utf-8")
    begin = time.monotonic()
    job = run([program, "submit", str(file)], client).strip()

    def states() -> list[str]:
        for process in topology.processes:
            process.require_alive()
        found = json.loads(ask(topology, f"/jobs/{job}", token))
        return [*(item["state"] for item in found["runs"]), found["state"]]

    # With the job's own state; a killed worker is started again, and what it computed too.
    until("two runs at once", lambda: states().count("running") == 3, JOB_SECONDS)
    topology.replace("worker-1")
    until("the job", lambda: states()[-1] not in ("queued", "running"), JOB_SECONDS)
    if set(states()) != {"done"}:
        log = ask(topology, f"/jobs/{job}/log", token).decode()
        raise CheckError(f"the runs and the job are {states()}:\n{log}")
    found = json.loads(ask(topology, f"/jobs/{job}", token))
    attempts = [item["attempt"] for item in found["runs"]]
    if sum(attempts) <= len(attempts):
        raise CheckError("a worker was killed, but no run was lost")
    shown = ", ".join(map(str, attempts))
    say(f"{len(attempts)} runs done {time.monotonic() - begin:.1f} s after `trainbridge submit`")
    say(f"one lost its worker to kill -9 on the way: attempts {shown}")
    check_results(topology, token, job, found["runs"])


def check_results(topology: Topology, token: str, job: str, runs: list[Mapping[str, Any]]) -> None:
    """The gather's summary, verdicts and a channel of each run."""
    summary = json.loads(ask(topology, f"/jobs/{job}/summary", token))
    speeds = sorted(run["parameters"]["speed"] for run in summary["runs"])
    if speeds != sorted(SPEEDS) or summary["judged"] != len(SPEEDS):
        raise CheckError(f"the gather's summary is {json.dumps(summary)[:500]}")
    verdicts = json.loads(ask(topology, f"/jobs/{job}/verdicts", token))["items"]
    say(f"the gather has summed up {len(speeds)} runs, {len(verdicts)} verdicts")
    lowest = [check_channel(topology, token, item["id"]) for item in runs]
    shown = ", ".join(f"{1e3 * value:.3f}" for value in lowest)
    say(f"{CHANNEL} as CSV: lowest {shown} mm")


def check_channel(topology: Topology, token: str, identifier: str) -> float:
    """A run's curve through the API; gives its lowest value. [m]"""
    path = f"/runs/{identifier}/channels/{quote(CHANNEL)}.csv"
    _, *rows = ask(topology, path, token).decode().strip().splitlines()
    lowest = min(float(row.split(",")[1]) for row in rows)
    # The beam of the template bends by 2 to 3 mm under the mass at every speed.
    if len(rows) < 1000 or not -5e-3 < lowest < -1e-3:
        raise CheckError(f"{CHANNEL}: {len(rows)} rows, lowest {lowest:g}")
    return lowest


def check_access(topology: Topology) -> None:
    """Without the token, or with a wrong one, nothing is told."""
    for token in ("", "a-wrong-token-of-the-check"):
        try:
            ask(topology, "/jobs", token)
        except urllib.error.HTTPError as error:
            if error.code != 401:
                raise CheckError(f"a request without the token gives {error.code}") from error
        else:
            raise CheckError("a request without the token is answered")
    say("a request without the token is refused (401)")


def main() -> None:
    """Starts everything, runs a study through it, and ends it."""
    folder = Path(sys.argv[1])
    _, document = read_files()
    services: dict[str, Service] = document["services"]
    token = SECRETS["TRAINBRIDGE_TOKEN"]
    database = services["database"].environment
    topology = Topology(folder, services)
    with ExitStack() as held:
        user, password = database["POSTGRES_USER"], database["POSTGRES_PASSWORD"]
        topology.addresses["database:5432"] = held.enter_context(postgresql(folder, user, password))
        topology.addresses["store:7070"] = held.enter_context(object_store(folder, "trainbridge"))
        say("PostgreSQL and an object store (moto) are up")
        held.callback(lambda: [process.kill() for process in topology.processes])
        try:
            prepare(topology)
            check_commands(topology)
            for name, number in (("scheduler", 0), ("worker", 1), ("worker", 2)):
                topology.start(name, number)
            for name in ("coordinator", "web"):
                topology.start(name)
            taken = until("health checks", topology.well, START_SECONDS)
            say(f"all {len(topology.processes)} are healthy after {taken:.1f} s")
            check_access(topology)
            check_study(topology, token)
            if not topology.well():
                raise CheckError("a health check fails after the job")
            topology.stop()
        except CheckError as error:
            for process in topology.processes:
                print(f"--- {process.name}\n{process.tail()}", file=sys.stderr)
            raise SystemExit(f"  BROKEN  {error}") from None


if __name__ == "__main__":
    main()
