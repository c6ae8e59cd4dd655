"""How the command line says what went wrong: one clear line each on stderr."""

from __future__ import annotations

import sys

BAD_INPUT = 2
"""Exit code of bad usage and of input that cannot be read."""


def complain(*faults: str) -> None:
    """Print faults on stderr, a line each."""
    for fault in faults:
        print(f"slipjump: {fault}", file=sys.stderr)  # noqa: T201 - the command line speaks
