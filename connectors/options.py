"""What the options of every bus have in common."""

from __future__ import annotations

import ipaddress
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Generic, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field

Port = Annotated[int, Field(ge=1, le=65535)]
Seconds = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Options(BaseModel):
    """A part of the configuration file; an unknown key is a fault. The schema gets the fields' docstrings."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)

    def as_guest(self) -> Self:
        """Return the options of a connection for somebody who only looks, beside an agent that may run."""
        return self


class NoTag(Options):
    """Address on a bus that nothing is read from; its kind has no ``roles``, so there never is one."""


class Target(Options):
    """One entry of a loop's ``publish``: where its alarm is published."""

    connection: str
    """Name of the connection that carries the alarm; it need not be the one that is read."""


TagT = TypeVar("TagT", bound=Options)
TargetT = TypeVar("TargetT", bound=Target)


@dataclass(frozen=True, slots=True)
class LoopTags(Generic[TagT, TargetT]):
    """What one connection reads and writes for one loop; either may be empty."""

    tags: Mapping[str, TagT]
    """Role -> where its value is found."""
    targets: Sequence[TargetT] = ()
    """Where the loop's alarm is published."""
    variables: Mapping[str, str] = field(default_factory=dict)
    """Name -> what stands for ``{name}`` in the names of a bus, e.g. topics."""


def is_loopback(host: str) -> bool:
    """Whether what listens on this address is reached from this machine only."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
