"""The sign of the process gain, read from the controller's own arithmetic."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.loop.pi_controller import pi_controller

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

LEAST_EXPLAINED = 0.3
"""Share of the OP increments that the PI law must explain before its sign is believed."""


def process_gain_sign(window: LoopWindow) -> int:
    """Return +1 (reverse acting controller), -1 (direct acting), or 0 if it cannot be determined.

    Negative feedback makes the process gain and the controller gain agree in sign, and the controller gain is
    in the record: OP is computed from the error by dOP = K_c (de + Ts/T_i e), so a regression of the OP
    increments on de and e gives its sign (derived). A configured sign has priority.
    """
    if window.hints.acting is not None:
        return 1 if window.hints.acting == "reverse" else -1
    controller = pi_controller(window)
    if controller is None:
        return 0
    agree = np.sign(controller.kc) == np.sign(controller.ki)
    return int(np.sign(controller.kc)) if agree and controller.explained > LEAST_EXPLAINED else 0
