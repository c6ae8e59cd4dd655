"""A tick on the page of the workbench: first curve, fit and candidates, against ``compare --add``."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from itertools import islice
from pathlib import Path

from agent.cli.comparing.hooks import pool_of_cores
from agent.web.workbench.desk import Desk, Opening
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.plant import rows
from simulators.record_file import write_rows
from simulators.scenario import load_scenario

ROOT = Path(__file__).resolve().parents[1]
SAMPLES = 1500
SCENARIO, EFFECT = "wb104", "deadband"
"""Of the workbench's own, and what it hides."""
MAIN = "from agent.cli import main; main()"


def run(options: Options) -> None:
    """Print seconds from the tick, and those of the command on the same file in the same run."""
    del options
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "WB104.csv"
        scenario = load_scenario(ROOT / "config" / "scenarios" / "workbench" / f"{SCENARIO}.yaml")
        write_rows(file, list(islice(rows(scenario), SAMPLES)))
        seen: list[tuple[str, float]] = []
        with pool_of_cores() as pool:
            desk = Desk(lambda kind, _: seen.append((kind, time.perf_counter())))
            desk.open(Opening(file, file.name), pool)
            seen.clear()
            began = time.perf_counter()
            desk.tick(EFFECT)
            ended = time.perf_counter()
        words = [sys.executable, "-c", MAIN, "compare", str(file), "--no-guided", "--add", EFFECT]
        command = time.perf_counter()
        subprocess.run(words, check=True, capture_output=True)  # noqa: S603 - our own command
        command = time.perf_counter() - command
    curve, model = (next(at for kind, at in seen if kind == name) - began for name in ("curve", "state"))
    numbers = (curve, model, ended - began, command, (ended - began) / command)
    heads = (
        "first curve, s", "model fitted, s", "all candidates tried, s", "compare --add, s", "tick / command",
    )  # fmt: skip
    print(table(f"### A tick on {SAMPLES} samples", heads, [tuple(f"{each:.2f}" for each in numbers)]))
