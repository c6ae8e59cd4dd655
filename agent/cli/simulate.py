"""``slipjump simulate``: a scenario in, a recording and its truth out."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from agent.cli.common.errors import BAD_INPUT, complain


def simulate(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO", help="The loop and its faults: a file, or a name of `slipjump serve --list`."
        ),
    ],
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="RECORDING.csv", help="The recording to write.")
    ],
) -> None:
    """Simulate a loop whose faults are known. The truth is written beside it, to RECORDING.truth.yaml."""
    from rich.console import Console
    from rich.progress import track

    from agent.cli.common.config_folder import config_folder
    from simulators.hidden_faults import scenario_path
    from simulators.plant import rows
    from simulators.record_file import write_rows, write_truth
    from simulators.scenario import load_scenario

    loop = load_scenario(scenario_path(scenario, config_folder() / "scenarios"))
    stderr = Console(stderr=True)
    progress = track(
        rows(loop), f"simulating {loop.loop}", loop.samples, console=stderr, disable=not sys.stderr.isatty()
    )
    truth = output.with_suffix(".truth.yaml")
    try:
        write_rows(output, progress)
        write_truth(truth, loop)
    except OSError as error:
        complain(f"{error.filename}: cannot be written: {error.strerror}")
        raise typer.Exit(BAD_INPUT) from error
    stderr.print(f"{output}: {loop.samples} samples; truth in {truth}", highlight=False, soft_wrap=True)
