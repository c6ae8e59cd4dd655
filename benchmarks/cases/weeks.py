"""Simulated weeks of a valve, diagnosed window by window as the agent does."""

from __future__ import annotations

from dataclasses import dataclass

from agent.analysis.diagnose import diagnose
from agent.analysis.memory.sticks import with_memory
from agent.analysis.memory.valve_memory import ValveMemory, hints_from, remember
from agent.analysis.record.recording import LoopHints
from agent.analysis.routine import routine_diagnosis
from benchmarks.cases.random_loop import window_kept
from simulators.draws.valve_weeks import Course, valve_weeks


@dataclass(frozen=True, slots=True)
class WeeksJob:
    """A valve to simulate."""

    seed: int
    days: float
    windows: int
    sticks: bool
    course: Course = "constant"
    one_in: int = 1
    """So many windows are simulated for one that is diagnosed."""


@dataclass(frozen=True, slots=True)
class DiagnosedValve:
    """What the memory of a valve went through."""

    name: str
    sticks: bool
    days: tuple[float, ...]
    true_s: tuple[float, ...]
    memories: tuple[ValveMemory, ...]
    """After each window."""
    accused: tuple[bool, ...]
    """Whether each window has the verdict stiction, which the former days do not make improbable."""

    @property
    def counts(self) -> tuple[float, ...]:
        return self.memories[-1].counts


def diagnosed_valve(job: WeeksJob) -> DiagnosedValve:
    """Simulate and diagnose all windows of a valve, in order of time."""
    valve = valve_weeks(job.seed, job.days, job.windows, sticks=job.sticks, course=job.course)
    windows = valve.windows[:: job.one_in]
    memory, memories, accused = ValveMemory(), [], []
    for each in windows:
        hints = hints_from(memory, LoopHints())
        window = window_kept(valve.name, each.scenario, each.historian, hints)
        found = routine_diagnosis(window, diagnose).diagnosis
        memory = remember(memory, found, window.start, window.start + len(window) * window.ts)
        memories.append(memory)
        accused.append(with_memory(found, memory).verdict == "stiction")
    return DiagnosedValve(
        valve.name,
        valve.sticks,
        tuple(each.day for each in windows),
        tuple(each.s for each in windows),
        tuple(memories),
        tuple(accused),
    )
