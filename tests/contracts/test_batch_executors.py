"""What every place for the tasks of a survey must do: each task ends once, whatever dies on the way."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path

import pytest

from agent.runtime.survey.dask_cluster import DaskCluster
from agent.runtime.survey.local_processes import LocalProcesses
from connectors.base import ConfigError

WORKERS = 2
DEADLINE = 60.0


def until(condition):
    end = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < end, "the condition did not come true"
        time.sleep(0.02)


class Dask:
    """A scheduler with workers, each a process of its own as an operator starts them."""

    def __init__(self, folder, stack):
        self.file = folder / "scheduler.json"
        self._folder, self._stack = folder, stack
        self._start("dask_scheduler", "--port", "0", "--host", "127.0.0.1", "--no-dashboard")
        until(self.file.is_file)
        for _ in range(WORKERS):
            self.join()
        self.address = json.loads(self.file.read_text())["address"]

    def join(self):
        """Start one more worker."""
        self._start("dask_worker", "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1")

    def _start(self, module, *words):
        command = [sys.executable, "-m", f"distributed.cli.{module}", "--scheduler-file", str(self.file)]
        environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}
        process = subprocess.Popen(
            [*command, *words],
            cwd=self._folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._stack.callback(process.wait)
        self._stack.callback(process.kill)
        return process


@pytest.fixture(scope="module")
def dask(tmp_path_factory):
    with ExitStack() as stack:
        yield Dask(tmp_path_factory.mktemp("dask"), stack)


@pytest.fixture(params=["local", "dask"])
def executor(request):
    if request.param == "local":
        return LocalProcesses(WORKERS)
    return DaskCluster(request.getfixturevalue("dask").address)


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr("agent.runtime.survey.dask_cluster.PATIENCE", 0.5)


def squared(number):
    return number * number


def refused_at_seven(number):
    if number == 7:
        raise ValueError("seven  is\nrefused")
    return number * number


def killed_once(task):
    """Kill this process at one number, where nobody did so before.

    One number only: another that waits when the process dies is repeated alone, and fails where it kills
    that process, for the first time or not.
    """
    number, folder = task
    mark = Path(folder) / str(number)
    if number == 13 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def killed_always(number):
    if number == 4:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def ends(executor, function, tasks):
    found = list(executor.results(function, tasks))
    counted = Counter(end.task for end in found)
    assert counted == Counter(tasks), "each task ends once"
    return {end.task: end for end in found}


def test_each_task_ends_with_its_result(executor):
    found = ends(executor, squared, range(50))
    assert {task: end.result for task, end in found.items()} == {k: k * k for k in range(50)}
    assert list(executor.results(squared, [])) == []


def test_a_task_that_raises_has_a_fault_in_one_line_and_the_others_are_done(executor):
    found = ends(executor, refused_at_seven, range(20))
    assert found[7].result is None
    assert found[7].fault == "ValueError: seven is refused"
    assert all(found[k].result == k * k and not found[k].fault for k in range(20) if k != 7)


def test_tasks_of_a_process_that_dies_are_repeated(executor, tmp_path):
    tasks = [(k, str(tmp_path)) for k in range(30)]
    found = ends(executor, killed_once, tasks)
    assert {task[0]: end.result for task, end in found.items()} == {k: k * k for k in range(30)}


def test_a_task_that_ends_every_process_has_a_fault_and_the_others_are_done(executor):
    found = ends(executor, killed_always, range(10))
    assert found[4].result is None
    assert found[4].fault
    assert all(found[k].result == k * k for k in range(10) if k != 4)


def test_tasks_are_taken_as_they_are_needed(executor):
    taken = 0

    def tasks():
        nonlocal taken
        for number in range(300):
            taken += 1
            yield number

    for ended, _ in enumerate(executor.results(squared, tasks()), 1):
        assert taken <= ended + 20


def test_whoever_stops_listening_leaves_no_process(executor):
    results = executor.results(squared, range(1000))
    next(results)
    results.close()


def test_a_worker_that_joins_late_helps(dask):
    dask.join()
    found = ends(DaskCluster(dask.address), squared, range(40))
    assert len(found) == 40


@pytest.mark.usefixtures("impatient")
def test_a_scheduler_that_is_not_there_is_named():
    cluster = DaskCluster("tcp://127.0.0.1:9")
    with pytest.raises(ConfigError, match=r"--cluster tcp://127\.0\.0\.1:9: OSError"):
        list(cluster.results(squared, [1]))


@pytest.mark.bench  # its client waits long before it gives up
@pytest.mark.usefixtures("impatient")
def test_a_scheduler_that_ends_is_reported_and_not_waited_for(tmp_path):
    with ExitStack() as stack:
        own = Dask(tmp_path, stack)
        results = DaskCluster(own.address).results(squared, range(100_000))
        next(results)
        stack.close()
        with pytest.raises(ConfigError, match="the same command goes on"):
            list(results)
