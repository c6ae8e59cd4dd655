"""Several recordings of one loop compared with one model: reading as ever, an answer of its own."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from agent.cli.comparing.outputs import report_part
from agent.report.comparison_text import is_printed, parameter_line

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.several.joint_step import JointStep
    from agent.workbench.several.together import Together

    Recorded = tuple[LoopWindow, Mapping[str, FloatArray]]
    """A recording with its measured inputs by their names, each (n,)."""


def refuse_options(options: Mapping[str, object]) -> None:
    """Refuse what several recordings do not have.

    Raises:
        BadParameter: One of them was chosen.
    """
    for name, value in options.items():
        if value:
            words = (
                "several recordings are compared by --auto, --base, --without, --effect, --input, --own, "
                "--validate, --json and --report"
            )
            raise typer.BadParameter(words, param_hint=name)


def together(
    recorded: Mapping[str, Recorded],
    base: str,
    without: Sequence[str],
    effects: Sequence[Effect],
    own: Sequence[str],
    run: Map,
    progress: Progress,
    *,
    auto: bool,
    validate: Recorded | None = None,
) -> Together:
    """Compare recordings of one loop, by their names, with one model; raises ValueError where it cannot."""
    from agent.workbench.session import Workbench
    from agent.workbench.several.together import compared_together

    other, other_inputs = (None, {}) if validate is None else validate
    benches = {}
    for name, (window, inputs) in recorded.items():
        try:
            benches[name] = Workbench(
                window,
                base,
                without=without,
                effects=effects,
                inputs=inputs,
                other_inputs=other_inputs,
                run=run,
                progress=progress,
            )
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from error
    for name, bench in benches.items():
        report_part(bench, name)
    return compared_together(benches, own, auto=auto, validate=other)


def names_of(paths: Sequence[Path]) -> list[str]:
    """Return a name of each recording: its file, with a number where two files have one name."""
    seen: Counter[str] = Counter()
    names = []
    for path in paths:
        seen[path.name] += 1
        names.append(path.name if seen[path.name] == 1 else f"{path.name} ({seen[path.name]})")
    return names


def together_json(found: Together) -> str:
    """Return the answer as one line of JSON."""
    content = {
        "recordings": list(found.recordings),
        "left_out": [{"recording": name, "reason": why} for name, why in found.left_out.items()],
        "steps": [
            {
                "effects": list(step.effects),
                "added": step.added,
                "rmse_fit": dict(zip(found.recordings, step.rmse, strict=True)),
                "rmse_held_out": dict(zip(found.recordings, step.rmse_held_out, strict=True)),
                "rmse_validation": step.rmse_validation,
                "parameters": _shared(step),
                "own": dict(zip(found.recordings, step.fitted.own(), strict=True)),
            }
            for step in found.steps
        ],
        "candidates": [
            {
                "effect": each.effect,
                "family": each.family,
                "criterion": each.criterion,
                "error_reduction_percent": each.error_reduction_percent,
                "objection": each.objection,
            }
            for each in found.candidates
        ],
        "verdict": {
            "kind": found.verdict.kind,
            "effect": found.verdict.effect,
            "family": found.verdict.family,
            "indistinguishable": list(found.verdict.indistinguishable),
            "lacks": list(found.verdict.lacks),
        },
        "not_validated": found.not_validated,
    }
    return json.dumps(content, allow_nan=False)


def together_lines(found: Together) -> Iterator[str]:
    """Yield the answer in words."""
    for name, why in found.left_out.items():
        yield f"{name} is left out: {why}"
    if found.not_validated is not None:
        yield f"{found.not_validated}; the rest goes on without it"
    yield f"one model over {', '.join(found.recordings)}: RMSE in PV units"
    yield f"  {'model':28}{'recording':24}{'fit':>10}{'held out':>10}"
    for step in found.steps:
        for i, name in enumerate(found.recordings):
            model = ("base" if step.added is None else f"+ {step.added}") if i == 0 else ""
            yield f"  {model:28}{name:24}{step.rmse[i]:>10.4g}{step.rmse_held_out[i]:>10.4g}"
        if step.rmse_validation is not None:
            yield f"  {'':28}{'validation':24}{'':>10}{step.rmse_validation:>10.4g}"
    yield "what all recordings share, with 90 % intervals"
    for each in found.steps[-1].fitted.shared():
        yield parameter_line(each)
    for name, own in zip(found.recordings, found.steps[-1].fitted.own(), strict=True):
        printed = (f"{key} {value:.4g}" for key, value in own.items() if is_printed(key))
        yield f"  {name:28}{', '.join(printed)}"
    if found.candidates:
        yield "what would make them likelier, twice a logarithm, and lower the held-out squared error"
    for tried in found.candidates:
        reason = "" if tried.objection is None else f"  {tried.objection}"
        yield f"  {tried.effect:28}{tried.criterion:>9.1f}{tried.error_reduction_percent:>9.1f} %{reason}"
    yield f"verdict: {found.verdict_words}"


def _shared(step: JointStep) -> dict[str, dict[str, float | str]]:
    """Return what all recordings share, own units, with its interval."""
    return {
        each.name: {"value": each.value, "low": each.low, "high": each.high, "unit": each.unit}
        for each in step.fitted.shared()
    }
