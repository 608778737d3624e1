"""The version of the installed package."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

__all__ = ["package_version"]


def package_version() -> str:
    """Version of the installed package; of a checkout that is not installed, 0."""
    try:
        return version("trainbridge")
    except PackageNotFoundError:
        return "0"
