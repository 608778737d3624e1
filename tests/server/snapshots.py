"""The API's answers as files: written once, compared ever after, read by the browser's tests.

Each file of ``tests/js/snapshots`` holds a request and its answer with what differs from run to run
made equal: identifiers, times of day, paces, versions, sizes of the machine. Numbers are compared
as far as another processor or solver would give them too; histories by length and extremes.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

__all__ = ["FOLDER", "Snapshot", "differences", "normalised", "read", "spoken", "text"]

FOLDER = Path(__file__).parents[1] / "js" / "snapshots"
RELATIVE = 1e-3
"""Other arithmetic changes the peaks of a history less than this; a changed meaning more."""
LONG = 8
"""From so many numbers on a list is a history."""

COMPUTING = "computing time"
"""A compared result that no two machines share."""

_NUMBERS = re.compile(r"\[\s+([-+.\dEeul,\s]+?)\s+\]")
_FIXED: dict[str, Any] = {
    "rate": 1234.0,
    "remaining": [10.0, 20.0],
    "seconds": 60.0,
    "memory_bytes": 4e9,
    "memory_available_bytes": 3e9,
    "disk_free_bytes": 5e10,
    "cores": 2,
    "version": "1.0.0",
    "back_end": "MKL PARDISO",
    "versions": {"python": "1.0", "numpy": "1.0", "scipy": "1.0"},
}
"""What the machine, the moment or the installed version decides."""
_FIXED_WORDS = (
    (re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|\+00:00)"), "2026-01-01T12:00:00Z"),
    (re.compile(r"took \d+ MB"), "took 300 MB"),
)


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """A request, and its answer as it is kept.

    Attributes:
        method: Of the request.
        path: Of the request, with its query.
        status: Of the answer.
        answer: The answer's JSON.
    """

    method: str
    path: str
    status: int
    answer: Any


def spoken(label: str) -> str:
    """A label as an identifier of the API may look: ``job-timed_out`` is ``jobTimedOut``."""
    first, *others = re.split("[-_]", label)
    return first + "".join(part.capitalize() for part in others)


def normalised(value: Any, names: Mapping[str, str], key: str = "") -> Any:
    """A JSON value without what differs from run to run.

    Args:
        value: The value.
        names: What to write in place of each identifier.
        key: Under which the value stands.
    """
    if key in _FIXED and value is not None:
        return _FIXED[key]
    if isinstance(value, dict):
        if key == "timings":
            return dict.fromkeys(sorted(value), 1.0)
        if value.get("name") == COMPUTING:
            count = len(value["values"])
            value = {**value, "values": [1.0] * count, "changes": [0.0] * count}
        return {name: normalised(item, names, name) for name, item in value.items()}
    if isinstance(value, list):
        return [normalised(item, names, key) for item in value]
    if isinstance(value, str):
        for identifier, name in names.items():
            value = value.replace(identifier, name)
        for pattern, words in _FIXED_WORDS:
            value = pattern.sub(words, value)
        return value
    if isinstance(value, float) and math.isfinite(value):
        return float(f"{value:.6g}")
    return value


def differences(kept: Any, found: Any, path: str = "") -> list[str]:
    """What is not the same, each with its JSON pointer."""
    if isinstance(kept, dict) and isinstance(found, dict):
        lost = [f"{path}/{key}: is gone" for key in kept.keys() - found.keys()]
        new = [f"{path}/{key}: is new" for key in found.keys() - kept.keys()]
        common = [key for key in kept if key in found]
        inner = [differences(kept[key], found[key], f"{path}/{key}") for key in common]
        return sorted(lost + new) + [item for items in inner for item in items]
    if isinstance(kept, list) and isinstance(found, list):
        if len(kept) != len(found):
            return [f"{path}: has {len(found)} items, had {len(kept)}"]
        if len(kept) >= LONG and _is_history(kept) and _is_history(found):
            return _history_differences(kept, found, path)
        pairs = enumerate(zip(kept, found, strict=True))
        inner = [differences(one, other, f"{path}/{index}") for index, (one, other) in pairs]
        return [item for items in inner for item in items]
    if _is_number(kept) and _is_number(found):
        same = math.isclose(kept, found, rel_tol=RELATIVE, abs_tol=1e-12)
        return [] if same else [f"{path}: is {found!r}, was {kept!r}"]
    if type(kept) is type(found) and kept == found:
        return []
    return [f"{path}: is {found!r}, was {kept!r}"]


def _history_differences(kept: list[Any], found: list[Any], path: str) -> list[str]:
    one, other = ([item for item in items if item is not None] for items in (kept, found))
    if not one or not other:
        return [] if len(one) == len(other) else [f"{path}: gaps differ"]
    scale = max(abs(item) for item in one)
    for name, extreme in (("least", min), ("greatest", max)):
        before, now = extreme(one), extreme(other)
        if abs(before - now) > RELATIVE * scale:
            return [f"{path}: the {name} is {now!r}, was {before!r}"]
    return []


def _is_history(values: list[Any]) -> bool:
    return all(item is None or _is_number(item) for item in values)


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def text(snapshot: Snapshot) -> str:
    """A snapshot's file: one value a line, but histories in one."""
    request = {"method": snapshot.method, "path": snapshot.path}
    document = {"request": request, "status": snapshot.status, "answer": snapshot.answer}
    written = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
    return _NUMBERS.sub(lambda found: f"[{' '.join(found[1].split())}]", written) + "\n"


def read(name: str) -> Snapshot:
    """A kept snapshot.

    Raises:
        FileNotFoundError: There is none of this name.
    """
    document = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return Snapshot(**document["request"], status=document["status"], answer=document["answer"])
