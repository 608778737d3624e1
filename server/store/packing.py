"""Arrays by name in one document, with a digest that tells whether all of it is there."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["pack", "unpack"]

_MAGIC = b"trainbridge arrays 1\n"
_DIGEST_BYTES = 32


def pack(arrays: Mapping[str, NDArray[Any]], facts: Mapping[str, Any] | None = None) -> bytes:
    """Arrays and a few facts as one document.

    Args:
        arrays: By name; of numbers, never of Python objects.
        facts: Plain JSON values.

    Raises:
        ValueError: An array holds Python objects.
    """
    content = io.BytesIO()
    content.write(_MAGIC + bytes(_DIGEST_BYTES))
    head = json.dumps({"names": list(arrays), "facts": dict(facts or {})}).encode()
    np.save(content, np.frombuffer(head, np.uint8), allow_pickle=False)
    for values in arrays.values():
        np.save(content, np.asarray(values), allow_pickle=False)
    view = content.getbuffer()
    start = len(_MAGIC)
    view[start : start + _DIGEST_BYTES] = _digest(view[start + _DIGEST_BYTES :])
    del view
    return content.getvalue()


def unpack(data: bytes | None) -> tuple[dict[str, NDArray[Any]], dict[str, Any]] | None:
    """What ``pack`` was given; None where the document is missing, torn or something else."""
    if data is None or not data.startswith(_MAGIC):
        return None
    start = len(_MAGIC)
    body = memoryview(data)[start + _DIGEST_BYTES :]
    if _digest(body) != data[start : start + _DIGEST_BYTES]:
        return None
    content = io.BytesIO(data)
    content.seek(start + _DIGEST_BYTES)
    head = json.loads(np.load(content, allow_pickle=False).tobytes())
    arrays = {name: np.load(content, allow_pickle=False) for name in head["names"]}
    return arrays, head["facts"]


def _digest(body: Any) -> bytes:
    return hashlib.blake2b(body, digest_size=_DIGEST_BYTES).digest()
