"""One simulated loop, and the results of the diagnosis and of every method."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

from agent.analysis.diagnose import DEFAULT_QUANTIFIER, diagnose, verdict_of
from agent.analysis.evidence.weighing import weigh
from agent.analysis.gates import gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.results import MethodResult, Quantification
from agent.analysis.stiction import detect_stiction
from benchmarks.cases.random_loop import CAUSES, AnyKind, RandomLoop, random_loop
from benchmarks.tables.strata import LITTLE_NOISE


@dataclass(frozen=True, slots=True)
class DiagnosedLoop:
    """A loop with its truth and its results."""

    kind: AnyKind
    seed: int
    sticks: bool
    noise_percent: float | None
    verdict: str
    confidence: float
    causes: tuple[str, ...]
    """The largest first."""
    methods: dict[str, str]
    """Verdict of each method."""
    with_stem: str
    """Verdict where the stem is measured as well."""
    methods_with_stem: dict[str, str]
    cpu_seconds: float
    """Of the whole diagnosis."""

    @property
    def right(self) -> bool:
        """Whether the cause is."""
        return self.causes[0] in CAUSES[self.kind]

    @property
    def little_noise(self) -> bool:
        return self.noise_percent is None or self.noise_percent <= LITTLE_NOISE


def diagnosed_loop(job: tuple[AnyKind, int]) -> DiagnosedLoop:
    """Simulate and diagnose the loop of a kind and a seed."""
    loop = random_loop(*job)
    started = time.process_time()
    seen = diagnose(loop.window)
    spent = time.process_time() - started
    with_stem, methods_with_stem = "not_testable", {}
    if seen.quantification is not None:
        with_stem, methods_with_stem = stem_verdicts(loop, seen.quantification)
    return DiagnosedLoop(
        kind=loop.kind,
        seed=loop.seed,
        sticks=loop.sticks,
        noise_percent=loop.noise_percent,
        verdict=seen.verdict,
        confidence=seen.confidence,
        causes=tuple(each.cause for each in seen.causes),
        methods=verdicts(seen.methods),
        with_stem=with_stem,
        methods_with_stem=methods_with_stem,
        cpu_seconds=spent,
    )


def stem_verdicts(loop: RandomLoop, found: Quantification) -> tuple[str, dict[str, str]]:
    """Return verdict and methods' verdicts where MV is measured; the fit, which takes no MV, is the same."""
    window = replace(loop.window, mv=loop.stem)
    oscillation = detect_oscillation(window)
    said = detect_stiction(window, oscillation, gates(window, oscillation))
    verdict, _ = verdict_of(found, weigh(found, said, stem_measured=True))
    return verdict, {DEFAULT_QUANTIFIER: found.decision, **verdicts(said)}


def verdicts(methods: Mapping[str, MethodResult]) -> dict[str, str]:
    return {name: each.verdict for name, each in methods.items()}
