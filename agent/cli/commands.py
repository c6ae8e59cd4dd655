"""All commands, and how one of them is run."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Sequence
from typing import Annotated

import typer

from agent.cli.alarms import alarms
from agent.cli.browse import browse
from agent.cli.certificates import certificates
from agent.cli.check import check
from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.common.examples import epilog
from agent.cli.compare import compare
from agent.cli.comparing.workbench import workbench
from agent.cli.demo import demo
from agent.cli.diagnosing.diagnose import diagnose
from agent.cli.history import history
from agent.cli.import_ import import_
from agent.cli.registers import registers
from agent.cli.replay import replay
from agent.cli.run import run
from agent.cli.serve import serve
from agent.cli.simulate import simulate
from agent.cli.surveying.survey import survey
from agent.cli.warm import warm
from connectors.base import ConfigError

EPILOG = """Examples:

slipjump demo  (a simulated plant on three buses, with its alarms)

slipjump diagnose FIC101.csv --plot pictures  (does it stick, how much)

slipjump diagnose *.csv --op CO --ts 5 --json  (one JSON object a line)

slipjump survey archive/ -o survey  (thousands of loops, resumed where it was interrupted)

slipjump compare FIC101.csv --auto  (which physical effect is missing)

slipjump workbench FIC101.csv  (the same in the browser, with the mouse)

slipjump replay FIC101.csv --bus mqtt  (a recording through the agent)

slipjump serve fic101_stick_slip --config plant.yaml  (simulated loops on OPC UA, to train with)

slipjump browse opc.tcp://dcs:4840 -o plant.yaml  (find the loops by their names)

slipjump check plant.yaml --connect, then slipjump run plant.yaml

slipjump alarms list --config plant.yaml  (and acknowledge, shelve, out-of-service)

slipjump history --config plant.yaml --loop FIC101  (what it found, what became of the alarm)
"""

app = typer.Typer(
    name="slipjump",
    help="Find sticking control valves from controller output (OP) and process variable (PV), "
    "say how much they stick, and raise the alarm on the bus.",
    epilog=EPILOG,
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

COMMANDS: tuple[Callable[..., None], ...] = (
    demo,
    diagnose,
    survey,
    compare,
    workbench,
    import_,
    replay,
    serve,
    run,
    browse,
    check,
    registers,
    history,
    simulate,
    certificates,
)
"""Each is named as its function; its docstring is its help."""
HIDDEN: tuple[Callable[..., None], ...] = (warm,)
COLLECT_AFTER = 20_000
"""New containers until Python looks for garbage, for its 700: a thousand modules, which stay, were searched
again and again while they were imported, a tenth of the start."""


def _print_version(*, requested: bool) -> None:
    if requested:
        from importlib.metadata import version

        typer.echo(f"slipjump {version('slipjump')}")
        raise typer.Exit


@app.callback()
def _options(
    *,
    requested: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=lambda requested: _print_version(requested=requested),
            is_eager=True,
            help="Print the version and exit.",
        ),
    ] = False,
) -> None:
    pass


for command in COMMANDS:
    called = command.__name__.rstrip("_")
    app.command(called, epilog=epilog(called))(command)
for command in HIDDEN:
    app.command(hidden=True)(command)
app.add_typer(alarms, epilog=epilog("alarms"))


def run_command(arguments: Sequence[str] | None) -> None:
    """Run a command and exit; as ``main`` of the package."""
    # Our matrices are small: several threads wait for each other. numpy reads it when a command imports it.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(COLLECT_AFTER)
    try:
        code = app(arguments, prog_name="slipjump", standalone_mode=False) or 0
    except ConfigError as error:
        for fault in error.faults:
            complain(fault)
        code = BAD_INPUT
    except typer.TyperException as error:
        complain(" ".join(error.format_message().split()))
        code = BAD_INPUT
    gc.freeze()  # else Python searches all that numba and scipy hold for garbage before it ends: 0.4 s
    sys.exit(code)
