"""How close a loop without friction is to oscillating by itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from simulators.parameters import ControllerParameters, ProcessParameters, ValveParameters


def peak_sensitivity(
    controller: ControllerParameters,
    valve: ValveParameters,
    process: ProcessParameters,
    ts: float,
    sensor: float = 0.0,
) -> float:
    """Peak of |1 / (1 + L)| over frequency; infinite for an unstable loop.

    L is the open loop of controller, valve without friction, process and transmitter (a lag of ``sensor`` s),
    with half a sampling time of delay for the held OP. Values of 1.2 to 2 are well tuned (Astrom, Haegglund:
    Advanced PID Control, 4.6).
    """
    slowest = max((*process.taus, controller.ti, process.delay + ts))
    omega = np.geomspace(1e-3 / slowest, math.pi / ts, 4000)
    s = 1j * omega
    lags = (*process.taus, valve.damping, valve.tau_ip, sensor)
    dead_time = process.delay + ts / 2
    magnitude = controller.kc * np.abs(1 + 1 / (s * controller.ti)) * abs(process.gain)
    phase = np.arctan(omega * controller.ti) - math.pi / 2 - omega * dead_time
    if process.kind == "integrating":
        magnitude = magnitude / omega
        phase = phase - math.pi / 2
    for tau in lags:
        magnitude = magnitude / np.hypot(1, omega * tau)
        phase = phase - np.arctan(omega * tau)
    magnitude = magnitude * np.hypot(1, omega * process.lead)
    phase = phase - np.arctan(omega * process.lead)
    late = phase <= -math.pi
    if late.all() or np.any(magnitude[late & (omega > omega[~late].min())] >= 1):
        return math.inf
    open_loop = magnitude * np.exp(1j * phase)
    return float(np.max(1 / np.abs(1 + open_loop)))
