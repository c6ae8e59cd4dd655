"""``slipjump browse``: find the loops of an OPC UA server by the names of its nodes."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from agent.cli.common.columns import aligned
from connectors.base import ConfigError, ConnectionLostError

if TYPE_CHECKING:
    from agent.runtime.commission.loop_search import LoopSearch
    from connectors.opcua.browse import Bounds
    from connectors.opcua.options import OpcUaOptions

CONNECTION = "dcs"
NAMES = "Names"
SECURITY = "Security, as in the configuration's connections"


def _pattern(value: str | None) -> str | None:
    if value is not None and value.count("*") != 1:
        raise typer.BadParameter(f"expected a name with one * for the loop, as *.PIDA.PV, not {value!r}")
    return value


def _name_option(role: str) -> Any:  # noqa: ANN401 - what typer makes has no type
    return typer.Option(
        f"--{role}",
        metavar="PATTERN",
        callback=_pattern,
        help=f"Names of {role.upper()}, * for the loop.",
        rich_help_panel=NAMES,
    )


def _security_option(name: str, text: str, metavar: str = "FILE") -> Any:  # noqa: ANN401 - likewise
    return typer.Option(f"--{name}", metavar=metavar, help=text, rich_help_panel=SECURITY)


def browse(
    url: Annotated[str, typer.Argument(metavar="opc.tcp://HOST:PORT", show_default=False)],
    *,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="CONFIG.yaml", help="Write a configuration.")
    ] = None,
    ts: Annotated[
        float,
        typer.Option("--ts", metavar="SECONDS", min=0.001, help="Sampling time of each loop."),
    ] = 1.0,
    root: Annotated[
        str, typer.Option("--root", metavar="NODE", help="Node to begin at, e.g. ns=2;s=Area1.")
    ] = "i=85",
    depth: Annotated[int, typer.Option(min=1, max=100, help="Levels below it.")] = 12,
    nodes: Annotated[int, typer.Option(min=1, help="Nodes after which it ends.")] = 100_000,
    within: Annotated[
        float, typer.Option(min=0.1, metavar="SECONDS", help="Time after which it ends.")
    ] = 120.0,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line for each loop.")] = False,
    pv: Annotated[str | None, _name_option("pv")] = None,
    op: Annotated[str | None, _name_option("op")] = None,
    sp: Annotated[str | None, _name_option("sp")] = None,
    mode: Annotated[str | None, _name_option("mode")] = None,
    certificate: Annotated[str | None, _security_option("certificate", "This client's.")] = None,
    key: Annotated[str | None, _security_option("key", "Its private key.")] = None,
    server_certificate: Annotated[
        str | None, _security_option("server-certificate", "The server's certificate.")
    ] = None,
    ca: Annotated[str | None, _security_option("ca", "Or the authority that signed it.")] = None,
    policy: Annotated[str | None, _security_option("policy", "Default: Basic256Sha256.", "NAME")] = None,
    user: Annotated[str | None, _security_option("user", "User name for the login.", "NAME")] = None,
    password_env: Annotated[
        str | None, _security_option("password-env", "Environment variable with the password.", "NAME")
    ] = None,
    password_file: Annotated[str | None, _security_option("password-file", "Or a file with it.")] = None,
) -> None:
    """Find the loops of an OPC UA server by its nodes' names, and write a configuration. Writes no node."""
    patterns = {
        role: each for role, each in {"pv": pv, "op": op, "sp": sp, "mode": mode}.items() if each is not None
    }
    if patterns and not {"pv", "op"} <= patterns.keys():
        raise typer.BadParameter("--pv and --op belong together", param_hint="'--pv' / '--op'")
    if out is not None and out.exists():
        raise ConfigError([f"{out}: exists already; remove it, or name another file"])
    secured = {
        "certificate": certificate,
        "key": key,
        "server_certificate": server_certificate,
        "ca": ca,
        "policy": policy,
    }
    login = {"user": user, "password": _given({"env": password_env, "file": password_file})}
    entry = {"url": url} | _given({"security": _given(secured), "login": _given(login)})
    options = _options(entry)
    from connectors.opcua.browse import Bounds

    found = _searched(options, Bounds(depth, nodes, within), root, patterns)
    for line in _json(found) if as_json else _table(found):
        typer.echo(line)
    if not found.loops:
        seen = f"{found.variables} variables{_ended(found)}"
        raise ConfigError([f"{url}: no loop among {seen}; name yours by --pv and --op"])
    if out is not None:
        _write(out, url, {"kind": "opcua", **entry}, found, ts)
        typer.echo(f"{out}: {len(found.loops)} loops. Next: slipjump check {out} --connect", err=as_json)


