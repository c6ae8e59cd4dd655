"""A process that dies costs its own task and no other."""

import os
import signal
from pathlib import Path

import pytest

from agent.cli.diagnosing import work
from agent.cli.diagnosing.answer import Task
from agent.runtime.loop.process_pool import results_of


def squared_or_killed(number):
    if number < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


@pytest.mark.parametrize(
    "numbers",
    [[-1, 2, 3], [1, -2, 3, 4, 5, 6, 7], [1, 2, -3], [-1, -2], [1, 2, 3]],
    ids=["first", "among many", "last", "each", "none"],
)
def test_only_the_task_of_a_dead_process_has_no_result(numbers):
    found = list(results_of(squared_or_killed, numbers, 2))
    assert found == [None if number < 0 else number * number for number in numbers]


def test_diagnose_names_the_file_and_goes_on(monkeypatch):
    tasks = [Task(Path(name), None, None, None, None) for name in ("a.csv", "b.csv")]
    monkeypatch.setattr("agent.runtime.capabilities.cores", lambda: 2)
    monkeypatch.setattr("agent.runtime.loop.process_pool.results_of", lambda *_: iter([None, "answer"]))
    died, answer = work._worked_out(tasks)
    assert died.faults == ("a.csv: not diagnosed: its process was ended, for want of memory or by somebody",)
    assert (died.diagnosis, answer) == (None, "answer")
