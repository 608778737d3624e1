"""Settings from the command line, the environment, a file and the defaults, strongest first.

Everything that is wrong is said at once: the setting, where it comes from, its value, why it cannot
be used and what to do. A key or variable that is no setting is refused too: a misspelt limit would
not limit anything.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any

from server.settings.addresses import without_secrets
from server.settings.fields import Limits, Settings
from server.settings.sources import (
    Setting,
    SettingsError,
    ShownSetting,
    UnusableError,
    settings_of,
)

__all__ = ["CONFIG_NAME", "ReadSettings", "read_settings"]

CONFIG_NAME = "trainbridge.toml"
"""File that is read where it lies in the working folder and no other is named."""

_PREFIX = "TRAINBRIDGE_"
_OTHERS = frozenset({"TOKEN", "TOKEN_FILE", "CONFIG", "SERVER", "NO_SKIP", "SCREENSHOTS", "KILLS"})
"""Variables of the command line and of the tests: no settings, and known."""
_OTHER_PREFIXES = ("TEST_", "CHECK_")
_DEFAULT = "default"
_COMMAND_LINE = "command line"


@dataclass(frozen=True, kw_only=True)
class ReadSettings:
    """Settings, and where each value comes from.

    Attributes:
        settings: The settings.
        sources: By dotted name, as people read it.
    """

    settings: Settings
    sources: Mapping[str, str]

    def shown(self) -> list[ShownSetting]:
        """Every setting with value, source and meaning; without secrets."""
        return [
            ShownSetting(
                name=name,
                value=_shown(name, _value(self.settings, name)),
                source=self.sources.get(name, _DEFAULT),
                meaning=setting.meaning,
            )
            for name, setting in _settings().items()
        ]


@dataclass
class _Found:
    """Values gathered so far, the strongest source last, and what is wrong."""

    values: dict[str, Any] = field(default_factory=dict[str, Any])
    sources: dict[str, str] = field(default_factory=dict[str, str])
    errors: list[str] = field(default_factory=list[str])

    def take(self, name: str, value: Any, source: str, parse: Callable[[Any], Any]) -> None:
        """Takes a value, or notes what is wrong with it."""
        try:
            self.values[name] = parse(value)
            self.sources[name] = source
        except UnusableError as error:
            shown = _shown(name, value)[:80]
            self.errors.append(f"{name} = {shown} ({source}) {error.reason}. {error.remedy}.")


def read_settings(
    environment: Mapping[str, str],
    *,
    token_file: Path | None = None,
    config: Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    folder: Path | None = None,
    listens: bool = True,
) -> ReadSettings:
    """Reads every source and checks the whole.

    Args:
        environment: Usually ``os.environ``.
        token_file: A file that holds the token; it wins over every variable.
        config: A TOML file; else the one that ``TRAINBRIDGE_CONFIG`` names; else
            ``trainbridge.toml`` in the working folder, where there is one.
        overrides: Fields given on the command line; ``None`` means not given.
        folder: The working folder, the process's own by default.
        listens: Whether a web server will listen on ``host``, which must then be safe.

    Raises:
        SettingsError: Everything that is wrong.
    """
    here = folder or Path.cwd()
    found = _Found()
    file = _config_file(environment, config, here)
    named_token: Path | None = None
    if file is not None:
        named_token = _take_file(found, file)
    _take_environment(found, environment)
    for name, value in (overrides or {}).items():
        if value is not None:
            found.take(name, value, _COMMAND_LINE, _settings()[name].from_value)
    token, source = _token(environment, token_file, named_token)
    if found.errors:
        raise SettingsError("\n".join(found.errors))
    limits = {name.removeprefix("limits."): v for name, v in found.values.items() if "." in name}
    values = {name: value for name, value in found.values.items() if "." not in name}
    values["data"] = (here / values.get("data", _settings()["data"].default)).absolute()
    if values.get("store") and "://" not in values["store"]:
        values["store"] = str((here / values["store"]).absolute())
    settings = Settings(**values, token=token, limits=Limits(**limits))
    if listens:
        settings.require_safe_host()
    settings.require_safe_scheduler()
    return ReadSettings(settings=settings, sources={**found.sources, "token": source})


@cache
def _settings() -> dict[str, Setting]:
    return settings_of(Settings)


def _config_file(environment: Mapping[str, str], config: Path | None, here: Path) -> Path | None:
    if config is not None:
        return config
    named = environment.get(f"{_PREFIX}CONFIG", "").strip()
    if named:
        return Path(named)
    usual = here / CONFIG_NAME
    return usual if usual.is_file() else None


def _take_file(found: _Found, file: Path) -> Path | None:
    """Takes what a file holds, and gives the token's file that it names."""
    try:
        document = tomllib.loads(file.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"The settings file {file} is no TOML: {error}. Correct it.") from error
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(
            f"The settings file {file} cannot be read: {error}. Name another with --config."
        ) from error
    source = f"file {file}"
    token_file: Path | None = None
    for name, value in _flat(document):
        if name == "token_file" and isinstance(value, str):
            token_file = Path(value)
        elif name == "token":
            found.errors.append(
                f"token ({source}) does not belong into a settings file. Put it into a file of its "
                "own, name that as token_file, or set TRAINBRIDGE_TOKEN."
            )
        elif name in _settings():
            found.take(name, value, source, _settings()[name].from_value)
        else:
            found.errors.append(_unknown(name, source, [*_settings(), "token_file"]))
    return token_file


