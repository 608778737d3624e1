"""JSON documents on disk: written whole or not at all."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

__all__ = ["plain", "read_document", "write_document"]


def plain(value: Any) -> Any:
    """The value in plain JSON types: arrays as lists, numbers that are not finite as null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in cast(Mapping[Any, Any], value).items()}
    if isinstance(value, np.ndarray):
        return plain(cast(Any, value).tolist())
    if isinstance(value, (list, tuple, set, frozenset)):
        return [plain(item) for item in cast(Any, value)]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)


def write_document(path: Path, document: Mapping[str, Any]) -> None:
    """Replaces a JSON file atomically: a reader sees the old or the new one, never a part."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    text = json.dumps(plain(document), ensure_ascii=False, allow_nan=False)
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def read_document(path: Path) -> dict[str, Any] | None:
    """The JSON file's content, or None where there is no such file."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
