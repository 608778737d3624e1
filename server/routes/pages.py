"""The page, its files, and third-party code from installed packages.

Texts are compressed once and kept in memory. Every file carries a tag of its content: browsers ask
again at each visit, so that a new version shows at once, and are answered with 304.
"""

from __future__ import annotations

import gzip
import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from server.errors import gone_missing
from server.vendor import plotly_bytes, plotly_url

__all__ = ["accepts_gzip", "router", "static_files", "static_folder"]

router = APIRouter(include_in_schema=False)

_TYPES = {
    ".css": "text/css",
    ".html": "text/html",
    ".ico": "image/x-icon",
    ".js": "text/javascript",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".webp": "image/webp",
    ".woff2": "font/woff2",
}
"""Of the page's files; the system's own table may lack or mistake some."""
_TEXTS = frozenset({".css", ".html", ".js", ".svg"})
_KEPT_FILES = 256
"""Files whose content stays in memory: all of the page's, some of them in two versions."""


@dataclass(frozen=True, kw_only=True)
class _Content:
    """A file as it was when it was read."""

    plain: bytes
    compressed: bytes
    tag: str


class _PageFiles(StaticFiles):
    """Files of the page and no others: development tools lie beside them in a checkout."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        parts = Path(path).parts
        hidden = any(part.startswith(".") or part == "node_modules" for part in parts)
        known = Path(path).suffix in _TYPES.keys() - {".html"}
        if hidden or not known or scope["method"] not in ("GET", "HEAD"):
            raise gone_missing("file", path)
        place, found = await run_in_threadpool(self.lookup_path, path)
        if found is None:
            raise gone_missing("file", path)
        return await run_in_threadpool(_answer, Path(place), Headers(scope=scope))


def static_folder() -> Path:
    """The page's files: in the wheel beside this package, in a checkout beside ``server``."""
    packaged = Path(__file__).parents[1] / "static"
    return packaged if packaged.is_dir() else Path(__file__).parents[2] / "static"


def static_files() -> StaticFiles:
    """Serves the page's files."""
    return _PageFiles(directory=static_folder())


@router.get("/")
def read_page(request: Request) -> Response:
    """The dashboard."""
    return _answer(static_folder() / "index.html", request.headers)


@router.get(plotly_url())
async def read_plotly(request: Request) -> Response:
    """plotly.js, kept by browsers for ever: its address holds its version."""
    compressed = accepts_gzip(request.headers.get("accept-encoding", ""))
    content = await run_in_threadpool(plotly_bytes, compressed=compressed)
    headers = {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}
    if compressed:
        headers["Content-Encoding"] = "gzip"
    return Response(content, media_type="text/javascript", headers=headers)


def accepts_gzip(header: str) -> bool:
    """Whether an ``Accept-Encoding`` header takes gzip (RFC 9110, 12.5.3).

    ``gzip;q=0`` refuses it; ``*`` takes whatever is not named.
    """
    weights: dict[str, float] = {}
    for item in header.lower().split(","):
        name, *parameters = (part.strip() for part in item.split(";"))
        weights[name] = next((_weight(text[2:]) for text in parameters if text[:2] == "q="), 1.0)
    return weights.get("gzip", weights.get("*", 0.0)) > 0.0


def _weight(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def _answer(file: Path, headers: Headers) -> Response:
    """A file, compressed where that is taken and shorter, or that it is still the same."""
    state = file.stat()
    content = _read(file, state.st_mtime_ns, state.st_size)
    small = accepts_gzip(headers.get("accept-encoding", "")) and bool(content.compressed)
    tag = f'"{content.tag}-gzip"' if small else f'"{content.tag}"'
    answered = {"Cache-Control": "no-cache", "ETag": tag, "Vary": "Accept-Encoding"}
    if _names(headers.get("if-none-match", ""), tag):
        return Response(status_code=304, headers=answered)
    if small:
        answered["Content-Encoding"] = "gzip"
    body = content.compressed if small else content.plain
    return Response(body, media_type=_TYPES[file.suffix], headers=answered)


def _names(header: str, tag: str) -> bool:
    """Whether ``If-None-Match`` names a tag; weak ones count too (RFC 9110, 13.1.2)."""
    return header.strip() == "*" or tag in (
        item.strip().removeprefix("W/") for item in header.split(",")
    )


@lru_cache(maxsize=_KEPT_FILES)
def _read(file: Path, modified: int, size: int) -> _Content:
    """A file's content; who changes it changes ``modified`` [ns] or ``size`` [B] as well."""
    plain = file.read_bytes()
    compressed = gzip.compress(plain, mtime=0) if file.suffix in _TEXTS else b""
    return _Content(
        plain=plain,
        compressed=compressed if len(compressed) < len(plain) else b"",
        tag=hashlib.sha256(plain).hexdigest()[:20],
    )
