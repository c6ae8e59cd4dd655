"""Loops and samples for the tests of the runtime."""

from agent.settings import AlarmSettings, LoopSettings, WindowSettings
from connectors.base import LoopRole, Quality, Sample
from connectors.options import Options

START = 1.7e9
"""Source time of the first sample, s UTC."""


def loop_settings(name="FIC101", roles=("pv", "op"), ts=1.0, seconds=40.0, hop=0.5, alarm=None, **others):
    window = others.pop("window", WindowSettings(seconds=seconds, hop=hop))
    return LoopSettings(
        name=name,
        connection=others.pop("connection", "bus"),
        ts=ts,
        tags={role: Options() for role in roles},
        window=window,
        alarm=alarm or AlarmSettings(on_delay=1, off_delay=1),
        **others,
    )


def sample(role, time, value, quality=Quality.GOOD, loop="FIC101"):
    return Sample(LoopRole(loop, role), START + time, value, quality)


def push_all(window, samples):
    """The windows released by samples that arrive one second apart."""
    released = (window.push(s, float(k)) for k, s in enumerate(samples))
    return [w for w in released if w is not None]
