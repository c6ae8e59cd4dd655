"""Compiled kernels belong to the source they were compiled from."""

import threading
from pathlib import Path

import numba
import pytest

from agent import jit
from agent.cli.compilation import COMPILING, announce_compilation


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
    monkeypatch.setattr(jit, "PACKAGE", tmp_path)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    (tmp_path / "one.py").write_text("x = 1")
    return tmp_path


def test_a_change_takes_a_new_folder_and_drops_the_old(package):
    jit.use_cache_of_this_source()
    first = Path(numba.config.CACHE_DIR)
    assert first.is_dir()
    (package / "one.py").write_text("x = 2")
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
    (package / "one.py").write_text("x = 2")
    jit.use_cache_of_this_source()
    assert [Path(numba.config.CACHE_DIR)] == list(mine.iterdir()) != [first]


@pytest.mark.usefixtures("package")
def test_a_folder_that_is_not_to_be_written_is_left_to_numba(monkeypatch):
    monkeypatch.setattr(jit.os, "access", lambda *_: False)
    jit.use_cache_of_this_source()
    assert numba.config.CACHE_DIR == ""


def test_compilation_is_told_before_it_starts_and_only_then():
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
