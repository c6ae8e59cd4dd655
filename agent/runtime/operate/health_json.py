"""The state of the daemon as the JSON object of /health."""

from __future__ import annotations

import json

from agent.runtime.operate.breath import breathing
from agent.runtime.operate.status import AgentStatus, ConnectionStatus, LoopStatus


async def health_text(status: AgentStatus) -> str:
    """Return the object: all keys are always there, null is not known (docs/howto/monitoring.md)."""
    agent = json.dumps(agent_json(status))
    loops = [f"{json.dumps(each.loop)}:{json.dumps(_loop(each))}" async for each in breathing(status.loops)]
    return f'{agent[:-1]}, "loops": {{{",".join(loops)}}}}}'


def agent_json(status: AgentStatus) -> dict[str, object]:
    """Return what is not of single loops."""
    return {
        "status": "hung" if status.hung else "ok" if status.ok else "degraded",
        "hung": list(status.hung),
        "faults": status.faults,
        "store_error": status.store_problem or None,
        "store_failures": status.store_failures,
        "history_dropped": status.history_dropped,
        "orders": {"taken": status.orders_taken, "refused": status.orders_refused},
        "worker_queue": status.queued,
        "connections": {each.connection: _connection(each) for each in status.connections},
    }


def _connection(status: ConnectionStatus) -> dict[str, object]:
    return {
        "kind": status.bus,
        "up": status.up,
        "error": status.problem or None,
        "losses": status.losses,
        "faults": status.faults,
        "malformed": status.malformed,
        "lost": status.lost,
        "outbox": {
            "waiting": status.waiting,
            "refused": status.refused,
            "oldest_s": _seconds(status.oldest),
            "dropped": status.dropped,
            "refusals": status.refusals,
        },
    }


def _loop(status: LoopStatus) -> dict[str, object]:
    return {
        "connection": status.connection,
        "data": status.data,
        "data_age_s": _seconds(status.data_age),
        "samples": status.samples,
        "bad": status.bad,
        "odd_times": status.odd_times,
        "gaps": status.gaps,
        "superseded": status.superseded,
        "busy": status.busy,
        "verdict": None if status.diagnosis is None else status.diagnosis.verdict,
        "verdict_age_s": _seconds(status.verdict_age),
        "alarm": status.alarm.value,
        "faults": status.faults,
        "error": status.problem or None,
    }


def _seconds(value: float | None) -> float | None:
    return None if value is None else round(value, 3)
