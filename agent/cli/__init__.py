"""The command line. Each command is a thin file of its own and imports what is heavy when it runs."""

from __future__ import annotations

from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit: 0 done, 2 bad usage or unreadable input.

    Args:
        arguments: Words after the command's name; None takes those of the process.
    """
    from agent.cli.commands import run_command  # workers import this package, and need none of the commands

    run_command(arguments)
