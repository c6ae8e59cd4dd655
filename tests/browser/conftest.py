"""Debian's chromium, and a plant with its page in a process of its own."""

import contextlib
import inspect
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import pytest

from agent.cli.common.page import free_port
from tests.conftest import ROOT

CHROMIUM = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
]


class BrowserThread:
    """The synchronous playwright keeps an event loop running in its thread, where no test of asyncio may run.

    So all that drives a browser, the functions of its tests too, runs in one thread of its own.
    """

    def __init__(self):
        self._executor = ThreadPoolExecutor(1, thread_name_prefix="browser")

    def run(self, function, *args, **options):
        return self._executor.submit(function, *args, **options).result()


THREAD = BrowserThread()


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """Run the test in the browser's thread."""
    names = inspect.signature(pyfuncitem.obj).parameters
    THREAD.run(pyfuncitem.obj, **{name: pyfuncitem.funcargs[name] for name in names})
    return True


@pytest.fixture(scope="session")
def browser(chromium):
    """A browser; it goes nowhere by itself."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - only where there is a browser

    library = THREAD.run(sync_playwright().start)
    started = THREAD.run(partial(library.chromium.launch, executable_path=chromium, args=CHROMIUM))
    yield started
    THREAD.run(started.close)
    THREAD.run(library.stop)


@pytest.fixture
def open_page(browser):
    """Opens pages; at the end none has an error in its console or requested another host."""
    contexts, faults = [], []

    def opened(width=1280, height=900, theme="light", *, errors_expected=False):
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=theme)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(300_000)
        if not errors_expected:
            page.on("console", lambda said: said.type == "error" and faults.append(said.text))
        page.on("pageerror", lambda error: faults.append(str(error)))

        def requested(request):
            if not re.match(r"(http://127\.0\.0\.1:\d+/|data:|blob:)", request.url):
                faults.append(f"requested {request.url}")

        page.on("request", requested)
        return page

    yield opened
    for context in contexts:
        THREAD.run(context.close)
    assert not faults


@dataclass
class RunningPlant:
    """Where a plant can be reached."""

    port: int
    process: subprocess.Popen | None = None
    broker: int = 0

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}/"

    def start(self):
        words = [sys.executable, str(ROOT / "tests" / "browser" / "plant.py"), str(self.port)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=ROOT)
        said = {}
        for line in self.process.stdout:
            name, _, value = line.strip().partition(": ")
            said[name] = value
            if {"address", "broker"} <= said.keys():
                break
        assert said.get("address") == self.address, said
        self.broker = int(said["broker"])

    def stop(self):
        self.process.kill()
        self.process.wait(30)
        self.process.stdout.close()


@pytest.fixture(scope="module")
def plant():
    """A plant of three loops: one sticks, one has a hostile name."""
    running = RunningPlant(free_port(0))
    running.start()
    yield running
    with contextlib.suppress(ProcessLookupError):
        running.stop()
