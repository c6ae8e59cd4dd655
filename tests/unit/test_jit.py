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


def test_the_users_choice_stands(package, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(package / "mine"))
    jit.use_cache_of_this_source()
    assert numba.config.CACHE_DIR == ""


def test_compilation_is_told_once_and_only_when_there_is_some(capsys):
    told = threading.Event()
    announce_compilation(told)
    announce_compilation(told)  # a second process that shares the event
    double = numba.njit(lambda x: 2 * x)
    assert capsys.readouterr().err == ""
    assert (double(1), double(1.5), double(2)) == (2, 3.0, 4)
    assert capsys.readouterr().err.splitlines() == [COMPILING]
