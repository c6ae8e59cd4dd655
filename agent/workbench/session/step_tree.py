"""The models of one recording as a tree: one may go back to any of them, and no branch is lost."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.fit import fit, fit_at
from agent.workbench.projection import target_of
from agent.workbench.session.workbench import Workbench
from agent.workbench.validation import rmse_on

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.workbench.comparison import Comparison
    from agent.workbench.fit import Fit
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.record import Record
    from agent.workbench.step import Step

Stretch = tuple[float, float]
"""From and to, s from the start of the record."""


@dataclass(slots=True)
class TreeNode:
    """One model: the way to it, and what is known of it."""

    number: int
    parent: int | None
    change: str
    """What it changes beside the effects, in words; empty where nothing."""
    bench: Workbench
    steps: tuple[Step, ...]
    left_out: tuple[Stretch, ...]
    """Stretches of the record that its fits do not use."""
    comparison: Comparison | None = None
    """None until its candidates were tried."""

    @property
    def step(self) -> Step:
        """Return the model itself."""
        return self.steps[-1]


class StepTree:
    """All models that were tried on a recording, and the one that is looked at."""

    def __init__(self, window: LoopWindow, base: str, run: Map, progress: Progress) -> None:
        """Fit the base; ``reason`` says why nothing can be fitted.

        Raises:
            ValueError: No such base.
        """
        self._base, self._run, self._progress = base, run, progress
        self.nodes: list[TreeNode] = []
        self.validation: Record | None = None
        """Another recording, on which each model is scored."""
        self.current = 0
        bench = self._bench(window)
        self.window = bench.window
        """What is compared: of a very long recording a part."""
        self.reason = bench.reason
        if bench.reason is None:
            self._node(None, "", bench, bench.staircase())

    @property
    def node(self) -> TreeNode:
        """Return the node that is looked at.

        Raises:
            ValueError: The recording is not testable.
        """
        if self.reason is not None:
            raise ValueError(self.reason)
        return self.nodes[self.current]

    def go(self, number: int) -> None:
        """Look at another node.

        Raises:
            ValueError: There is none of that number.
        """
        if not 0 <= number < len(self.nodes):
            raise ValueError(f"there is no step {number}")
        self.current = number

    def add(self, effect: str) -> None:
        """Add an effect to the model that is looked at; raises ValueError as ``Bench.add``."""
        self._change(lambda bench: bench.add(effect))

    def drop(self, effect: str) -> None:
        """Take an effect out; where the model before it is in the tree, go there."""
        node = self.node
        if node.step.added == effect and node.parent is not None:
            self.current = node.parent
            return
        self._change(lambda bench: bench.drop(effect))

    def compared(self) -> Comparison:
        """Return the comparison of the node that is looked at; its candidates are tried once."""
        node = self.node
        if node.comparison is None:
            node.bench.restore(node.steps)
            node.comparison = node.bench.comparison()
            node.steps = node.bench.staircase()  # the newest may have been fitted anew
        return node.comparison

    def quick(self, effect: str) -> FloatArray | None:
        """Return PV of the model with a candidate that was tried, PV units, (n,); None where it was not."""
        node = self.node
        known = node.bench.trials.known(node.step)
        return None if known is None or effect not in known.models else known.models[effect].fit.pv

    def leave_out(self, stretch: Stretch) -> None:
        """Fit everything again without a stretch of the record; ValueError where too little is left."""
        node = self.node
        window, left_out = self.window, (*node.left_out, stretch)
        known = np.ones(len(window), dtype=np.bool_)
        time = window.ts * np.arange(len(window))
        for start, end in left_out:
            known &= (time < start) | (time > end)
        pv = np.where(known, window.pv, np.nan)
        bench = self._bench(replace(window, pv=pv))
        bench.part = node.bench.part  # what it sees was cut out already
        if bench.reason is not None:
            raise ValueError(f"without this stretch the record is not testable: {bench.reason}")
        for effect in node.step.effects:
            bench.add(effect)
        change = f"without {stretch[0]:.4g} to {stretch[1]:.4g} s"
        self._node(self.current, change, bench, bench.staircase(), left_out)

    def simulate(self, values: Mapping[str, float]) -> FloatArray:
        """Return PV of the model with other values of its parameters, PV units, (n,).

        Gain and disturbances are solved for. Raises ValueError at an unknown parameter.
        """
        return self._fit_at(values).pv

    def fit_from(self, values: Mapping[str, float]) -> None:
        """Fit the same model again from other values; raises ValueError at an unknown parameter."""
        node = self.node
        start = self._fit_at(values)
        record = node.bench.record
        found = fit(start.model, record, record.weight, start.values[np.newaxis])
        node.bench.restore(node.steps)
        node.bench.take(node.bench.trials.predicted(found))
        self._node(self.current, "fitted from own values", node.bench, node.bench.staircase(), node.left_out)

    def rmse_validation(self, node: TreeNode) -> float | None:
        """Return the error of a model on the other recording, PV units; None without one."""
        return None if self.validation is None else rmse_on(node.step.fit, self.validation)

    def _fit_at(self, values: Mapping[str, float]) -> Fit:
        node = self.node
        model, record = node.step.fit.model, node.bench.record
        names = [name for name, _ in model.parameters(record.facts)]
        unknown = sorted(values.keys() - set(names))
        if unknown:
            raise ValueError(f"the model has no parameter {unknown[0]}")
        known = dict(zip(names, node.step.fit.values.tolist(), strict=True))
        own = np.array([values.get(name, known[name]) for name in names])
        target = target_of(record, record.weight, linear=model.base.linear)
        return fit_at(model, record, target, own)

    def _change(self, change: Callable[[Workbench], Step]) -> None:
        node = self.node
        node.bench.restore(node.steps)
        step = change(node.bench)
        for other in self.nodes:
            if other.parent == node.number and other.step is step:
                self.current = other.number
                return
        self._node(node.number, "", node.bench, node.bench.staircase(), node.left_out)

    def _node(
        self,
        parent: int | None,
        change: str,
        bench: Workbench,
        steps: tuple[Step, ...],
        left_out: tuple[Stretch, ...] = (),
    ) -> None:
        node = TreeNode(len(self.nodes), parent, change, bench, steps, left_out)
        self.nodes.append(node)
        self.current = node.number

    def _bench(self, window: LoopWindow) -> Workbench:
        return Workbench(window, self._base, run=self._run, progress=self._progress)
