"""What a setting is made of: its name, type, bounds and meaning, and how text becomes its value.

Nothing here knows which settings there are: they are read off the fields of a dataclass.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Interval, Le, Lt

__all__ = ["Check", "Setting", "SettingsError", "ShownSetting", "UnusableError", "settings_of"]

_TRUE = frozenset({"1", "true", "yes", "on"})
_FALSE = frozenset({"0", "false", "no", "off"})


class SettingsError(Exception):
    """A setting that cannot be used; the text says what to do."""


class UnusableError(Exception):
    """A value that a setting cannot take.

    Attributes:
        reason: Why not.
        remedy: What to do.
    """

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(f"{reason}. {remedy}")
        self.reason = reason
        self.remedy = remedy


@dataclass(frozen=True)
class Check:
    """A bound of its own: gives None, or ``(reason, remedy)``."""

    trouble: Callable[[Any], tuple[str, str] | None]


@dataclass(frozen=True, kw_only=True)
class ShownSetting:
    """A setting as ``trainbridge config`` prints it.

    Attributes:
        name: Dotted, as in the file.
        value: As text, without secrets.
        source: Where the value comes from.
        meaning: What it is for.
    """

    name: str
    value: str
    source: str
    meaning: str


@dataclass(frozen=True, kw_only=True)
class Setting:
    """One setting.

    Attributes:
        name: Dotted, as in the file: ``port``, ``limits.runs_per_job``.
        kind: ``bool``, ``int``, ``float``, ``str``, ``Path`` or ``tuple`` (of texts).
        optional: Whether it may have no value.
        bounds: Of ``annotated_types``, and ``Check``.
        meaning: What it is for.
        default: The value that stands where no other is given.
    """

    name: str
    kind: type
    optional: bool
    bounds: tuple[Any, ...]
    meaning: str
    default: Any

    @property
    def variable(self) -> str:
        """Its environment variable."""
        return "TRAINBRIDGE_" + self.name.replace(".", "_").upper()

    def from_text(self, text: str) -> Any:
        """The value of a variable's text.

        Raises:
            UnusableError: It is no value of this setting.
        """
        text = text.strip()
        if self.kind is bool:
            return self._bool(text.lower())
        if self.kind is tuple:
            return tuple(part.strip() for part in text.split(",") if part.strip())
        if self.optional and not text:
            return None
        return self.checked(self._scalar(text))

    def from_value(self, value: Any) -> Any:
        """The value of a file's or the command line's value.

        Raises:
            UnusableError: It is no value of this setting.
        """
        if value is None and self.optional:
            return None
        if self.kind is tuple:
            return self._texts(value)
        if self.kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if self.kind is Path and isinstance(value, str):
            value = Path(value)
        exact = isinstance(value, self.kind) and (self.kind is bool or not isinstance(value, bool))
        if not exact:
            raise UnusableError(*_WORDS[self.kind])
        return self.checked(value)

    def checked(self, value: Any) -> Any:
        """A value of the right type, within its bounds.

        Raises:
            UnusableError: It is beyond a bound.
        """
        if isinstance(value, float) and not -1e300 < value < 1e300:
            raise UnusableError("is not a finite number", "Write a finite number")
        for bound in self.bounds:
            if isinstance(bound, Check):
                trouble = bound.trouble(value)
                if trouble is not None:
                    raise UnusableError(*trouble)
            else:
                _require_within(value, bound)
        return value

    def _scalar(self, text: str) -> Any:
        if self.kind is Path and not text:
            raise UnusableError("is empty", "Name a file or folder")
        try:
            return self.kind(text)
        except ValueError:
            raise UnusableError(*_WORDS[self.kind]) from None

    def _bool(self, text: str) -> bool:
        if text in _TRUE or text in _FALSE:
            return text in _TRUE
        raise UnusableError(*_WORDS[bool])

    def _texts(self, value: Any) -> tuple[str, ...]:
        items: list[Any] = list(value) if isinstance(value, (list, tuple)) else [None]
        if not all(isinstance(item, str) for item in items):
            raise UnusableError(*_WORDS[tuple])
        return tuple(items)


_WORDS: Mapping[type, tuple[str, str]] = {
    bool: ("is neither true nor false", "Write true or false"),
    int: ("is not a whole number", "Write a whole number, without unit"),
    float: ("is not a number", "Write a number, without unit"),
    str: ("is not a text", "Write a text in quotes"),
    Path: ("is not the name of a file or folder", "Write it as a text in quotes"),
    tuple: ("is not a list of texts", 'Write a list, for example ["bridges.example.org"]'),
}


def settings_of(kind: type, prefix: str = "") -> dict[str, Setting]:
    """The settings that the fields of a dataclass make, those of dataclasses in it too.

    Args:
        kind: The dataclass; each field has a meaning in the class's ``Attributes``.
        prefix: Comes before each name.

    Returns:
        By dotted name, in the order of the fields.
    """
    hints = get_type_hints(kind, include_extras=True)
    meanings = _meanings(kind)
    found: dict[str, Setting] = {}
    for item in fields(kind):
        inner, optional, bounds = _parts(hints[item.name])
        name = prefix + item.name
        if is_dataclass(inner):
            found |= settings_of(inner, f"{name}.")
            continue
        factory = item.default_factory
        found[name] = Setting(
            name=name,
            kind=inner,
            optional=optional,
            bounds=bounds,
            meaning=meanings[item.name],
            default=item.default if factory is MISSING else factory(),
        )
    return found


def _parts(hint: Any) -> tuple[type, bool, tuple[Any, ...]]:
    """A field's type without decoration, whether it may be None, and its bounds."""
    bounds: tuple[Any, ...] = ()
    if get_origin(hint) is Annotated:
        hint, *more = get_args(hint)
        bounds = tuple(more)
    optional = False
    if get_origin(hint) in (Union, UnionType):
        [hint] = [item for item in get_args(hint) if item is not NoneType]
        optional = True
    return get_origin(hint) or hint, optional, bounds


def _meanings(kind: type) -> dict[str, str]:
    """The texts of a docstring's ``Attributes``, each on one line."""
    _, _, text = inspect.cleandoc(kind.__doc__ or "").partition("Attributes:\n")
    found: dict[str, str] = {}
    name = ""
    for line in text.splitlines():
        start = re.match(r" {4}(\w+): (.*)", line)
        if start:
            name = start[1]
            found[name] = start[2]
        elif name and line.strip():
            found[name] += " " + line.strip()
    return {name: meaning.replace("``", "") for name, meaning in found.items()}


def _require_within(value: Any, bound: Any) -> None:
    if isinstance(bound, Interval):
        low, high = bound.ge, bound.le
        if (low is not None and not value >= low) or (high is not None and not value <= high):
            raise UnusableError(f"must lie between {low} and {high}", "Give a value between them")
    elif isinstance(bound, Ge) and not value >= bound.ge:
        raise UnusableError(f"must be at least {bound.ge}", "Give a greater value")
    elif isinstance(bound, Gt) and not value > bound.gt:
        raise UnusableError(f"must be greater than {bound.gt}", "Give a greater value")
    elif isinstance(bound, Le) and not value <= bound.le:
        raise UnusableError(f"must be at most {bound.le}", "Give a smaller value")
    elif isinstance(bound, Lt) and not value < bound.lt:
        raise UnusableError(f"must be less than {bound.lt}", "Give a smaller value")
