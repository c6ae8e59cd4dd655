"""The ISA-18.2 alarm life cycle; pure."""

from agent.alarms.alarm import Alarm, Announcement, Priority
from agent.alarms.delay import Delay
from agent.alarms.state import Event, State

__all__ = ["Alarm", "Announcement", "Delay", "Event", "Priority", "State"]
