"""Third-party browser code, served from the installed packages: none of it lies in this one."""

from __future__ import annotations

import gzip
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

__all__ = ["plotly_bytes", "plotly_url"]

_PLOTLY = Path("package_data") / "plotly.min.js"


@cache
def plotly_url() -> str:
    """Address of plotly.js: it holds the version, so that browsers may keep the file for ever."""
    return f"/vendor/plotly-{version('plotly')}/plotly.min.js"


@cache
def plotly_bytes(*, compressed: bool) -> bytes:
    """plotly.js, plain (4.8 MB) or compressed once for all (1.5 MB)."""
    # Found without importing plotly, which takes long.
    spec = find_spec("plotly")
    if spec is None or spec.origin is None:
        raise FileNotFoundError("the package plotly is not installed")
    content = (Path(spec.origin).parent / _PLOTLY).read_bytes()
    return gzip.compress(content, compresslevel=6, mtime=0) if compressed else content
