"""Compiled kernels belong to the source they were compiled from."""

import threading
from pathlib import Path

import numba
import pytest

from agent import jit
from agent.cli.common.compilation import COMPILING, announce_compilation


def test_only_what_a_kernel_imports_decides_what_is_compiled(tmp_path):
    files = {
        "agent/kernels.py": "from agent.jit import kernel\nfrom agent.physics import law\n"
        "from agent.units import (\n    A,\n)\n",
        "agent/physics/law.py": "from agent.deep.constants import B",
        "agent/deep/constants.py": "B = 1",
        "agent/units.py": "A = 1",
        "agent/report.py": "from agent.kernels import run",
        "simulators/plant.py": "from agent.units import A",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = [str(each.relative_to(tmp_path)) for each in jit.sources_of_kernels(tmp_path)]
    assert found == ["agent/deep/constants.py", "agent/kernels.py", "agent/physics/law.py", "agent/units.py"]


def test_every_file_that_compiles_is_among_the_sources_of_kernels():
    root = jit.PACKAGE.parent
    sources = set(jit.sources_of_kernels(root))
    kernels = {
        file
        for folder in jit.PACKAGES
        for file in (root / folder).rglob("*.py")
        if "@kernel" in file.read_text()
    }
    assert kernels
    assert kernels <= sources


def test_the_digest_follows_every_file(tmp_path):
    files = [tmp_path / "caller.py", tmp_path / "callee.py"]
    for file in files:
        file.write_text("x = 1")
    before = jit.digest(files)
    assert jit.digest(files) == before
    files[1].write_text("x = 2")
    assert jit.digest(files) != before


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of one file that may write its cache."""
    folder = tmp_path / "agent"
    folder.mkdir()
    monkeypatch.setattr(jit, "PACKAGE", folder)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    (folder / "one.py").write_text("from agent.jit import kernel\nx = 1")
    return folder


def test_a_change_takes_a_new_folder_and_drops_the_old(package):
    jit.use_cache_of_this_source()
    first = Path(numba.config.CACHE_DIR)
    assert first.is_dir()
    (package / "one.py").write_text("from agent.jit import kernel\nx = 2")
    jit.use_cache_of_this_source()
    second = Path(numba.config.CACHE_DIR)
    assert second.is_dir()
    assert not first.exists()


def test_the_folder_of_the_users_choice_outlives_a_change_of_the_source(package, monkeypatch):
    mine = package / "var" / "mine"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(mine))
    jit.use_cache_of_this_source()
    first = Path(numba.config.CACHE_DIR)
    assert first.parent == mine
    (package / "one.py").write_text("from agent.jit import kernel\nx = 2")
    jit.use_cache_of_this_source()
    assert [Path(numba.config.CACHE_DIR)] == list(mine.iterdir()) != [first]


@pytest.mark.usefixtures("package")
def test_a_folder_that_is_not_to_be_written_is_left_to_numba(monkeypatch):
    monkeypatch.setattr(jit.os, "access", lambda *_: False)
    jit.use_cache_of_this_source()
    assert numba.config.CACHE_DIR == ""


def test_compilation_is_reported_before_it_starts_and_only_then():
    told = []
    jit.before_compilation(lambda: told.append("compiles"))
    double = numba.njit(lambda x: 2 * x)
    assert told == []
    assert double(1) == 2
    before = len(told)
    assert before > 0
    assert double(3) == 6
    assert len(told) == before


def test_one_line_however_much_is_compiled_in_however_many_processes(monkeypatch, capsys):
    tells = []
    monkeypatch.setattr(jit, "before_compilation", tells.append)
    told = threading.Event()
    announce_compilation(told)
    announce_compilation(told)  # as a second process that shares the event
    for tell in tells * 2:
        tell()
    assert capsys.readouterr().err.splitlines() == [COMPILING]
