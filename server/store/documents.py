"""JSON documents in a store: written whole or not at all."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from server.store.place import Place

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


def write_document(place: Place, name: str, document: Mapping[str, Any]) -> None:
    """Replaces a JSON document atomically: a reader sees the old or the new one, never a part."""
    text = json.dumps(plain(document), ensure_ascii=False, allow_nan=False)
    place.write(name, text.encode())


def read_document(place: Place, name: str) -> dict[str, Any] | None:
    """The JSON document's content, or None where there is none."""
    data = place.read(name)
    return None if data is None else json.loads(data)
