"""The finding that PV does not respond to OP, in words: what was seen, what it may be, what to check."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.response.no_response import NoResponse
    from agent.analysis.response.why_not import NoResponseCause

POSSIBLE: Mapping[NoResponseCause, tuple[str, ...]] = {
    "dead_transmitter": ("dead_transmitter",),
    "no_flow": ("pump_off", "block_valve_closed"),
    "no_signal_or_flow": ("dead_transmitter", "pump_off", "block_valve_closed"),
    "stuck_valve": ("stuck_valve",),
    "unknown": ("stuck_valve", "block_valve_closed", "by_pass_open"),
}
"""What each cause may be; where there are several, OP and PV of one loop do not distinguish them."""
CAUSE_WORDS: Mapping[NoResponseCause, str] = {
    "dead_transmitter": "PV is exactly constant, so its transmitter is dead or its value is held",
    "no_flow": "PV is at zero: the pump is off or a block valve is closed",
    "no_signal_or_flow": "PV fell to zero at once: a dead transmitter, a pump off or a closed block valve",
    "stuck_valve": "PV jumped at the end as from a slip, so the valve was stuck",
    "unknown": "PV is measured, so the valve is stuck, a block valve is closed or a by-pass is open",
}
CHECKS: Mapping[NoResponseCause, str] = {
    "dead_transmitter": "check the transmitter of PV, its impulse lines and the signal in between",
    "no_flow": "check whether the pump runs and the block valves are open; do other loops of the line stand?",
    "no_signal_or_flow": "check whether pump and block valves let it flow, then the transmitter of PV",
    "stuck_valve": "check the valve at once: packing, actuator and air supply; compare the stem with OP",
    "unknown": "compare the position of the stem with OP at the valve, then check by-pass and block valves",
}


def no_response_words(found: NoResponse) -> str:
    """Return the finding as a sentence without its stop."""
    travel = f"OP travelled {100 * found.op_spans:.3g} % of its range while PV stood at {found.level:.4g}"
    return f"PV does not respond to OP: {travel}{_expected(found)}; {CAUSE_WORDS[found.cause]}"


def _expected(found: NoResponse) -> str:
    if found.expected is None:
        return ""
    sure = "" if found.deviations is None else f" ({found.deviations:.2g} standard deviations)"
    return f", where the process would have moved it by about {found.expected:.3g}{sure}"
