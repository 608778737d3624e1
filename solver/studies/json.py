"""A study as plain JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from solver.studies.study import Study

__all__ = ["to_json"]


def to_json(study: Study) -> dict[str, Any]:
    """Nested dictionaries, lists, strings and numbers that ``json.dumps`` takes as they are."""
    return _plain(asdict(study))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(entry) for entry in value]
    return value
