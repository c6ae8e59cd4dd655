"""``slipjump browse``: find the loops of an OPC UA server or an MQTT broker by their names."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from agent.cli.browsing.peers import ADDRESSES, BrowseRequest, given, peer_of
from agent.cli.browsing.shown import ended, json_lines, table, write
from connectors.base import ConfigError, ConnectionLostError

if TYPE_CHECKING:
    from agent.cli.browsing.peers import Browsed
    from agent.runtime.commission.found_loops import LoopSearch

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
    url: Annotated[str, typer.Argument(metavar=" or ".join(ADDRESSES[:2]), show_default=False)],
    *,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="CONFIG.yaml", help="Write a configuration.")
    ] = None,
    ts: Annotated[
        float,
        typer.Option("--ts", metavar="SECONDS", min=0.001, help="Sampling time of each loop."),
    ] = 1.0,
    root: Annotated[
        str | None,
        typer.Option(
            "--root",
            metavar="NODE",
            help="Node to begin at, e.g. ns=2;s=Area1, or topics, e.g. plant/#. Default: all.",
        ),
    ] = None,
    depth: Annotated[int, typer.Option(min=1, max=100, help="Levels below it, of OPC UA.")] = 12,
    nodes: Annotated[int, typer.Option(min=1, help="Nodes, or topics, after which it ends.")] = 100_000,
    within: Annotated[
        float | None,
        typer.Option(
            min=0.1,
            metavar="SECONDS",
            help="Time after which it ends. Default: 120; a broker is heard for 30.",
        ),
    ] = None,
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
    """Find the loops of an OPC UA server or MQTT broker by their names, and write a configuration.

    Writes no node and publishes nothing.
    """
    patterns = {
        role: each for role, each in {"pv": pv, "op": op, "sp": sp, "mode": mode}.items() if each is not None
    }
    if patterns and not {"pv", "op"} <= patterns.keys():
        raise typer.BadParameter("--pv and --op belong together", param_hint="'--pv' / '--op'")
    if out is not None and out.exists():
        raise ConfigError([f"{out}: exists already; remove it, or name another file"])
    security = {
        "certificate": certificate,
        "key": key,
        "server_certificate": server_certificate,
        "ca": ca,
        "policy": policy,
    }
    login = given({"user": user, "password": given({"env": password_env, "file": password_file})})
    peer = peer_of(BrowseRequest(url, root, depth, nodes, within, given(security), login))
    found = _searched(peer, patterns)
    for line in json_lines(found) if as_json else table(found):
        typer.echo(line)
    if not found.variables:
        raise ConfigError(
            [f"{url}: no {found.called[1]} seen{ended(found)}; look longer by --within, or by --root"]
        )
    if not found.loops:
        seen = f"{found.variables} {found.called[1]}{ended(found)}"
        raise ConfigError([f"{url}: no loop among {seen}; name yours by --pv and --op"])
    if out is not None:
        write(out, url, peer.entry, found, ts)
        typer.echo(f"{out}: {len(found.loops)} loops. Next: slipjump check {out} --connect", err=as_json)


def _searched(peer: Browsed, patterns: Mapping[str, str]) -> LoopSearch:
    from agent.runtime.capabilities import run_event_loop

    try:
        with _progress(peer.unit) as show_progress:
            return run_event_loop(peer.search(patterns, show_progress))
    except ConnectionLostError as error:
        raise ConfigError([str(error)]) from error


@contextmanager
def _progress(unit: str) -> Iterator[Callable[[int, int], None]]:
    """Show on a terminal's stderr how far the search is."""
    if not sys.stderr.isatty():
        yield lambda _seen, _waiting: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    text = TextColumn(f"{{task.completed:.0f}} of {{task.total:.0f}} {unit}")
    columns = (text, BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=1)
        yield lambda seen, waiting: progress.update(task, completed=max(0, seen - waiting), total=seen)
