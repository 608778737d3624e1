"""The page, its files, and third-party code from installed packages."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool
from starlette.responses import FileResponse
from starlette.staticfiles import StaticFiles

from server.errors import gone_missing
from server.vendor import plotly_bytes, plotly_url

__all__ = ["router", "static_files", "static_folder"]

router = APIRouter(include_in_schema=False)

_VISIBLE = frozenset({".css", ".js", ".svg", ".png", ".ico", ".woff2", ".webp"})


class _StaticFiles(StaticFiles):
    """Files of the page and no others: development tools lie beside them in a checkout."""

    async def get_response(self, path: str, scope: dict[str, object]) -> Response:  # type: ignore[override]
        parts = Path(path).parts
        hidden = any(part.startswith(".") or part == "node_modules" for part in parts)
        if hidden or Path(path).suffix not in _VISIBLE:
            raise gone_missing("file", path)
        response = await super().get_response(path, scope)  # pyright: ignore[reportArgumentType]
        # Asked again at each visit, answered with 304: a new version shows at once.
        response.headers["Cache-Control"] = "no-cache"
        return response


def static_folder() -> Path:
    """The page's files: in the wheel beside this package, in a checkout beside ``server``."""
    packaged = Path(__file__).parents[1] / "static"
    return packaged if packaged.is_dir() else Path(__file__).parents[2] / "static"


def static_files() -> StaticFiles:
    """Serves the page's files."""
    return _StaticFiles(directory=static_folder())


@router.get("/")
def read_page() -> FileResponse:
    """The dashboard."""
    headers = {"Cache-Control": "no-cache"}
    return FileResponse(static_folder() / "index.html", headers=headers)


@router.get(plotly_url())
async def read_plotly(request: Request) -> Response:
    """plotly.js, kept by browsers for ever: its address holds its version."""
    compressed = "gzip" in request.headers.get("accept-encoding", "")
    content = await run_in_threadpool(plotly_bytes, compressed=compressed)
    headers = {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}
    if compressed:
        headers["Content-Encoding"] = "gzip"
    return Response(content, media_type="text/javascript", headers=headers)
