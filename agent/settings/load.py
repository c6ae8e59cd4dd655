"""Reads the configuration file and reports all its faults at once, each with its path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from agent.settings.checked import checked
from agent.settings.loop_list import LoopEntry, LoopList, listed_loops
from agent.settings.models import AgentSettings, ConnectionSettings, LoopSettings, Settings
from agent.settings.places import Places
from connectors.base import ConfigError, Connector
from connectors.kinds import KINDS, ConnectorKind, LoopTags
from connectors.options import Options, Target

Kind = ConnectorKind[Any, Any, Any]
_KINDS: dict[str, Kind] = {kind.kind: kind for kind in KINDS}


def load_settings(path: Path) -> Settings:
    """Read a YAML file; raises ConfigError with a line for each fault: file, line, loop, what is wrong.

    ``agent.state`` is always set in the result; ``settings_of`` knows no file and leaves it unchanged.
    """
    if (
        path.exists() and not path.is_file()
    ):  # reading a pipe would wait for ever, and a reload finds it empty
        raise ConfigError([f"{path}: is no regular file"])
    try:
        text = path.read_text(encoding="utf-8")
        raw = yaml.safe_load(text)
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError([f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}"]) from error
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise ConfigError([f"{path}: {line}not YAML: {error.problem}"]) from error
    except yaml.YAMLError as error:
        raise ConfigError([f"{path}: not YAML: {' '.join(str(error).split())}"]) from error
    except RecursionError as error:
        raise ConfigError([f"{path}: it is nested too deeply"]) from error
    except ValueError as error:  # an impossible date, a number with thousands of digits
        raise ConfigError([f"{path}: a value cannot be read: {error}"]) from error
    try:
        settings = settings_of(raw, path.parent)
    except ConfigError as error:
        raise ConfigError(_in_file(path, Places.of(text).located(error.faults))) from error
    state = path.parent / (settings.agent.state or path.with_suffix(".sqlite").name)
    return replace(settings, agent=settings.agent.model_copy(update={"state": state}))


def _in_file(path: Path, faults: list[str]) -> list[str]:
    return [f"{path}, {fault}" if fault.startswith("line ") else f"{path}: {fault}" for fault in faults]


def settings_of(raw: object, folder: Path = Path()) -> Settings:
    """Return settings from the content of a YAML file in ``folder``; raises ConfigError, a line a fault."""
    faults: list[str] = []
    if not isinstance(raw, Mapping):
        raise ConfigError(["expected a mapping with the keys agent, connections and loops"])
    if "connections" not in raw and not _has_loops(raw.get("loops")):
        raise ConfigError(["not a configuration of slipjump: it has neither connections nor loops with tags"])
    faults += [f"{key}: unknown key" for key in raw if key not in {"agent", "connections", "loops"}]
    agent = checked(AgentSettings, raw.get("agent") or {}, "agent", faults)
    connections = _connections(raw.get("connections"), faults)
    kinds = {name: _KINDS.get(str(entry.get("kind"))) for name, entry in _mappings(raw.get("connections"))}
    entries, lists = _entries(raw.get("loops"), kinds, folder, faults)
    loops = _loops(entries, kinds, faults)
    if faults or agent is None:
        raise ConfigError(list(dict.fromkeys(faults)))  # a wrong default shows in each line of a list
    settings = Settings(agent, connections, loops, lists)
    connectors_of(settings)  # checks that only the connector of a bus can make
    return settings


def connectors_of(settings: Settings, *, guest: bool = False) -> tuple[Connector, ...]:
    """Return one connector for each connection, not opened; raises ConfigError with the faults of all.

    A ``guest`` only reads: an agent with these settings may run at the same time.
    """
    connectors, faults = [], []
    for name, connection in settings.connections.items():
        loops = tags_on(settings, name)
        options = connection.options.as_guest() if guest else connection.options
        try:
            connectors.append(_KINDS[connection.kind].open(name, options, loops))
        except ConfigError as error:
            faults += error.faults
    if faults:
        raise ConfigError(faults)
    return tuple(connectors)


def tags_on(settings: Settings, connection: str) -> dict[str, LoopTags[Any, Any]]:
    """Return what a connection reads and writes for each loop, by the loop's name, in the file's order."""
    return {
        loop.name: LoopTags(
            tags=loop.tags if loop.connection == connection else {},
            targets=[target for target in loop.publish if target.connection == connection],
            variables=loop.variables,
        )
        for loop in settings.loops
        if loop.connection == connection or any(target.connection == connection for target in loop.publish)
    }


def _has_loops(raw: object) -> bool:
    """Whether any entry looks like a loop of a configuration, not like another file of slipjump."""
    entries = raw if isinstance(raw, list) else []
    return any(isinstance(each, Mapping) and ("tags" in each or "from" in each) for each in entries)


def _connections(raw: object, faults: list[str]) -> dict[str, ConnectionSettings]:
    if not isinstance(raw, Mapping) or not raw:
        faults.append("connections: expected at least one, name: {kind: ...}")
        return {}
    connections = {}
    for name, entry in raw.items():
        path = f"connections.{name}"
        if not isinstance(entry, Mapping):
            faults.append(f"{path}: expected a mapping with a key kind")
            continue
        kind = _KINDS.get(str(entry.get("kind")))
        if kind is None:
            faults.append(f"{path}.kind: expected one of {', '.join(_KINDS)}, not {entry.get('kind')!r}")
            continue
        rest = {key: value for key, value in entry.items() if key != "kind"}
        options = checked(kind.options, rest, path, faults)
        if options is not None:
            connections[str(name)] = ConnectionSettings(kind.kind, options)
    return connections


def _entries(
    raw: object, kinds: Mapping[str, Kind | None], folder: Path, faults: list[str]
) -> tuple[list[LoopEntry], tuple[Path, ...]]:
    """Return the loops as written, and the CSV lists that some of them come from."""
    if not isinstance(raw, list) or not raw:
        faults.append("loops: expected a list with at least one loop")
        return [], ()
    shorts = {name: kind.short if kind else None for name, kind in kinds.items()}
    entries, lists = [], []
    for index, entry in enumerate(raw):
        path = f"loops.{index}"
        if not isinstance(entry, Mapping):
            faults.append(f"{path}: expected a mapping with the keys name, connection, ts and tags")
        elif "from" not in entry:
            entries.append(LoopEntry(path, entry))
        elif (listed := checked(LoopList, entry, path, faults)) is not None:
            entries += listed_loops(listed, path, folder, shorts, faults)
            lists.append(folder / listed.source)
    return entries, tuple(lists)


def _loops(
    entries: list[LoopEntry], kinds: Mapping[str, Kind | None], faults: list[str]
) -> tuple[LoopSettings, ...]:
    loops = []
    for entry in entries:
        own: list[str] = []
        joined = {
            **entry.raw,
            "tags": _tags(entry.raw, kinds, entry.place, own),
            "publish": _targets(entry.raw, kinds, entry.place, own),
        }
        loop = checked(LoopSettings, joined, entry.place, own)
        if loop is not None:
            loops.append(loop)
        faults += [entry.located(fault) for fault in own]
    places: dict[str, list[str]] = {}
    for entry in entries:
        if "name" in entry.raw:
            places.setdefault(str(entry.raw["name"]), []).append(entry.place)
    faults += [
        f"loops: {len(same)} loops are called {name} ({'; '.join(same)})"
        for name, same in places.items()
        if len(same) > 1
    ]
    return tuple(loops)


def _tags(
    loop: Mapping[str, Any], kinds: Mapping[str, Kind | None], path: str, faults: list[str]
) -> dict[str, Options]:
    kind = _kind(loop, kinds, path, faults)
    raw = loop.get("tags")
    if not isinstance(raw, Mapping):
        faults.append(f"{path}.tags: expected a mapping of pv and op to their addresses")
        return {}
    faults += [f"{path}.tags.{role}: is missing" for role in ("pv", "op") if role not in raw]
    if kind is None:
        return {}
    if not kind.roles:
        faults.append(f"{path}.connection: {loop.get('connection')} is {kind.kind}, nothing is read from it")
        return {}
    tags = {}
    for role, tag in raw.items():
        if role not in kind.roles:
            faults.append(f"{path}.tags.{role}: expected one of {', '.join(kind.roles)}")
        elif (found := checked(kind.tag, tag, f"{path}.tags.{role}", faults)) is not None:
            tags[str(role)] = found
    return tags


def _targets(
    loop: Mapping[str, Any], kinds: Mapping[str, Kind | None], path: str, faults: list[str]
) -> tuple[Target, ...]:
    raw = loop.get("publish") or []
    if not isinstance(raw, list):
        faults.append(f"{path}.publish: expected a list")
        return ()
    targets = []
    for index, entry in enumerate(raw):
        place = f"{path}.publish.{index}"
        if not isinstance(entry, Mapping):
            faults.append(f"{place}: expected a mapping with a key connection")
            continue
        kind = _kind(entry, kinds, place, faults)
        if kind is not None and (target := checked(kind.target, entry, place, faults)) is not None:
            targets.append(target)
    return tuple(targets)


def _kind(
    entry: Mapping[str, Any], kinds: Mapping[str, Kind | None], path: str, faults: list[str]
) -> Kind | None:
    """Return the kind of the connection that an entry names; None, with a fault, where it does not exist."""
    name = str(entry.get("connection"))
    if name not in kinds:
        known = ", ".join(kinds) or "none"
        faults.append(f"{path}.connection: no connection is called {name} (there are: {known})")
        return None
    return kinds[name]


def _mappings(raw: object) -> Iterator[tuple[str, Mapping[str, Any]]]:
    if isinstance(raw, Mapping):
        yield from ((str(name), entry) for name, entry in raw.items() if isinstance(entry, Mapping))
