"""Records that stiction detectors are checked on, and the rules that each of their answers keeps."""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, TypeVar, get_args

import numpy as np

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import MethodResult, MethodVerdict, Oscillation
from agent.checks.contract import require, require_close
from simulators.draws.random_plants import Kind, random_plant
from simulators.plant import simulate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.stiction import StictionDetector

    FloatArray = NDArray[np.float64]

T = TypeVar("T")
KINDS: tuple[Kind, ...] = ("stiction", "sinusoid", "tuning")
"""Why the simulated loops swing."""
SIGNALS = ("op", "pv", "sp", "mv")
NO_VERDICT = ("not_applicable", "undecided")
NO_OSCILLATION = Oscillation(detected=False, period=None, regularity=None)


@cache
def simulated(kind: Kind) -> tuple[LoopWindow, Oscillation]:
    """Return a simulated loop with its set point and stem, and its oscillation."""
    record = simulate(random_plant(4, kind))
    window = LoopWindow(kind, 0.0, 1.0, record.op, record.pv, record.sp, record.mv)
    return window, detect_oscillation(window)


def loops(*, without_mv: bool = False) -> Iterator[tuple[LoopWindow, Oscillation]]:
    """Yield the simulated loops, on request each once more without its stem."""
    for kind in KINDS:
        window, oscillation = simulated(kind)
        yield window, oscillation
        if without_mv:
            yield replace(window, loop=f"{kind} without MV", mv=None), oscillation


def swinging(period: float) -> Oscillation:
    """Return a regular oscillation of that period, s."""
    return Oscillation(detected=True, period=period, regularity=3.0)


def signals_of(window: LoopWindow) -> dict[str, FloatArray]:
    """Return the signals that a window has, by name."""
    found = {name: getattr(window, name) for name in SIGNALS}
    return {name: values for name, values in found.items() if values is not None}


def changed(window: LoopWindow, **signals: FloatArray) -> LoopWindow:
    """Return a window with other signals."""
    return LoopWindow(
        window.loop,
        window.start,
        window.ts,
        **{**dict.fromkeys(SIGNALS), **signals_of(window), **signals},  # type: ignore[arg-type]
    )


def random_window(rng: np.random.Generator) -> tuple[str, LoopWindow, Oscillation]:
    """Return noise or a walk of up to 400 samples, coarse or not, with gaps or not, and what was drawn."""
    samples, scale = int(rng.integers(1, 401)), float(rng.choice([1e-14, 1.0, 1e14]))
    steps, lost = float(rng.choice([0.0, 0.5, 3.0])), float(rng.choice([0.0, 0.01, 0.5]))
    period, walk = float(rng.choice([0.5, 2.0, 7.3, 50.0, 300.0])), bool(rng.integers(2))
    signals = rng.normal(size=(4, samples))
    if walk:
        signals = np.cumsum(signals, axis=1)
    if steps:
        signals = steps * np.round(signals / steps)
    signals[rng.random((4, samples)) < lost] = np.nan
    op, pv, sp, mv = scale * signals
    case = (
        f"{'a walk' if walk else 'noise'} of {samples} samples times {scale:g}, in steps of {steps:g}, "
        f"{lost:.0%} lost, period {period:g}"
    )
    return case, LoopWindow("any", 0.0, 1.0, op, pv, sp, mv), swinging(period)


def pickled(value: T) -> T:
    """Return what arrives in another process."""
    arrived: T = pickle.loads(pickle.dumps(value))  # noqa: S301 - our own bytes
    return arrived


def detected(member: StictionDetector, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
    """Return the answer of a detector, held to the rules of ``MethodResult``."""
    return sound(member.detect(window, oscillation))


def sound(result: MethodResult) -> MethodResult:
    """Return a result that keeps the rules of ``MethodResult``.

    Raises:
        ContractError: It breaks one.
    """
    require(isinstance(result, MethodResult), f"it returns a {type(result).__name__}")
    require(result.verdict in get_args(MethodVerdict), f"its verdict is {result.verdict!r}")
    require(result.reason, "it gives no reason")
    index = result.index
    finite = index is None or (type(index) is float and math.isfinite(index))
    require(finite, f"its index is {index!r} of type {type(index).__name__}")
    if result.verdict == "not_applicable":
        require(index is None, f"it is not applicable, and its index is {index}")
    if result.verdict in ("stiction", "no_stiction"):
        require(index is not None, "it has a verdict and no index")
        require(result.seen is not None, "it has a verdict and shows nothing for its picture")
    return result


def require_same(one: MethodResult, other: MethodResult) -> None:
    """Go on where two results agree, up to the rounding of the index.

    Raises:
        ContractError: They do not.
    """
    verdicts = sound(one).verdict, sound(other).verdict
    require(verdicts[0] == verdicts[1], f"its verdict is {verdicts[1]!r} instead of {verdicts[0]!r}")
    require((one.index is None) == (other.index is None), f"its index is {other.index}, not {one.index}")
    if one.index is not None:
        require_close(other.index, one.index, "its index", rtol=1e-3, atol=1e-6)
