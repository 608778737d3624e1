"""Whether a service of compose.yaml works: exit status 0, or 1 and a line that says why not.

healthcheck.py web                           the API answers: database and queue are well
healthcheck.py scheduler [--port N]          it takes encrypted connections of those who belong
healthcheck.py connected PORT... [--of PID]  a process of the service is connected to each port

A worker or coordinator has no port of its own to ask. Both end themselves when what they work for
stays away, so that a connection which stands, to the scheduler and the database, is what there is
to see from outside.
"""

from __future__ import annotations

import argparse
import os
import socket
import ssl
import sys
import urllib.request
from pathlib import Path

SECONDS = 5.0


def check_web(port: int) -> None:
    """Asks the server in this container."""
    request = urllib.request.Request(f"http://127.0.0.1:{port}/api/v1/health")
    token = os.environ.get("TRAINBRIDGE_TOKEN", "").strip()
    file = os.environ.get("TRAINBRIDGE_TOKEN_FILE", "").strip()
    if not token and file:
        token = Path(file).read_text(encoding="utf-8").strip()
    if token:
        request.add_header("Authorization", f"Bearer {token}")
    # No proxy of the environment stands between a server and its own container.
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    opener.open(request, timeout=SECONDS).close()


def check_scheduler(port: int) -> None:
    """Shakes hands: the kernel accepts for a process that hangs, but does not know its key."""
    authority = os.environ["TRAINBRIDGE_TLS_CA_FILE"]
    context = ssl.create_default_context(cafile=authority)
    context.check_hostname = False  # Who belongs is told by the certificate, not by a name.
    context.load_cert_chain(
        os.environ["TRAINBRIDGE_TLS_CERT_FILE"], os.environ["TRAINBRIDGE_TLS_KEY_FILE"]
    )
    with (
        socket.create_connection(("127.0.0.1", port), timeout=SECONDS) as plain,
        context.wrap_socket(plain) as encrypted,
    ):
        encrypted.recv(1)  # Dask speaks first.


def check_connected(ports: list[int], process: int) -> None:
    """Looks at the connections of a process and of those that it started."""
    import psutil

    first = psutil.Process(process)
    found: set[int] = set()
    for member in (first, *first.children(recursive=True)):
        try:
            connections = member.net_connections("tcp")
        except psutil.Error:  # It has just ended, or belongs to somebody else.
            continue
        found |= {
            item.raddr.port
            for item in connections
            if item.raddr and item.status == psutil.CONN_ESTABLISHED
        }
    missing = [str(port) for port in ports if port not in found]
    if missing:
        raise ConnectionError(f"no connection to port {', '.join(missing)}")


def main() -> int:
    """Runs the check that the command line names."""
    parser = argparse.ArgumentParser()
    kinds = parser.add_subparsers(dest="kind", required=True)
    kinds.add_parser("web").add_argument("--port", type=int, default=8000)
    kinds.add_parser("scheduler").add_argument("--port", type=int, default=8786)
    connected = kinds.add_parser("connected")
    connected.add_argument("ports", type=int, nargs="+")
    connected.add_argument("--of", type=int, default=1, help="process; the container's first one")
    given = parser.parse_args()
    try:
        if given.kind == "web":
            check_web(given.port)
        elif given.kind == "scheduler":
            check_scheduler(given.port)
        else:
            check_connected(given.ports, given.of)
    except Exception as error:  # Whatever it is, the service is not well.
        print(f"not well: {error or type(error).__name__}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
