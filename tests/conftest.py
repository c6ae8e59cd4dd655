"""Rules of every test: a leaked task, an unawaited coroutine or a warning fails it."""

import asyncio
import gc
import os
import shutil
from pathlib import Path

import pytest
from hypothesis import settings

from tests.postgres import Postgres, binaries

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the commands: before numpy is imported

IN_CI = os.environ.get("SLIPJUMP_CI") == "1"
ROOT = Path(__file__).parent.parent
settings.register_profile("slipjump", deadline=None)  # nothing depends on absolute speed
settings.load_profile("slipjump")


def pytest_collection_modifyitems(items):
    for item in items:
        if asyncio.iscoroutinefunction(getattr(item, "function", None)):
            item.fixturenames.append("no_leaked_tasks")


@pytest.fixture
async def no_leaked_tasks():
    """Fails an async test that leaves a task running."""
    before = asyncio.all_tasks()
    yield
    leaked = asyncio.all_tasks() - before - {asyncio.current_task()}
    assert not leaked, f"the test left tasks running: {leaked}"


def missing(what: str):
    """Skip on a user's machine, fail in CI, where everything must be there."""
    if IN_CI:
        pytest.fail(f"{what} is missing, and SLIPJUMP_CI=1 allows no skip")
    pytest.skip(f"{what} is missing")


@pytest.fixture(scope="session", autouse=True)
def one_standard_space_of_opcua():
    """OPC UA servers of this process share the work of building their standard address space."""
    from tests.opcua_space import build_once  # noqa: PLC0415 - asyncua is heavy, and collecting needs it not

    build_once()


@pytest.fixture(scope="session", autouse=True)
def workers_with_imports():
    """Processes that tests start come from one that has imported what most of them need, as in `diagnose`.

    What was collected of all tests stays to the end: a search for garbage in it costs time.
    """
    from agent.cli.commands import COLLECT_AFTER  # noqa: PLC0415
    from agent.runtime.loop.process_pool import import_early  # noqa: PLC0415 - heavy, and collecting needs it not

    gc.freeze()
    gc.set_threshold(COLLECT_AFTER)
    import_early(["agent.analysis.diagnose", "agent.workbench.session"])


@pytest.fixture(scope="session")
def recordings() -> Path:
    """The folder of real recordings, read in place."""
    folder = Path(os.environ.get("SLIPJUMP_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        missing(f"recordings folder {folder}")
    return folder


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of Debian's browser."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        missing("chromium")
    return str(path)


@pytest.fixture(scope="module")
def postgres():
    """A running PostgreSQL server of the system, for the tests of one file."""
    if binaries() is None:
        missing("postgresql")
    server = Postgres()
    try:
        server.start()
        yield server
    finally:
        server.close()


@pytest.fixture(scope="session")
def mosquitto() -> str:
    """Path of the mosquitto broker."""
    path = shutil.which("mosquitto", path=os.environ.get("PATH", "") + ":/usr/sbin")
    if path is None:
        missing("mosquitto")
    return str(path)
