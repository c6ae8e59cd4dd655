"""A session of the workbench as JSON for the browser, which only draws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agent.report.comparison_json import not_shown_json
from agent.report.comparison_text import causes_words, evidence_words, step_name, verdict_words
from agent.report.headline import capital, headline
from agent.web.rows import numbers, plain
from agent.web.workbench.same_lines import command_of, python_of
from agent.workbench.residual.axes import UNITS

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.web.workbench.same_lines import ReadSource
    from agent.workbench.comparison import Comparison
    from agent.workbench.session.step_tree import StepTree, TreeNode

MOST_POINTS = 4000
"""Of a curve; longer ones are thinned."""
SCATTER = 1200
"""Points of the residual against an axis."""


def tree_json(tree: StepTree, source: ReadSource, columns: dict[str, str]) -> dict[str, Any]:
    """Return all that the page draws of the node that is looked at.

    Args:
        tree: The session.
        source: What was read, and how.
        columns: Role -> column that it was read from.
    """
    window = tree.window
    own = {
        "recording": source.recording,
        "loop": window.loop,
        "columns": columns,
        "samples": len(window),
        "ts": window.ts,
        "reason": tree.reason,
    }
    if tree.reason is not None:
        return own | {"nodes": [], "current": 0, "model": None, "found": None}
    node = tree.node
    return own | {
        "nodes": [_node(tree, each) for each in tree.nodes],
        "current": tree.current,
        "path": _path(tree),
        "model": _model(node),
        "found": None if node.comparison is None else _found(node.comparison),
        "command": command_of(source, node),
        "python": python_of(source, node),
    }


def axis_json(tree: StepTree, axis: str) -> dict[str, Any]:
    """Return the residual of the node against one axis: bins, band and points.

    Raises:
        ValueError: There is no such axis.
    """
    node = tree.node
    node.bench.restore(node.steps)
    panels = {each.axis: each for each in node.bench.where_it_fails()}
    if axis not in panels:
        raise ValueError(f"there is no axis {axis!r}; there are {', '.join(panels)}")
    panel = panels[axis]
    x, residual = node.bench.against(axis)
    every = max(1, len(x) // SCATTER)
    return {
        "axis": axis,
        "unit": UNITS[axis],
        "share": plain(panel.share),
        "p": plain(panel.p),
        "causes": causes_words(axis),
        "edges": numbers(panel.bin_edges),
        "means": numbers(panel.bin_means),
        "low": numbers(panel.band_low),
        "high": numbers(panel.band_high),
        "x": numbers(x[::every], 5),
        "residual": numbers(residual[::every], 5),
        "time": numbers(node.bench.record.facts.ts * np.arange(len(x))[::every].astype(np.float64), 7),
    }


def curve_json(pv: FloatArray, samples: int) -> list[float | None] | None:
    """Return a curve, thinned as those of the model."""
    return numbers(pv[:: _every(samples)], 5)


def _every(samples: int) -> int:
    return -(-samples // MOST_POINTS)


def _node(tree: StepTree, node: TreeNode) -> dict[str, Any]:
    step = node.step
    name = step_name(step)
    return {
        "number": node.number,
        "parent": node.parent,
        "name": f"{name}, {node.change}" if node.change else name,
        "effects": list(step.effects),
        "rmse_fit": plain(step.rmse_fit),
        "rmse_held_out": plain(step.held_out.rmse),
        "rmse_validation": plain(tree.rmse_validation(node)),
        "fit_percent": plain(step.fit_percent),
        "verdict": None if step.verdict is None else step.verdict.kind,
    }


def _path(tree: StepTree) -> list[int]:
    """Return the numbers of the nodes from the root to the one that is looked at."""
    path: list[int] = []
    number: int | None = tree.current
    while number is not None:
        path.append(number)
        number = tree.nodes[number].parent
    return path[::-1]


def _model(node: TreeNode) -> dict[str, Any]:
    record, step = node.bench.record, node.step
    every = _every(len(record))
    pv = np.where(record.weight > 0, record.pv, np.nan)
    curves = {"op": record.op, "pv": pv, "model": step.fit.pv, "residual": pv - step.fit.pv}
    stated = {each.name: each for each in step.parameters}
    parameters = []
    named = step.fit.model.parameters(record.facts)
    for (name, parameter), value in zip(named, step.fit.values.tolist(), strict=True):
        each = stated[name]
        parameters.append(
            {
                "name": name,
                "unit": parameter.unit,
                "low_bound": plain(parameter.low),
                "high_bound": plain(parameter.high),
                "log": parameter.log,
                "fitted": plain(value),
                "value": plain(each.value),
                "low": plain(each.low),
                "high": plain(each.high),
                "at_bound": each.at_bound,
            }
        )
    return {
        "effects": list(step.effects),
        "parameters": parameters,
        "step": record.facts.ts * every,
        "curves": {name: numbers(values[::every], 5) for name, values in curves.items()},
        "rmse": plain(step.held_out.rmse),
        "fit_percent": plain(step.fit_percent),
        "left_out": [list(each) for each in node.left_out],
    }


def _found(found: Comparison) -> dict[str, Any]:
    verdict, floor = found.verdict, found.noise_floor
    return {
        "headline": headline(found),
        "verdict": {
            "kind": verdict.kind,
            "effect": verdict.effect,
            "family": verdict.family,
            "indistinguishable": list(verdict.indistinguishable),
            "words": verdict_words(verdict, found),
            "test": None if found.next_test is None else capital(f"{found.next_test.words}."),
        },
        "axes": [
            {
                "axis": each.axis,
                "share": plain(each.share),
                "p": plain(each.p),
                "unit": UNITS[each.axis],
                "causes": causes_words(each.axis),
            }
            for each in found.where_it_fails
        ],
        "candidates": [
            {
                "effect": each.effect,
                "family": each.family,
                "percent": plain(each.error_reduction_percent),
                "low": plain(each.low),
                "high": plain(each.high),
                "p": plain(each.p),
                "evidence": evidence_words(each),
            }
            for each in found.candidates
        ],
        "not_fitted": list(found.not_fitted),
        "not_shown": not_shown_json(found),
        "floor": None if floor is None else {"low": plain(floor.low), "high": plain(floor.high)},
        "unseen": list(found.unseen),
    }
