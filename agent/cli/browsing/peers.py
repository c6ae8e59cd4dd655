"""What can be browsed, by the scheme of its address: an OPC UA server, an MQTT broker."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import urlsplit

from connectors.base import ConfigError
from connectors.options import Options

if TYPE_CHECKING:
    from agent.runtime.commission.found_loops import LoopSearch

    Progress = Callable[[int, int], None]
    Search = Callable[[Mapping[str, str], Progress], Coroutine[Any, Any, LoopSearch]]

ADDRESSES = ("opc.tcp://HOST:PORT", "mqtt://HOST:PORT", "mqtts://HOST:PORT")
SECONDS_OF_SERVER, SECONDS_OF_BROKER = 120.0, 30.0
"""How long is looked unless the user says: a server is walked, a broker heard while its clients publish."""
EVERY_TOPIC = "#"
MQTT_PORT, MQTTS_PORT = 1883, 8883
"""Registered for them (IANA)."""
OptionsT = TypeVar("OptionsT", bound=Options)


@dataclass(frozen=True, slots=True)
class BrowseRequest:
    """What the user gave."""

    url: str
    root: str | None
    """Node, or filter of topics, to begin at."""
    depth: int
    nodes: int
    within: float | None
    """s; None: as above."""
    security: Mapping[str, str]
    """Key of the security of OPC UA -> file or name."""
    login: Mapping[str, Any]
    """User and password, as in a configuration."""


@dataclass(frozen=True, slots=True)
class Browsed:
    """Something that can be browsed."""

    entry: Mapping[str, object]
    """Of ``connections`` in a configuration."""
    search: Search
    unit: str
    """What its progress counts."""


def peer_of(wanted: BrowseRequest) -> Browsed:
    """Return what an address means; raises ConfigError with all that is wrong."""
    scheme = wanted.url.partition("://")[0]
    if scheme in {"mqtt", "mqtts"}:
        return _broker(wanted, encrypted=scheme == "mqtts")
    if scheme == "opc.tcp":
        return _server(wanted)
    raise ConfigError([f"{wanted.url}: expected {', '.join(ADDRESSES[:-1])} or {ADDRESSES[-1]}"])


def _server(wanted: BrowseRequest) -> Browsed:
    from agent.runtime.commission.loop_search import find_loops
    from connectors.opcua.browse import OBJECTS, Bounds
    from connectors.opcua.options import OpcUaOptions

    entry = {"url": wanted.url} | given({"security": wanted.security, "login": wanted.login})
    options = _checked(OpcUaOptions, entry)
    bounds = Bounds(wanted.depth, wanted.nodes, wanted.within or SECONDS_OF_SERVER)
    return Browsed(
        {"kind": "opcua", **entry},
        lambda patterns, progress: find_loops(options, bounds, wanted.root or OBJECTS, patterns, progress),
        "nodes known so far",
    )


def _broker(wanted: BrowseRequest, *, encrypted: bool) -> Browsed:
    from agent.runtime.commission.published_loops import find_published_loops
    from connectors.mqtt.options import MqttOptions

    tls = {key: wanted.security[key] for key in ("ca", "certificate", "key") if key in wanted.security}
    faults = [f"--{key.replace('_', '-')}: only of OPC UA" for key in wanted.security if key not in tls]
    address = urlsplit(wanted.url)
    shown = wanted.url.replace(f"{address.netloc.rpartition('@')[0]}@", "")  # it may hold a password
    try:
        port = address.port or (MQTTS_PORT if encrypted else MQTT_PORT)
    except ValueError:
        port = 0
    if not port or not address.hostname or address.path.strip("/") or address.username:
        faults.append(f"{shown}: expected mqtt://HOST:PORT; topics by --root, a user by --user")
    if tls and not encrypted:
        faults.append(f"{shown}: files for TLS, but only mqtts:// is encrypted")
    if faults:
        raise ConfigError(faults)
    entry: dict[str, object] = {"host": address.hostname, "port": port, **wanted.login}
    if encrypted:
        entry["tls"] = tls
    options = _checked(MqttOptions, entry).as_guest()
    topics, seconds = wanted.root or EVERY_TOPIC, wanted.within or SECONDS_OF_BROKER
    return Browsed(
        {"kind": "mqtt", **entry},
        lambda patterns, progress: find_published_loops(
            options, topics, seconds, wanted.nodes, patterns, progress
        ),
        "s",
    )


def _checked(model: type[OptionsT], entry: Mapping[str, object]) -> OptionsT:
    from agent.settings.checked import checked

    faults: list[str] = []
    options = checked(model, entry, "", faults)
    if options is None:
        raise ConfigError(faults)
    return options


def given(entries: Mapping[str, object]) -> dict[str, Any]:
    """Return what the user gave."""
    return {name: value for name, value in entries.items() if value}
