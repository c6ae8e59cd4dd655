"""The ISA-18.2 alarm life cycle; pure."""

from agent.alarms.alarm import Alarm, Announcement, Priority
from agent.alarms.command import Command
from agent.alarms.delay import Delay
from agent.alarms.device_health import DeviceHealth
from agent.alarms.state import Event, State

__all__ = ["Alarm", "Announcement", "Command", "Delay", "DeviceHealth", "Event", "Priority", "State"]
