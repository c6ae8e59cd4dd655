"""What a fresh `slipjump diagnose` takes beyond the fit, with the cache of compiled kernels warm and cold."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np

from agent.analysis.diagnose import diagnose
from agent.analysis.recording import LoopHints
from agent.cli.recordings import loop_window
from benchmarks.lee2008_map import sticking_loop
from benchmarks.markdown import table
from benchmarks.options import Options
from connectors.recording import read_recording

SAMPLES = 1500
REPEATS = 5
ALLOWED = 2.0
"""Seconds beyond the fit that must hold with a warm cache (issue 3)."""


def run(_options: Options) -> None:
    """Print wall times; a cold cache is a new empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "FIC101.csv"
        op, pv = sticking_loop(1000, SAMPLES)
        rows = np.stack([np.arange(SAMPLES), op, pv], axis=1)
        np.savetxt(recording, rows, delimiter=",", header="time,OP,PV", comments="")
        fit = seconds_of_fit(recording)
        wall_seconds(recording, None)
        warm = median(wall_seconds(recording, None) for _ in range(REPEATS))
        cold = wall_seconds(recording, Path(folder) / "kernels")
    holds = "holds" if warm - fit <= ALLOWED else "**does not hold**"
    lines = (
        ("warm", f"{warm:.2f}", f"{fit:.2f}", f"{warm - fit:.2f}", f"{ALLOWED:g}, {holds}"),
        ("cold", f"{cold:.1f}", f"{fit:.2f}", f"{cold - fit:.1f}", ""),
    )
    columns = ("kernel cache", "whole process", "the fit itself", "beyond it", "at most")
    print(table(f"### A fresh process, {SAMPLES} samples, wall seconds", columns, lines))


def seconds_of_fit(recording: Path) -> float:
    """Return the wall time of a diagnosis in a process that has done one before."""
    window = loop_window(read_recording(recording), LoopHints())
    diagnose(window)
    return median(diagnose(window).seconds for _ in range(REPEATS))


def wall_seconds(recording: Path, cache: Path | None) -> float:
    """Return the wall time of the command, with its kernels in ``cache`` or where they usually are."""
    environment = os.environ | ({} if cache is None else {"NUMBA_CACHE_DIR": str(cache)})
    command = [str(Path(sys.executable).with_name("slipjump")), "diagnose", str(recording)]
    started = time.perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)  # noqa: S603 - our own command
    return time.perf_counter() - started
