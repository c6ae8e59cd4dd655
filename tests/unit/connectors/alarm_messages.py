"""Publications as the agent makes them."""

import time

from connectors.base import Publication


def told(loop, state, kind="state", at=None, **fields):
    """What is told of a loop whose valve sticks, unless ``fields`` say something else."""
    at = time.time() if at is None else at
    known = {
        "message_id": f"{loop}/{at:.3f}/{kind}/{state}",
        "loop": loop,
        "id": f"{loop}/1",
        "active": state in {"unacked_active", "acked_active"},
        "state": state,
        "verdict": "stiction",
        "priority": "high",
        "ne107": "maintenance_required",
        "health": 4,
        "time": at,
        "by": None,
        "until": None,
        "f_s": 2.5,
        "f_d": 1.5,
        "s": 4.0,
        "j": 1.0,
        "sequence": 7,
        "historical": False,
    }
    return Publication(loop, kind, known["message_id"], known | fields)
