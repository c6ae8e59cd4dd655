"""Topics made from templates, e.g. ``{site}/{area}/{loop}/stiction``: the plant's own unified namespace."""

from __future__ import annotations

import socket
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from string import Formatter

from connectors.base import ConfigError
from connectors.mqtt.options import MqttOptions, MqttTag, MqttTarget
from connectors.options import LoopTags

MqttLoops = Mapping[str, LoopTags[MqttTag, MqttTarget]]


@dataclass(frozen=True, slots=True)
class Topics:
    """What a connection publishes to, and where people's orders come in."""

    alarms: Mapping[str, tuple[str, ...]]
    """Loop -> topics of its alarm."""
    orders: Mapping[str, str]
    """Topic -> loop; empty where nobody may order."""
    status: str | None
    """Where it says whether it is connected."""
    client: str
    """Who it is there."""


def topics_of(connection: str, options: MqttOptions, loops: MqttLoops) -> Topics:
    """Fill in the templates of a connection; ConfigError with all that is wrong in them."""
    client = options.client or f"{socket.gethostname()}-{connection}"
    faults: list[str] = []
    alarms: dict[str, tuple[str, ...]] = {}
    orders: dict[str, str] = {}
    for loop, each in loops.items():
        known = {**options.variables, **each.variables, "client": client, "loop": loop}
        alarms[loop] = tuple(
            topic
            for target in each.targets
            for topic in _filled(target.topic or options.topic, known, f"loops.{loop}.publish.topic", faults)
        )
        if options.orders:
            place = f"connections.{connection}.order_topic"
            for topic in alarms[loop]:
                orders |= dict.fromkeys(
                    _filled(options.order_topic, {**known, "topic": topic}, place, faults), loop
                )
    faults += [
        f"connections.{connection}: {count} alarms would be published on topic {topic}"
        for topic, count in Counter(topic for each in alarms.values() for topic in each).items()
        if count > 1
    ]
    status = None
    if options.status is not None:
        known = {**options.variables, "client": client}
        status = next(_filled(options.status, known, f"connections.{connection}.status", faults), None)
    if faults:
        raise ConfigError(list(dict.fromkeys(faults)))
    return Topics(alarms, orders, status, client)


def _filled(template: str, variables: Mapping[str, str], place: str, faults: list[str]) -> Iterator[str]:
    """Yield the topic, or add what is wrong."""
    unknown = sorted(set(variables_in(template)) - variables.keys())
    if unknown:
        there = ", ".join(sorted(variables))
        faults += [f"{place}: no variable is called {name} (there are: {there})" for name in unknown]
        return
    topic = template.format_map(variables)
    if topic.startswith("$") or "" in topic.split("/")[1:] or set(topic) & set("+#\0"):
        faults.append(f"{place}: {topic!r} begins with $, or has an empty level, or + or # in it")
    else:
        yield topic


def variables_in(template: str) -> list[str]:
    """Return the names between braces."""
    return [name for _, name, _, _ in Formatter().parse(template) if name is not None]
