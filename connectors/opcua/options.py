"""The OPC UA part of the configuration file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from connectors.options import Options, Seconds, Target

NodeId = Annotated[str, Field(pattern=r"^(ns=\d+;)?[isgb]=.+$", examples=["ns=2;s=FIC101.PV"])]


class OpcUaOptions(Options):
    """One OPC UA server."""

    url: Annotated[
        str,
        Field(
            pattern=r"^opc\.tcp://(\[[0-9a-fA-F:]+\]|[^/:@\s]+)(:\d{1,5})?(/\S*)?$",
            examples=["opc.tcp://127.0.0.1:4840"],
        ),
    ]
    publishing_interval: Seconds = 0.5
    """Time between two notifications of the server, s."""
    sampling_interval: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """How often the server looks at a node, s; 0: as often as it can."""
    queue: Annotated[int, Field(ge=1, le=10_000)] = 100
    """Values the server keeps for a node between two notifications."""
    keep_alive: Annotated[int, Field(ge=1, le=1000)] = 10
    """Publishing intervals without a change after which the server must say that it is alive."""
    timeout: Seconds = 4.0
    """Longest wait for an answer, s; after that the server counts as gone."""
    retry: Seconds = 30.0
    """How often a node that was not found is asked for again, s."""


class OpcUaTag(Options):
    """A node, to be read or written."""

    node: NodeId


class OpcUaTarget(Target):
    """Where a loop's alarm is written; events are not, as a node keeps only the newest."""

    active: OpcUaTag | None = None
    """Node that is true while the alarm is active."""
    fields: Mapping[str, OpcUaTag] = {}
    """Field of the alarm -> node, which gets it in its own type.

    Not known is NaN, or empty text; a node of another type keeps what it had.
    """
