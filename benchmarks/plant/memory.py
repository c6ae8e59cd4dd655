"""Memory and CPU of a process and of all that it started; pages that several share count once."""

from __future__ import annotations

import os
from pathlib import Path


def proportional(pid: int) -> tuple[float, float]:
    """Return MB of a process, and with all its descendants."""
    return _of(pid), sum(_of(each) for each in _family(pid))


def workers_cpu(pid: int) -> float:
    """Return the CPU time of all descendants of a process that live, s."""
    return sum(_cpu(each) for each in _family(pid)[1:])


def _cpu(pid: int) -> float:
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _of(pid: int) -> float:
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1000 for line in lines if line.startswith("Pss:")), 0.0)


def _family(pid: int) -> list[int]:
    children = [
        int(child)
        for task in Path(f"/proc/{pid}/task").glob("*/children")
        for child in task.read_text().split()
    ]
    return [pid, *(each for child in children for each in _family(child))]
