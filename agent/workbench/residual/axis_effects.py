"""Which families of effects make a residual follow an axis: what to look for where a model fails there.

Source: reference ``missing_effect.md`` section 4, step 2.
"""

from __future__ import annotations

from collections.abc import Mapping

FAMILIES_ON: Mapping[str, tuple[str, ...]] = {
    "travel_since_reversal": ("valve_hysteresis", "sensor_hysteresis", "process_friction"),
    "direction": ("valve_hysteresis", "valve_speed"),
    "op_level": ("valve_characteristic", "valve_limits", "pv_gain", "process_limits", "valve_hysteresis"),
    "op_rate": ("valve_speed", "extra_lag", "process_dynamics", "process_delay", "valve_hysteresis"),
    "valve_position": ("valve_characteristic", "valve_limits", "pv_gain", "process_limits"),
    "oscillation_phase": ("valve_hysteresis", "extra_lag", "disturbance"),
    "time": ("disturbance", "gain"),
    "time_of_day": ("disturbance",),
    "set_point": ("valve_characteristic", "process_limits"),
}
"""Axis -> families whose effects make such a pattern, the most usual first."""
