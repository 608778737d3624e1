"""What can go wrong for a client, in words that say what to do.

ClientError               anything below
|-- ServerAwayError       nobody answers; the text says how to start a server
`-- ProblemError          the server refused: status, title, detail, findings
"""

from __future__ import annotations

from collections.abc import Sequence

import httpx
from pydantic import ValidationError

from server.routes.schemas import FindingItem, ProblemDocument

__all__ = ["ClientError", "ProblemError", "ServerAwayError", "away", "refusal"]


class ClientError(Exception):
    """Why something did not work; the text says what to do."""


class ServerAwayError(ClientError):
    """Nobody answers at the server's address."""


class ProblemError(ClientError):
    """The server's refusal (RFC 9457).

    Attributes:
        problem: The whole document.
    """

    def __init__(self, problem: ProblemDocument) -> None:
        super().__init__(f"{problem.title}: {problem.detail}")
        self.problem = problem

    @property
    def status(self) -> int:
        """The answer's status."""
        return self.problem.status

    @property
    def findings(self) -> Sequence[FindingItem]:
        """Each thing that is wrong, with its place and what to do."""
        return self.problem.errors


def away(url: str, error: httpx.HTTPError) -> ServerAwayError:
    """Why a server could not be talked to."""
    if isinstance(error, httpx.TimeoutException) and not isinstance(error, httpx.ConnectTimeout):
        return ServerAwayError(f"The server at {url} takes too long to answer. Try again.")
    return ServerAwayError(
        f"No server answers at {url} ({error}). Start one with `trainbridge serve`, or name "
        "another with --server or TRAINBRIDGE_SERVER."
    )


def refusal(answer: httpx.Response) -> ProblemError:
    """What a refusal says; what is no problem document (a proxy's page) is shortened."""
    try:
        return ProblemError(ProblemDocument.model_validate_json(answer.content))
    except ValidationError:
        text = answer.text.strip()[:200] or "It says nothing more."
        title = f"Status {answer.status_code}"
        return ProblemError(
            ProblemDocument(title=title, status=answer.status_code, detail=text, errors=[])
        )
