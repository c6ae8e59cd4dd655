"""How the command line says what went wrong: one clear line each on stderr."""

from __future__ import annotations

import sys

BAD_INPUT = 2
"""Exit code of bad usage and of input that cannot be read."""


def complain(fault: str) -> None:
    """Print one fault on stderr."""
    print(f"slipjump: {fault}", file=sys.stderr)  # noqa: T201 - the command line speaks
