"""What was understood of a file, as a YAML file that a person corrects and other commands take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from connectors.exports.cells.clock_numbers import CLOCKS
from connectors.exports.cells.times import TimeOptions
from connectors.exports.fault import RecordingError
from connectors.exports.recorded import ReadOptions

if TYPE_CHECKING:
    from pathlib import Path

    from connectors.exports.recorded import Export

Role = Literal["PV", "OP", "SP", "MV", "mode"]


class _Mapping(BaseModel):
    """The content of a mapping file."""

    model_config = ConfigDict(extra="forbid")

    zone: str | None = None
    time_format: str | None = None
    date_order: Literal["dmy", "mdy", "ymd"] | None = None
    decimal: Literal[".", ","] | None = None
    pattern: str | None = None
    ts: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    loops: Mapping[str, Mapping[Role, str]] = {}
    modes: Mapping[str | int | float, Literal["automatic", "manual"]] = {}


def mapping_text(export: Export, options: ReadOptions) -> str:
    """Return the mapping of a file as YAML."""
    counted = export.time_form if export.time_form in CLOCKS else None
    tags = [tag for loop in export.loops for tag in loop.tags.values()]
    named = len(tags) == len(set(tags))  # else each table of an archive has the same names
    known = {
        "zone": options.times.zone or (export.zone if export.zone not in {"", "as written"} else None),
        "time_format": options.times.form or counted,
        "date_order": options.times.order,
        "decimal": options.decimal or (export.decimal if len(export.decimal) == 1 else None),
        "ts": options.columns.ts,
        "loops": {loop.name: dict(loop.tags) for loop in export.loops} if named else None,
        "modes": {word: "automatic" if means else "manual" for word, means in options.modes.items()} or None,
    }
    stated = {key: value for key, value in known.items() if value is not None}
    return yaml.safe_dump(stated, sort_keys=False, allow_unicode=True)


def _word(mode: str | float) -> str:
    """Return a word of the mode as the analysis looks it up."""
    return f"{mode:g}" if isinstance(mode, float) else str(mode).strip().casefold()


def with_mapping(options: ReadOptions, path: Path) -> ReadOptions:
    """Return the options with what a mapping file states; options that the user gives himself come first.

    Raises:
        RecordingError: It cannot be read, or holds other keys or values.
    """
    try:
        found = _Mapping.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")) or {})
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(
            f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from error
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f", line {mark.line + 1}" if mark is not None else ""
        raise RecordingError(f"{path}{line}: expected YAML: {getattr(error, 'problem', error)}") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise RecordingError(f"{path}: {place}: {first['msg']}") from error
    times = options.times
    return replace(
        options,
        columns=options.columns if options.columns.ts is not None else replace(options.columns, ts=found.ts),
        times=TimeOptions(
            times.zone or found.zone, times.form or found.time_format, times.order or found.date_order
        ),
        decimal=options.decimal or found.decimal,
        pattern=options.pattern or found.pattern,
        modes={_word(each): means == "automatic" for each, means in found.modes.items()}
        | dict(options.modes),
        loops=options.loops
        or {loop: {str(role): tag for role, tag in roles.items()} for loop, roles in found.loops.items()},
    )
