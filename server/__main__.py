"""The command ``trainbridge``, also ``python -m server``.

Child processes import the main module again: it imports nothing before it is asked to run.
"""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Runs the command line."""
    from server.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
