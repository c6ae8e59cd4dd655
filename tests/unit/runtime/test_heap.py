"""One heap for all threads, as glibc says; and what the search for garbage leaves out."""

import gc
import subprocess
import sys
import weakref

import pytest

from agent.runtime.operate import heap

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="glibc's heaps")

THREADS = """
import ctypes, threading
from agent.runtime.operate.heap import keep_one_heap
{call}
together = threading.Barrier(4)
def work():
    together.wait()
    kept = [bytes(1000) for _ in range(1000)]
    together.wait()
threads = [threading.Thread(target=work) for _ in range(4)]
for each in threads: each.start()
for each in threads: each.join()
ctypes.CDLL(None).malloc_stats()
"""


def heaps(call: str, **environment: str) -> int:
    done = subprocess.run(
        [sys.executable, "-c", THREADS.format(call=call)],
        capture_output=True, text=True, check=True, timeout=60, env={"PATH": "/usr/bin", **environment},
    )  # fmt: skip
    return done.stderr.count("Arena ")


def test_threads_share_one_heap_after_it():
    assert heaps("") > 1
    assert heaps("keep_one_heap()") == 1


def test_what_the_environment_requests_counts():
    assert heaps("keep_one_heap()", MALLOC_ARENA_MAX="3", MALLOC_TRIM_THRESHOLD_="100000") > 1


class Cycle:
    def __init__(self):
        self.itself = self


@pytest.fixture
def thawed():
    yield
    gc.unfreeze()


@pytest.mark.usefixtures("thawed")
def test_what_is_set_aside_is_not_searched_until_all_is():
    heap.settle()
    there = Cycle()
    gone = weakref.ref(Cycle())
    heap.set_aside()
    assert not any(each is there for each in gc.get_objects())
    gc.collect()
    assert gone() is not None
    heap.settle()
    assert gone() is None


@pytest.mark.usefixtures("thawed")
def test_what_is_set_aside_goes_when_nothing_refers_to_it():
    kept = [set()]
    gone = weakref.ref(kept[0])
    heap.set_aside()
    kept.clear()
    assert gone() is None
