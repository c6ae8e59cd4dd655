"""The JSON object of a diagnosis as one flat row, and the type of each of its columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from agent.analysis.diagnose import DEFAULT_QUANTIFIER
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.stiction import DETECTORS
from agent.report.diagnosis_json import diagnosis_json

ColumnType = Literal["number", "truth", "text", "texts", "numbers", "shares"]
TYPES: Mapping[str, ColumnType] = {
    **dict.fromkeys(("recording", "loop", "verdict", "cause", "class", "process.kind"), "text"),
    **dict.fromkeys(("oscillation.detected", "stiction.identifiable.s", "stiction.identifiable.j"), "truth"),
    **dict.fromkeys(("no_response.found", "sticks.suspected"), "truth"),
    **dict.fromkeys(("reasons", "advice", "no_response.possible"), "texts"),
    "no_response.cause": "text",
    "no_response.samples": "numbers",
    **{f"process.intervals.{name}": "numbers" for name in ("gain", "tau_s", "delay_s")},
    "causes": "shares",
}
"""Of the columns that are no numbers; those of ``methods`` go by their last part."""
OF_A_METHOD: Mapping[str, ColumnType] = {"verdict": "text", "index": "number", "reason": "text"}


def flat(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row whose nested objects became keys with dots; lists stay."""
    return dict(_leaves("", row))


def _leaves(prefix: str, content: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in content.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping):
            yield from _leaves(f"{name}.", value)
        elif value is not None or not any(known.startswith(f"{name}.") for known in TYPES):
            yield name, value


def standard_columns() -> dict[str, ColumnType]:
    """Return the columns that every survey has, whatever was found, with their types."""
    nothing = diagnosis_json(Diagnosis("", "not_testable", 0.0, "undecided", (), None, None, None), "")
    found: dict[str, ColumnType] = {}
    for name in nothing:
        match name:
            case "methods":
                for method in (DEFAULT_QUANTIFIER, *(each.name for each in DETECTORS)):
                    found |= {f"methods.{method}.{part}": kind for part, kind in OF_A_METHOD.items()}
            case "process":
                found |= {key: column_type(key) for key in flat({name: nothing[name]})}
                found |= {key: kind for key, kind in TYPES.items() if key.startswith("process.intervals.")}
            case _:
                found |= {key: column_type(key) for key in flat({name: nothing[name]})}
    return found


def column_type(name: str) -> ColumnType:
    """Return the type of a column by its name."""
    if name.startswith("methods."):
        return OF_A_METHOD[name.rsplit(".", 1)[1]]
    return TYPES.get(name, "number")
