"""A client of the API for Python programs and for the command line.

with TrainbridgeClient("http://127.0.0.1:8000") as client:
    job = client.submit(study)
    for event in client.watch(job.id):
        ...
    history = client.channel(job.runs[0].id, "mid-span 1/displacement")
"""

from server.client.client import DEFAULT_URL, TrainbridgeClient
from server.client.failures import ClientError, ProblemError, ServerAwayError
from server.client.watching import ENDED, WatchEvent

__all__ = [
    "DEFAULT_URL",
    "ENDED",
    "ClientError",
    "ProblemError",
    "ServerAwayError",
    "TrainbridgeClient",
    "WatchEvent",
]
