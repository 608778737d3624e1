"""Parts of studies on their own: checked by the same parser and rules that a whole study meets."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any, cast

from server.errors import Finding, Problem, pointer, shortened
from server.jobs.submission import read_study
from solver import studies
from solver.irregularities import MeasuredProfile
from solver.studies import Study

__all__ = ["LARGEST_PART", "PARTS", "read_part"]

PARTS: Mapping[str, str] = MappingProxyType(
    {
        "trains": "train",
        "viaducts": "viaduct",
        "tracks": "track",
        "irregularities": "irregularity",
    }
)
"""Each kind of entry, and the field of a study that it fills."""

LARGEST_PART = 256 * 1024
"""A part as JSON: twelve types of car and forty cars take a twentieth of it. [B]"""

_PLAIN_TRAINS = frozenset({"sprung_masses", "axle_table"})


def read_part(
    kind: str, value: Any, path: Sequence[str | int] = ()
) -> tuple[dict[str, Any], list[Finding]]:
    """A part with every default filled in, or everything that is wrong with it.

    Bounds and relations inside of the part count; whether it goes with the other parts of some
    study is asked when that study is checked.

    Args:
        kind: One of ``PARTS``.
        value: The part, as parsed JSON.
        path: Where it stands in what was sent, for pointers.

    Returns:
        The part as JSON, empty where it cannot be used, and the findings.
    """
    if len(json.dumps(value)) > LARGEST_PART:
        most = LARGEST_PART // 1024
        return {}, [_finding(path, "", f"is larger than {most} KiB", "Send a smaller part.")]
    if not isinstance(value, dict):
        reason, remedy = "is not an object", 'Send {"type": ...}.'
        return {}, [_finding(path, shortened(value), reason, remedy)]
    part = PARTS[kind]
    fields = cast(dict[str, Any], value)
    body = {**studies.to_json(studies.template(_companions(fields)).study), part: fields}
    try:
        study = read_study(body)
    except Problem as problem:
        return {}, [_moved(item, part, path) for item in problem.errors]
    findings = [*_own_relations(study, kind, path)]
    return ({} if findings else studies.to_json(study)[part]), findings


def _own_relations(study: Study, kind: str, path: Sequence[str | int]) -> Iterator[Finding]:
    """What a part's own fields forbid together: a car of no type, samples that run backwards."""
    found: Iterable[studies.Finding] = ()
    if kind == "trains":
        found = (item for item in studies.check(study).errors if item.path[:1] == ("train",))
    elif isinstance(study.irregularity, MeasuredProfile):
        found = studies.sample_order(study.irregularity)
    for item in found:
        yield _finding((*path, *item.path[1:]), shortened(item.value), item.reason, item.remedy)


def _companions(value: Mapping[str, Any]) -> str:
    """The template whose other parts a train goes with; any does for other parts."""
    return "sprung-mass-beam" if value.get("type") in _PLAIN_TRAINS else "khst-alverca"


def _moved(finding: Finding, part: str, path: Sequence[str | int]) -> Finding:
    """A finding of the whole study as one of the part alone."""
    inside = finding.pointer.removeprefix(f"/{part}")
    return replace(finding, pointer=f"{pointer(path)}{inside}")


def _finding(path: Sequence[str | int], value: str, reason: str, remedy: str) -> Finding:
    return Finding(pointer=pointer(path), value=value, reason=reason, remedy=remedy)
