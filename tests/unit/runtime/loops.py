"""Loops and samples for the tests of the runtime."""

import numpy as np

from agent.runtime.intake.cut import CutWindow
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
    released = (pushed(window, s, float(k)) for k, s in enumerate(samples))
    return [w for w in released if w is not None]


def pushed(window, each, arrival):
    """The window that a sample releases, None without."""
    due = window.push(each, arrival)
    return None if due is None else window.cut(due).open()


def cut_of(window):
    """What a window is opened from."""
    roles = {role: getattr(window, role) for role in ("op", "pv", "sp", "mv")}
    if window.automatic is not None:
        roles["mode"] = window.automatic
    columns = {role: values.astype(np.float32) for role, values in roles.items() if values is not None}
    told = (window.duplicates, window.clocks_apart, window.unknown_modes)
    return CutWindow(window.loop, window.start, window.ts, columns, window.hints, *told)


def both(times, value=None):
    """PV and OP reported together, PV counting the seconds and OP a tenth of it."""
    for t in times:
        yield sample("pv", t, float(t) if value is None else value)
        yield sample("op", t, t / 10)
