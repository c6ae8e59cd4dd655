"""Node ids of the server: text that a person can read and that stays the same over restarts."""

from __future__ import annotations

from dataclasses import dataclass

from asyncua import ua

NAMESPACE = "urn:slipjump"


@dataclass(frozen=True, slots=True)
class Names:
    """Makes node ids."""

    index: int
    """Of our namespace."""

    def of(self, text: str) -> ua.NodeId:
        """Return the node id with this text."""
        return ua.NodeId(text, self.index)

    def browse(self, name: str) -> ua.QualifiedName:
        """Return a name of ours."""
        return ua.QualifiedName(name, self.index)

    @property
    def folder(self) -> ua.NodeId:
        """Where all of ours is."""
        return self.of("/slipjump")  # a loop may be called anything without a slash

    @property
    def alarm_type(self) -> ua.NodeId:
        """Our type of alarm."""
        return self.of("/StictionAlarmType")

    def loop(self, loop: str) -> ua.NodeId:
        """Object of a loop."""
        return self.of(loop)

    def variable(self, loop: str, name: str) -> ua.NodeId:
        """One of the loop's variables."""
        return self.of(f"{loop}.{name}")

    def condition(self, loop: str) -> ua.NodeId:
        """Alarm of the loop: its ConditionId."""
        return self.of(f"{loop}.Alarm")

    def shelving(self, loop: str) -> ua.NodeId:
        """Object of the alarm that shelves it."""
        return self.of(f"{loop}.Alarm.ShelvingState")
