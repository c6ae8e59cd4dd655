"""How often it is right that PV does not respond to OP, and why not; on simulated loops of known causes.

Seeds from 62000 on are used for nothing else. *Known* has the gain as other windows of the valve would
show it (the true gain with an uncertainty of 30 %, one lag for all).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import get_args

from agent.analysis.record.known_process import KnownProcess
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.response.no_response import no_response
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import KINDS, random_scenario
from benchmarks.tables.markdown import table
from simulators.draws.no_response import SilentKind, random_silent
from simulators.plant import simulate
from simulators.scenario import Scenario

FIRST_SEED = 62000
COUNT, COUNT_FULL = 10, 100
CAUSE = {"jammed": "unknown"}
"""What is right to say of a kind, where that is not its name."""
AT_ONCE, AT_ONCE_SAMPLES = "no_signal_or_flow", 3.0
"""What is right of a flow that halves within so many samples: a transmitter that fails looks the same."""
UNSURE = 0.3
"""Standard deviation of the logarithm of a known gain."""


def run(options: Options) -> None:
    """Print the table."""
    count = COUNT_FULL if options.full else COUNT
    rows = []
    for kind in get_args(SilentKind):
        scenarios = [random_silent(FIRST_SEED + k, kind) for k in range(count)]
        rows.append((f"`{kind}`", count, *counted(scenarios, [right_of(each, kind) for each in scenarios])))
    for sound in KINDS:
        scenarios = [random_scenario(sound, FIRST_SEED + k)[0] for k in range(count)]
        rows.append((f"`{sound}`", count, *counted(scenarios, [{None}] * count)))
    columns = ("kind", "loops", "right", "nothing said", "wrong", "known: right", "nothing said", "wrong")
    print(table("### PV does not respond to OP", columns, rows))


def right_of(scenario: Scenario, kind: SilentKind) -> set[str | None]:
    """Return the causes that are right of a loop: where two look the same, the one that names both too."""
    half = sum(scenario.process.taus) * math.log(2)
    at_once = kind == "no_flow" and half <= AT_ONCE_SAMPLES * scenario.ts
    return {CAUSE.get(kind, kind)} | ({AT_ONCE} if at_once else set())


def counted(scenarios: list[Scenario], right: Sequence[set[str | None]]) -> tuple[int, ...]:
    """Return how many are right, say nothing and are wrong: without and with a known process."""
    found: list[int] = []
    windows = [window_of_all(each) for each in scenarios]
    for known in (False, True):
        said = [
            None if answer is None else answer.cause
            for answer in (
                no_response(each.with_hints(LoopHints(known=known_process(of) if known else None)))
                for each, of in zip(windows, scenarios, strict=True)
            )
        ]
        good = sum(cause in these for cause, these in zip(said, right, strict=True))
        silent = sum(cause is None and None not in these for cause, these in zip(said, right, strict=True))
        found += [good, silent, len(said) - good - silent]
    return tuple(found)


def window_of_all(scenario: Scenario) -> LoopWindow:
    record = simulate(scenario)
    return LoopWindow(scenario.loop, 0.0, scenario.ts, record.op, record.pv, record.sp)


def known_process(scenario: Scenario) -> KnownProcess:
    process = scenario.process
    tau = sum(process.taus) if process.taus else None
    return KnownProcess(process.gain, tau, process.delay + scenario.ts / 2, UNSURE)
