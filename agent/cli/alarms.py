"""``slipjump alarms``: list an agent's alarms, and send commands to them."""

from __future__ import annotations

import functools
import getpass
import json
import time
from collections import defaultdict
from contextlib import AbstractContextManager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common.state_file import ConfigPath, StatePath, opened, state_file

if TYPE_CHECKING:
    from agent.alarms import Alarm
    from agent.runtime.store.store import Store

TAKEN_WITHIN = 3.0
"""s; a running agent takes a command within a second."""
LOOK = 0.05
"""s"""

alarms = typer.Typer(
    name="alarms",
    help="List the alarms of an agent, acknowledge them, shelve them, take them out of service.",
    no_args_is_help=True,
)

Loop = Annotated[str, typer.Argument(metavar="LOOP", show_default=False)]
By = Annotated[str, typer.Option("--by", help="Who decides; default: this user.", show_default=False)]


@alarms.command("list")
def show(
    state: StatePath = None,
    config: ConfigPath = None,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line.")] = False,
) -> None:
    """List the alarm of each loop, and the commands that wait for the agent."""
    with _store(state, config) as store:
        kept, commands = store.read().alarms, store.commands()
    waits = defaultdict(list)
    for each in commands:
        if each.command is not None:
            waits[each.loop].append(each.command.event.value)
    for loop, alarm in kept.items():
        fields = _fields(alarm) | {"waits": waits[loop]}
        typer.echo(json.dumps(fields) if as_json else _line(alarm, waits[loop]))


@alarms.command()
def acknowledge(loop: Loop, state: StatePath = None, config: ConfigPath = None, by: By = "") -> None:
    """Acknowledge the alarm of a loop."""
    _send(loop, "acknowledge", by, state, config)


@alarms.command()
def shelve(
    loop: Loop,
    state: StatePath = None,
    config: ConfigPath = None,
    by: By = "",
    hours: Annotated[float, typer.Option(min=0.0001, max=8760, help="Length of shelving, h.")] = 8.0,
) -> None:
    """Shelve the alarm of a loop: suppress it for some hours."""
    _send(loop, "shelve", by, state, config, seconds=3600 * hours)


@alarms.command()
def unshelve(loop: Loop, state: StatePath = None, config: ConfigPath = None, by: By = "") -> None:
    """End shelving; the alarm is raised again if the valve still sticks."""
    _send(loop, "unshelve", by, state, config)


@alarms.command("out-of-service")
def out_of_service(loop: Loop, state: StatePath = None, config: ConfigPath = None, by: By = "") -> None:
    """Take the alarm of a loop out of service: suppress it without a time limit."""
    _send(loop, "out_of_service", by, state, config)


@alarms.command("return")
def return_to_service(loop: Loop, state: StatePath = None, config: ConfigPath = None, by: By = "") -> None:
    """Return the alarm to service; it is raised again if the valve still sticks."""
    _send(loop, "in_service", by, state, config)


def _store(state: Path | None, config: Path | None) -> AbstractContextManager[Store]:
    """Open the agent's file; raises ConfigError where there is none."""
    from agent.runtime.store.store import Store

    return opened(state_file(state, config), functools.partial(Store, create=False), "when it runs")


def _send(
    loop: str, action: str, by: str, state: Path | None, config: Path | None, seconds: float | None = None
) -> None:
    """Leave a command for the agent and print its result."""
    from agent.alarms import Command
    from connectors.base import ConfigError

    now = time.time()
    command = Command.of_action(action, by or _user(), now, None if seconds is None else now + seconds)
    with _store(state, config) as store:
        known = store.read().alarms
        if loop not in known:
            raise ConfigError([f"{store.path}: no loop is called {loop} (there are: {', '.join(known)})"])
        if (
            all(each.loop != loop for each in store.commands())
            and known[loop].on_command(command)[0] == known[loop]
        ):
            raise ConfigError(
                [f"{loop}: its alarm is {known[loop].state.value}, which {action} does not change"]
            )
        number = store.command(loop, command)
        taken = _is_taken(store, number)
        alarm = store.read().alarms[loop]
    if taken:
        typer.echo(_line(alarm, []))
    else:
        typer.echo(f"{loop}: no agent runs; {command.event.value} takes effect when it starts")


def _is_taken(store: Store, number: int) -> bool:
    """Wait for the agent; return whether it took the command."""
    deadline = time.monotonic() + TAKEN_WITHIN
    while any(each.number == number for each in store.commands()):
        if time.monotonic() > deadline:
            return False
        time.sleep(LOOK)
    return True


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError) as error:
        raise typer.BadParameter("this user has no name: name who decides by --by NAME") from error


def _fields(alarm: Alarm) -> dict[str, object]:
    """Return the published fields of an alarm, by their names on the buses."""
    from agent.alarms import Announcement

    fields = Announcement("state", alarm, 0.0).fields()
    return {name: value for name, value in fields.items() if name not in {"time", "message_id"}}


def _line(alarm: Alarm, waits: list[str]) -> str:
    from agent.report.numbers import value_words

    words = [f"{alarm.loop}: {alarm.state.value}"]
    if alarm.until is not None:
        until = datetime.fromtimestamp(alarm.until, UTC)
        words.append(f"until {until:%Y-%m-%d %H:%M:%S} UTC")
    if alarm.by is not None:
        words.append(f"by {alarm.by}")
    words.append(f"priority {alarm.priority}, NE 107 {alarm.health.name.lower()}")
    if alarm.stiction is not None:
        words.append(f"S {value_words(alarm.stiction.s)}")
    if waits:
        words.append(f"waits for the agent: {', '.join(waits)}")
    return ", ".join(words)
