"""A client of the API for Python programs and for the command line: typed, and patient."""

from __future__ import annotations

import math
import os
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from datetime import datetime
from typing import Any, Literal, Self
from urllib.parse import quote

import httpx
import numpy as np
from numpy.typing import NDArray

from server.client.failures import ClientError, away, refusal
from server.client.watching import WatchEvent, watch
from server.routes.schemas import (
    ChannelList,
    Health,
    Job,
    JobList,
    Run,
    StateName,
    TemplateList,
    VerdictList,
)
from server.settings.addresses import is_loopback

__all__ = ["DEFAULT_URL", "TrainbridgeClient"]

DEFAULT_URL = "http://127.0.0.1:8000"
_API = "/api/v1"
_SILENCE_SECONDS = 60.0
"""A stream that says nothing for so long, not even a heartbeat, is broken. [s]"""


class TrainbridgeClient:
    """Talks to one server."""

    def __init__(
        self,
        url: str = DEFAULT_URL,
        token: str = "",
        *,
        seconds: float = 30.0,
        patience: float = 60.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        """Prepares to talk; nothing is sent yet.

        Args:
            url: The server's address.
            token: Its secret, empty for none.
            seconds: Time-out of a request. [s]
            patience: How long ``watch`` tries to reconnect before it gives up. [s]
            transport: Replaces the network, for tests.

        Raises:
            ClientError: The address is none.
        """
        self.url = url.rstrip("/")
        self._patience, self._seconds = patience, seconds
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        try:
            self._http = httpx.Client(
                base_url=self.url,
                headers=headers,
                timeout=seconds,
                transport=transport,
                # A proxy's "this machine" is another one.
                trust_env=not is_loopback(httpx.URL(self.url).host),
            )
            usable = self._http.base_url.scheme in ("http", "https") and self._http.base_url.host
        except (httpx.InvalidURL, UnicodeEncodeError):
            usable = False
        if not usable:
            raise ClientError(
                f"{url!r} is not a server's address. Give one like {DEFAULT_URL} with --server or "
                "TRAINBRIDGE_SERVER."
            )

    @classmethod
    def from_environment(cls, url: str | None = None) -> TrainbridgeClient:
        """A client of the server that ``TRAINBRIDGE_SERVER`` and ``TRAINBRIDGE_TOKEN`` name.

        Args:
            url: Wins over the variable.
        """
        named = url or os.environ.get("TRAINBRIDGE_SERVER", "").strip() or DEFAULT_URL
        return cls(named, os.environ.get("TRAINBRIDGE_TOKEN", "").strip())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes every connection."""
        self._http.close()

    # Jobs.

    def submit(
        self,
        study: Mapping[str, Any],
        *,
        kind: Literal["crossing", "modes"] = "crossing",
        priority: int = 0,
        key: str | None = None,
    ) -> Job:
        """Submits a study.

        Args:
            study: As JSON.
            kind: What to compute.
            priority: Greater ones begin first.
            key: The same key with the same study gives the same job: safe to send twice.

        Raises:
            ProblemError: 422 unusable, 503 the queue is full, 507 no room.
        """
        body = {"kind": kind, "priority": priority, "study": dict(study)}
        headers = {} if key is None else {"Idempotency-Key": key}
        answer = self._send("POST", "/jobs", json=body, headers=headers)
        return Job.model_validate_json(answer.content)

    def job(self, job: str) -> Job:
        """A job with its runs."""
        return self._job("GET", job)

    def jobs(
        self,
        *,
        states: Sequence[StateName] = (),
        kind: str | None = None,
        name: str | None = None,
        created_from: datetime | None = None,
        created_to: datetime | None = None,
        page: int = 50,
    ) -> Iterator[Job]:
        """Jobs, newest first; each page is asked for when it is needed.

        Args:
            states: Only jobs in one of these; empty for all.
            kind: Only jobs of this kind.
            name: Only jobs whose name contains this.
            created_from: Only jobs submitted then or later; without a time zone it is the local
                time of this machine.
            created_to: Only jobs submitted before; likewise.
            page: Jobs asked for at once.
        """
        wanted = {
            "limit": page,
            "state": list(states),
            "kind": kind,
            "name": name,
            "created_from": created_from and created_from.astimezone().isoformat(),
            "created_to": created_to and created_to.astimezone().isoformat(),
        }
        cursor: str | None = None
        while True:
            given = {key: value for key, value in wanted.items() if value}
            parameters = given if cursor is None else {**given, "cursor": cursor}
            answer = self._send("GET", "/jobs", params=parameters)
            found = JobList.model_validate_json(answer.content)
            yield from found.items
            if found.next is None:
                return
            cursor = found.next

    def cancel(self, job: str) -> Job:
        """Asks for a job's end."""
        return self._job("POST", job, "/cancel")

    def retry(self, job: str) -> Job:
        """Queues the runs again that ended without a result.

        Raises:
            ProblemError: 409 the job has not ended, or every run is done.
        """
        return self._job("POST", job, "/retry")

    def clone(self, job: str) -> Job:
        """A new job with the same study."""
        return self._job("POST", job, "/clone")

    def delete(self, job: str) -> None:
        """Removes a job with its files."""
        self._send("DELETE", f"/jobs/{quote(job, safe='')}")

    def set_priority(self, job: str, priority: int) -> Job:
        """Changes how soon a job's waiting runs begin."""
        return self._job("PATCH", job, json={"priority": priority})

    def log(self, job: str) -> str:
        """What happened to a job, one line an entry."""
        return self._send("GET", f"/jobs/{quote(job, safe='')}/log").text

    def summary(self, job: str) -> Mapping[str, Any]:
        """What all runs of a sweep gave together.

        Raises:
            ProblemError: 409 there is none (yet).
        """
        return self._send("GET", f"/jobs/{quote(job, safe='')}/summary").json()

    def verdicts(self, job: str) -> VerdictList:
        """Of each rule the worst verdict of all runs."""
        answer = self._send("GET", f"/jobs/{quote(job, safe='')}/verdicts")
        return VerdictList.model_validate_json(answer.content)

    # Runs.

    def run(self, run: str) -> Run:
        """A run with its summary and verdicts."""
        answer = self._send("GET", f"/runs/{quote(run, safe='')}")
        return Run.model_validate_json(answer.content)

    def cancel_run(self, run: str) -> Run:
        """Takes one run out of its job."""
        answer = self._send("POST", f"/runs/{quote(run, safe='')}/cancel")
        return Run.model_validate_json(answer.content)

    def retry_run(self, run: str) -> Run:
        """Queues one run again that ended without a result."""
        answer = self._send("POST", f"/runs/{quote(run, safe='')}/retry")
        return Run.model_validate_json(answer.content)

    def channels(self, run: str) -> ChannelList:
        """The recorded histories."""
        answer = self._send("GET", f"/runs/{quote(run, safe='')}/channels")
        return ChannelList.model_validate_json(answer.content)

    def channel(
        self, run: str, name: str, *, begin: float | None = None, end: float | None = None
    ) -> NDArray[np.float64]:
        """A recorded history, SI.

        Args:
            run: The run.
            name: The channel.
            begin: Begin of the window. [s]
            end: End of the window. [s]

        Returns:
            Shape (n_sample, 2): time and value.
        """
        window = {"from": begin, "to": end}
        answer = self._send(
            "GET",
            f"/runs/{quote(run, safe='')}/channels/{quote(name)}.csv",
            params={key: value for key, value in window.items() if value is not None},
        )
        _, _, rows = answer.text.partition("\n")
        values = np.array(rows.replace("\r\n", ",").split(",")[:-1], dtype=float)
        return values.reshape(-1, 2)

    # The server.

    def health(self) -> Health:
        """Whether the server answers and its queue works."""
        return Health.model_validate_json(self._send("GET", "/health").content)

    def templates(self) -> TemplateList:
        """Studies that are ready to submit."""
        return TemplateList.model_validate_json(self._send("GET", "/templates").content)

    # Waiting.

    def watch(self, job: str, *, after: int = 0) -> Iterator[WatchEvent]:
        """What happens to a job, until it has ended; reconnects and misses nothing.

        Args:
            job: The job.
            after: Begin after this event.

        Raises:
            ProblemError: The job does not exist (any more), or the server refuses.
            ServerAwayError: The server stayed away for ``patience`` seconds.
        """
        yield from self._watch(job, after, None)

    def wait(self, job: str, *, seconds: float | None = None) -> Job:
        """The job when it has ended.

        Args:
            job: The job.
            seconds: How long to wait at most; None for as long as it takes. [s]

        Raises:
            TimeoutError: It has not ended by then.
        """
        deadline = None if seconds is None else time.monotonic() + seconds
        # Events of days are heard one by one; only the last is kept.
        last = deque(self._watch(job, 0, deadline), maxlen=1).pop()
        assert last.job is not None
        return last.job

    def _watch(self, job: str, after: int, deadline: float | None) -> Iterator[WatchEvent]:
        path = f"{_API}/jobs/{quote(job, safe='')}/events"

        def connect(last: int) -> AbstractContextManager[httpx.Response]:
            headers = {"Last-Event-ID": str(last)} if last else {}
            left = math.inf if deadline is None else deadline - time.monotonic()
            silence = httpx.Timeout(self._seconds, read=min(_SILENCE_SECONDS, max(0.01, left)))
            return self._http.stream("GET", path, headers=headers, timeout=silence)

        return watch(connect, url=self.url, after=after, patience=self._patience, deadline=deadline)

    # Requests.

    def _job(self, method: str, job: str, action: str = "", **parts: Any) -> Job:
        answer = self._send(method, f"/jobs/{quote(job, safe='')}{action}", **parts)
        return Job.model_validate_json(answer.content)

    def _send(self, method: str, path: str, **parts: Any) -> httpx.Response:
        try:
            answer = self._http.request(method, _API + path, **parts)
        except httpx.HTTPError as error:
            raise away(self.url, error) from error
        if answer.is_success:
            return answer
        raise refusal(answer)