def _searched(options: OpcUaOptions, bounds: Bounds, root: str, patterns: Mapping[str, str]) -> LoopSearch:
    from agent.runtime.capabilities import run_event_loop
    from agent.runtime.commission.loop_search import find_loops

    try:
        with _progress() as show_progress:
            return run_event_loop(find_loops(options, bounds, root, patterns, show_progress))
    except ConnectionLostError as error:
        raise ConfigError([str(error)]) from error


def _json(found: LoopSearch) -> Iterator[str]:
    for loop in found.loops:
        tags = {
            role: {"node": node, "value": _plain(loop.values.get(role)), "range": loop.spans.get(role)}
            for role, node in loop.nodes.items()
        }
        yield json.dumps({"loop": loop.name, "names": loop.by, "tags": tags})


def _table(found: LoopSearch) -> list[str]:
    rows = [
        [
            loop.name,
            loop.by,
            *(_shown(loop.values.get(role)) for role in ("pv", "op")),
            *(loop.nodes[role] for role in ("pv", "op")),
            " ".join(role for role in loop.nodes if role not in ("pv", "op")),
        ]
        for loop in found.loops
    ]
    table = aligned([["LOOP", "NAMES OF", "PV", "OP", "PV NODE", "OP NODE", "ALSO"], *rows]) if rows else []
    seen = f"{found.nodes} nodes, {found.variables} variables, {len(found.loops)} loops"
    return [*table, "", seen + _ended(found)]


def _ended(found: LoopSearch) -> str:
    return f" (ended after {found.stopped}, there may be more)" if found.stopped else ""


def _options(entry: Mapping[str, object]) -> OpcUaOptions:
    from agent.settings.checked import checked
    from connectors.opcua.options import OpcUaOptions

    faults: list[str] = []
    options = checked(OpcUaOptions, entry, "", faults)
    if options is None:
        raise ConfigError(faults)
    return options


def _given(entries: Mapping[str, object]) -> dict[str, Any]:
    return {name: value for name, value in entries.items() if value}


def _write(out: Path, url: str, connection: Mapping[str, object], found: LoopSearch, ts: float) -> None:
    """Write the configuration, which is sure to be one that can be loaded."""
    import yaml

    from agent.settings import settings_of

    loops = [loop.entry(CONNECTION, ts) for loop in found.loops]
    config = {"connections": {CONNECTION: dict(connection)}, "loops": loops}
    settings_of(config)
    head = (
        f"# Loops of {url}, found by slipjump browse on {datetime.now(UTC):%Y-%m-%d}.\n"
        "# Set for each loop: ts, the sampling time, s; acting, reverse or direct; and under publish the\n"
        "# connections for its alarm (docs/configuration.md). Then: slipjump check THIS --connect\n"
    )
    text = yaml.safe_dump(config, sort_keys=False, default_flow_style=None, width=110)
    try:
        with out.open("x", encoding="utf-8") as file:
            file.write(head + text)
    except OSError as error:
        raise ConfigError([f"{out}: cannot be written: {error.strerror}"]) from error


@contextmanager
def _progress() -> Iterator[Callable[[int, int], None]]:
    """Show on a terminal's stderr how far the walk is."""
    if not sys.stderr.isatty():
        yield lambda _seen, _waiting: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    text = TextColumn("{task.completed:.0f} of {task.total:.0f} nodes known so far")
    columns = (text, BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=1)
        yield lambda seen, waiting: progress.update(task, completed=max(0, seen - waiting), total=seen)


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, int | float) else "-" if value is None else str(value)


def _plain(value: object) -> object:
    return value if isinstance(value, int | str) or (isinstance(value, float) and value == value) else None  # noqa: PLR0124 - NaN
