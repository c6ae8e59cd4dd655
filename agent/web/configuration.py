"""The configuration file as the page changes it: checked, tried on the bus, saved, applied by the agent."""

from __future__ import annotations

import asyncio
import difflib
import hashlib
import logging
import math
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import yaml

from agent.runtime.agent import Agent
from agent.runtime.commission.probe import Finding, probe
from agent.settings import Settings, settings_of
from agent.settings.edit import Part, edited, entry_yaml, written
from agent.settings.load import load_settings
from connectors.base import ConfigError
from connectors.kinds import KINDS

LOG = logging.getLogger(__name__)
PROBED = 6.0
"""Longest wait for a value of each tag, s: some polls of a slow device, and a person still waits."""
LISTENING = frozenset(kind.kind for kind in KINDS if kind.listens)
What = Literal["loop", "connection"]
PARTS: dict[What, Part] = {"loop": "loops", "connection": "connections"}


@dataclass(frozen=True, slots=True)
class EntryChange:
    """One entry as it shall be."""

    what: What
    name: str
    text: str
    """YAML of the entry."""


@dataclass(frozen=True, slots=True)
class Proposal:
    """What became of a change that was checked."""

    faults: tuple[str, ...]
    """Empty where it can be saved."""
    text: str
    """Of the whole file; empty where the change cannot be written."""
    difference: str
    """Lines that change, as a unified diff."""
    settings: Settings | None
    digest: str
    """Of the file as it was read."""


class Configuration:
    """Reads and writes one file; only one request does at a time."""

    def __init__(self, path: Path, agent: Agent) -> None:
        """Make it.

        Args:
            path: The file that the agent was started with.
            agent: Applies what is saved.
        """
        self.path = path
        self._agent = agent
        self._one = asyncio.Lock()

    async def entries(self) -> dict[str, Any]:
        """Return connections and loops of the file: name, kind or connection, and how they are written."""
        return {"file": str(self.path)} | await asyncio.to_thread(_entries, await self._read())

    async def checked(self, change: EntryChange) -> Proposal:
        """Return what a change would do to the file, or its faults."""
        text = await self._read()
        try:
            changed = await asyncio.to_thread(edited, text, PARTS[change.what], change.name, change.text)
        except RecursionError:
            return Proposal(("it is nested too deeply",), "", "", None, _digest(text))
        except (ValueError, yaml.YAMLError) as error:  # ``EditError``, and a date that there is not
            return Proposal((" ".join(str(error).split()),), "", "", None, _digest(text))
        lines = difflib.unified_diff(text.splitlines(), changed.splitlines(), lineterm="", n=2)
        difference = "\n".join([*lines][2:])
        try:
            settings = await asyncio.to_thread(_settings, changed, self.path.parent)
        except ConfigError as error:
            return Proposal(tuple(error.faults), changed, difference, None, _digest(text))
        return Proposal((), changed, difference, settings, _digest(text))

    async def tried(self, change: EntryChange, settings: Settings) -> tuple[Finding, ...]:
        """Return what the bus answers: each tag of a loop is read once; a connection is opened."""
        if change.what == "connection":
            if settings.connections[change.name].kind in LISTENING:
                return ()  # the agent itself listens there: nobody is to be reached
            alone = replace(settings, connections={change.name: settings.connections[change.name]}, loops=())
        else:
            loop = next(each for each in settings.loops if each.name == change.name)
            alone = replace(
                settings,
                connections={loop.connection: settings.connections[loop.connection]},
                loops=(loop.model_copy(update={"publish": ()}),),
            )
        return await probe(alone, PROBED)

    async def saved(self, change: EntryChange, digest: str, by: str) -> Sequence[str]:
        """Write the file and apply it; return why not, empty where it was done.

        Args:
            change: What is saved.
            digest: Of the file that the change was made for: a file that changed since is not overwritten.
            by: Who saves it, for the log.
        """
        async with self._one:
            proposal = await self.checked(change)
            if proposal.digest != digest:
                return ("the file was changed since this page read it: load it anew",)
            if proposal.faults:
                return proposal.faults
            before = await self._read()
            await asyncio.to_thread(_write, self.path, proposal.text)
            try:
                await self._agent.reload(await asyncio.to_thread(load_settings, self.path))
            except ConfigError as error:
                await asyncio.to_thread(_write, self.path, before)
                return tuple(error.faults)
        LOG.info(
            "%s %s was saved in %s by %s",
            change.what,
            change.name,
            self.path,
            by,
            extra={"event": "configured"},
        )
        return ()

    async def _read(self) -> str:
        return await asyncio.to_thread(self.path.read_text, encoding="utf-8")


def findings_json(findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return what the bus answered, a row a connection or tag."""
    return [_finding_json(each) for each in findings if each.what != "target"]


def _finding_json(finding: Finding) -> dict[str, Any]:
    value = None if finding.reading is None else finding.reading.sample.value
    return {
        "what": finding.what,
        "role": finding.place,
        "value": None if isinstance(value, float) and not math.isfinite(value) else value,
        "quality": None if finding.reading is None else finding.reading.sample.quality.name.lower(),
        "problems": list(finding.problems),
        "remarks": list(finding.remarks),
    }


def form_yaml(entry: dict[str, Any]) -> str:
    """Return what a form holds as YAML, without what was left empty."""
    return entry_yaml(_filled(entry))


def _filled(entry: dict[str, Any]) -> dict[str, Any]:
    filled = {key: _filled(value) if isinstance(value, dict) else value for key, value in entry.items()}
    return {key: value for key, value in filled.items() if value not in (None, "", {}, [])}


def _entries(text: str) -> dict[str, Any]:
    """Return what a file holds, as the page shows it."""
    raw, as_written = yaml.safe_load(text), written(text)
    loops = [each for each in raw.get("loops") or [] if isinstance(each, dict)]
    return {
        "digest": _digest(text),
        "connections": [
            {"name": name, "kind": each.get("kind"), "yaml": as_written["connections"].get(str(name))}
            for name, each in (raw.get("connections") or {}).items()
        ],
        "loops": [
            {
                "name": each["name"],
                "connection": each.get("connection"),
                "entry": _plain(each),
                "yaml": as_written["loops"].get(str(each["name"])),
            }
            for each in loops
            if "name" in each
        ],
        "lists": [str(each["from"]) for each in loops if "from" in each],
    }


def _settings(text: str, folder: Path) -> Settings:
    return settings_of(yaml.safe_load(text), folder)


def _plain(entry: dict[str, Any]) -> dict[str, Any]:
    """Return an entry of the file as JSON has it; dates and the like as text."""
    found: dict[str, Any] = yaml.safe_load(yaml.safe_dump(entry))
    return found


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _write(path: Path, text: str) -> None:
    """Replace a file whole or not at all; it keeps its mode."""
    target = path.resolve()
    number, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    try:
        with os.fdopen(number, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        Path(name).chmod(target.stat().st_mode & 0o777)
        Path(name).replace(target)
    except OSError:
        Path(name).unlink(missing_ok=True)
        raise