def _flat(document: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in document.items():
        if isinstance(value, dict) and prefix + name not in _settings():
            yield from _flat(value, f"{prefix}{name}.")  # pyright: ignore[reportUnknownArgumentType]
        else:
            yield prefix + name, value


def _take_environment(found: _Found, environment: Mapping[str, str]) -> None:
    by_variable = {item.variable: item for item in _settings().values() if item.name != "token"}
    for variable, text in sorted(environment.items()):
        rest = variable.removeprefix(_PREFIX)
        if rest == variable or rest in _OTHERS or rest.startswith(_OTHER_PREFIXES):
            continue
        source = f"variable {variable}"
        setting = by_variable.get(variable)
        if setting is None:
            known = [*by_variable, *(_PREFIX + name for name in _OTHERS)]
            found.errors.append(_unknown(variable, "the environment", known))
        else:
            found.take(setting.name, text, source, setting.from_text)


def _unknown(name: str, source: str, known: list[str]) -> str:
    near = get_close_matches(name, known, n=3, cutoff=0.6)
    hint = f" Did you mean {' or '.join(near)}?" if near else ""
    return (
        f"{name} ({source}) is not a setting.{hint} Correct or remove it; "
        "`trainbridge config` lists all."
    )


def _token(
    environment: Mapping[str, str], given: Path | None, named: Path | None
) -> tuple[str, str]:
    """The token and where it comes from."""
    if given is not None:
        return _read_token(given), f"file {given}"
    token = environment.get(f"{_PREFIX}TOKEN", "").strip()
    if token:
        return token, f"variable {_PREFIX}TOKEN"
    file = environment.get(f"{_PREFIX}TOKEN_FILE", "").strip() or named
    if file:
        return _read_token(Path(file)), f"file {file}"
    return "", _DEFAULT


def _read_token(path: Path) -> str:
    try:
        token = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"The token file {path} cannot be read: {error}.") from error
    if not token:
        raise SettingsError(f"The token file {path} is empty. Put the token on its first line.")
    return token


def _value(settings: Settings, name: str) -> Any:
    value: Any = settings
    for part in name.split("."):
        value = getattr(value, part)
    return value


def _shown(name: str, value: Any) -> str:
    if name == "token":
        return "set (never shown)" if value else "not set"
    if value is None or value in ("", ()):
        return "not set"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (tuple, list)):
        return ", ".join(str(item) for item in value)  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]
    return without_secrets(str(value))
