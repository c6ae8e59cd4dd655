"""Several recordings of one valve: verdicts alone and together, on simulated valves.

The kinds are those that are hard to judge alone (`benchmarks/cases/random_group.py`). Seeds 9000 to 9003 were
used to choose how evidence is taken together; those from 9004 on for nothing else.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.evidence.together import weigh_together
from agent.analysis.evidence.weighing import SURE
from agent.analysis.one_valve import judged_together
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import Verdict
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.random_group import GROUP_KINDS, random_group
from benchmarks.cases.random_loop import STICKING, AnyKind
from benchmarks.tables.markdown import table

SEEDS = range(9004, 9010)
MORE_SEEDS = range(9004, 9020)
COUNT = 4
"""Recordings of a valve."""
VERDICTS: tuple[Verdict, ...] = ("stiction", "undecided", "no_stiction")


@dataclass(frozen=True, slots=True)
class DiagnosedGroup:
    """Recordings of one simulated valve, each with its own verdict."""

    kind: AnyKind
    seed: int
    windows: tuple[LoopWindow, ...]
    alone: tuple[Diagnosis, ...]

    @property
    def sticks(self) -> bool:
        return self.kind in STICKING

    @property
    def together(self) -> tuple[Diagnosis, ...]:
        return judged_together(self.windows, self.alone)

    @property
    def probability(self) -> float:
        """That the valve sticks, by all that could be judged."""
        known = [each for each in self.alone if each.quantification is not None]
        return weigh_together(known, stem_measured=False).probability if known else 0.0

    def joined(self, other: DiagnosedGroup) -> DiagnosedGroup:
        """Return this group with the recordings of another loop of the kind, as if they were of one."""
        return DiagnosedGroup(self.kind, self.seed, self.windows + other.windows, self.alone + other.alone)


def run(options: Options) -> None:
    """Print the tables."""
    jobs = [
        (kind, seed)
        for seed in (MORE_SEEDS if options.full else SEEDS)
        for kind in GROUP_KINDS
        if options.full or seed % 2 or kind not in STICKING  # those that stick take the most time
    ]
    with process_pool() as pool:
        answers = pool.map(diagnosed_group, jobs)
        console = Console(stderr=True)
        groups = list(track(answers, "groups of recordings", len(jobs), console=console))
    print(by_kind(groups))
    print(by_valve(groups))


def diagnosed_group(job: tuple[AnyKind, int]) -> DiagnosedGroup:
    """Simulate the recordings of a kind and a seed, and diagnose each alone."""
    group = random_group(*job, COUNT)
    return DiagnosedGroup(
        group.kind, group.seed, group.windows, tuple(diagnose(each) for each in group.windows)
    )


def by_kind(groups: Sequence[DiagnosedGroup]) -> str:
    """Return how many recordings got which verdict, alone and together."""
    rows = []
    for kind in GROUP_KINDS:
        ones = [each for each in groups if each.kind == kind]
        if not ones:
            continue
        alone = [said.verdict for each in ones for said in each.alone]
        together = [said.verdict for each in ones for said in each.together]
        counts = [f"{alone.count(verdict)} > {together.count(verdict)}" for verdict in VERDICTS]
        rows.append((f"`{kind}`", len(ones), len(alone), *counts))
    columns = ("kind", "valves", "recordings", *(f"{each.replace('_', ' ')}" for each in VERDICTS))
    return table("### Recordings of one valve: verdicts alone > together", columns, rows)


def by_valve(groups: Sequence[DiagnosedGroup]) -> str:
    """Return how many valves are blamed: by one recording alone, by most of them, by all together.

    Twice as many recordings are had by joining the groups of a kind two by two.
    """
    doubled = [
        one.joined(other) for one, other in itertools.combinations(groups, 2) if one.kind == other.kind
    ]
    rows = []
    for title, some in ((f"{COUNT} recordings", groups), (f"{2 * COUNT}, of two valves of a kind", doubled)):
        for sticks in (False, True):
            ones = [each for each in some if each.sticks == sticks]
            blamed = [[said.verdict == "stiction" for said in each.alone] for each in ones]
            together = [[said.verdict == "stiction" for said in each.together] for each in ones]
            rows.append(
                (
                    title,
                    "sticks" if sticks else "sound",
                    len(ones),
                    sum(map(any, blamed)),
                    sum(sum(each) > len(each) / 2 for each in blamed),
                    sum(sum(each) > len(each) / 2 for each in together),
                    sum(each.probability >= SURE for each in ones),
                )
            )
    columns = (
        "valves with",
        "valve",
        "valves",
        "some recording blames it alone",
        "most do alone",
        "most do together",
        "together surer than 0.8",
    )
    return table("### Valves blamed", columns, rows)
