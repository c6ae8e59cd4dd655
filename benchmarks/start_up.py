"""CPU time of a fresh `slipjump diagnose` beyond the fit, with a warm and a cold cache of kernels."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

import numpy as np

from agent.analysis.diagnose import DEFAULT_QUANTIFIER
from agent.analysis.record.window_of_recording import loop_window
from benchmarks.cases.cpu_time import diagnosis_seconds
from benchmarks.cases.options import Options
from benchmarks.lee2008_map import sticking_loop
from benchmarks.tables.markdown import table
from connectors.recording import read_recording

SAMPLES = 1500
REPEATS = 5
ALLOWED = 2.0
"""Seconds beyond the fit that must hold with a warm cache (issue 3)."""


def run(_options: Options) -> None:
    """Print a row for the warm cache and one for a cold one, a new empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "FIC101.csv"
        op, pv = sticking_loop(1000, SAMPLES)
        rows = np.stack([np.arange(SAMPLES), op, pv], axis=1)
        np.savetxt(recording, rows, delimiter=",", header="time,OP,PV", comments="")
        window = loop_window(read_recording(recording))
        fit = diagnosis_seconds(window, DEFAULT_QUANTIFIER)
        fresh_process(recording, None)
        warm = median(fresh_process(recording, None)[0] for _ in range(REPEATS))
        cold, output = fresh_process(recording, Path(folder) / "kernels")
    holds = "holds" if warm - fit <= ALLOWED else "**does not hold**"
    lines = (
        ("warm", f"{warm:.2f}", f"{fit:.2f}", f"{warm - fit:.2f}", f"{ALLOWED:g}, {holds}"),
        ("cold", f"{cold:.1f}", f"{fit:.2f}", f"{cold - fit:.1f}", ""),
    )
    columns = ("kernel cache", "whole process", "the fit itself", "beyond it", "at most")
    print(table(f"### A fresh process, {SAMPLES} samples, CPU seconds", columns, lines))
    print(f"With a cold cache it prints: {output.strip() or 'nothing'}\n")


def fresh_process(recording: Path, cache: Path | None) -> tuple[float, str]:
    """Return the CPU time of the command and its output on stderr.

    Its kernels are in ``cache``, or where they usually are.
    """
    environment = os.environ | ({} if cache is None else {"NUMBA_CACHE_DIR": str(cache)})
    command = [str(Path(sys.executable).with_name("slipjump")), "diagnose", str(recording)]
    before = children_seconds()
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)  # noqa: S603 - our own command
    return children_seconds() - before, done.stderr


def children_seconds() -> float:
    """Return the CPU time of all processes that this one has started and seen end."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
