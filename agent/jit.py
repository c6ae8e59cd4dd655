"""One place that compiles the loops, so that every kernel has the same options and a type."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from hashlib import blake2b
from pathlib import Path
from typing import TypeVar, cast

import numba
from numba.core import event

F = TypeVar("F", bound=Callable[..., object])

PACKAGE = Path(__file__).parent
PACKAGES = ("agent", "simulators")
FOLDER = "kernels-"


IMPORT = re.compile(r"^[ \t]*(?:from ([\w.]+) import (\([^)]*\)|[^\n]*)|import ([\w.]+))", re.MULTILINE)
COMPILES = f"from {__name__} import"


def sources_of_kernels(root: Path) -> list[Path]:
    """Return the files of kernels below ``root``, and all that they import from there, directly or not.

    Only these decide what is compiled: an edit elsewhere need not compile everything anew.
    """
    text = {
        file: file.read_text(encoding="utf-8")
        for folder in PACKAGES
        for file in sorted((root / folder).rglob("*.py"))
    }
    waiting = [file for file, content in text.items() if COMPILES in content]
    found: set[Path] = set()
    while waiting:
        file = waiting.pop()
        if file in found:
            continue
        found.add(file)
        waiting += [each for each in _imported(text[file], root) if each in text]
    return sorted(found)


def _imported(content: str, root: Path) -> Iterator[Path]:
    """Yield the files that the imports of a module may mean; some do not exist."""
    for package, names, module in IMPORT.findall(content):
        path = root.joinpath(*(package or module).split("."))
        yield path.with_suffix(".py")
        yield path / "__init__.py"
        for name in re.findall(r"\w+", names):
            yield (path / name).with_suffix(".py")


def digest(sources: Iterable[Path]) -> str:
    """Return what changes when any of these files does."""
    total = blake2b(digest_size=8)
    for source in sources:
        total.update(source.read_bytes())
    return total.hexdigest()


def use_cache_of_this_source() -> None:
    """Keep compiled kernels in a folder named for the source they come from.

    numba checks the file of a kernel only, not those of the kernels it calls: without this folder, the old
    code of a changed callee would run. A folder that the user chose needs this, too: a volume or /var/cache
    still exists when the next version is installed.
    """
    cache = Path(os.environ.get("NUMBA_CACHE_DIR", PACKAGE / "__pycache__"))
    if not os.access(next(each for each in (cache, *cache.parents) if each.is_dir()), os.W_OK):
        return  # numba's own choice: a folder of the user
    folder = cache / f"{FOLDER}{digest(sources_of_kernels(PACKAGE.parent))}"
    if not folder.is_dir():
        for outdated in cache.glob(f"{FOLDER}*"):
            shutil.rmtree(outdated, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
    numba.config.CACHE_DIR = str(folder)


def kernel(function: F) -> F:
    """Compile ``function`` with numba, cached on disk.

    A test compares each kernel with a slow, obvious version in ``tests/reference``. No fastmath: NaN marks
    missing data and must stay NaN.
    """
    return cast("F", numba.njit(cache=True, nogil=True)(function))


class _BeforeCompilation(event.Listener):  # type: ignore[misc]  # numba has no types
    def __init__(self, notify: Callable[[], None]) -> None:
        self._notify = notify

    def on_start(self, _: event.Event) -> None:
        self._notify()

    def on_end(self, _: event.Event) -> None:
        pass


def before_compilation(notify: Callable[[], None]) -> None:
    """Call ``notify`` in this process whenever a kernel is not in the cache and must be compiled."""
    event.register("numba:compile", _BeforeCompilation(notify))


def inlined_kernel(function: F) -> F:
    """Compile ``function`` like ``kernel``, a copy of it within each kernel that calls it.

    For functions that are called for few samples at a time: passing their arrays would take as long as the
    work.
    """
    return cast("F", numba.njit(cache=True, nogil=True, inline="always")(function))


def fused_kernel(function: F) -> F:
    """Compile ``function`` like ``kernel``, and let a product and a sum become one instruction.

    For filters, in which each step waits for the one before. It rounds once instead of twice.
    """
    return cast("F", numba.njit(cache=True, nogil=True, fastmath={"contract"})(function))


def summing_kernel(function: F) -> F:
    """Compile ``function`` like ``kernel``, and let the compiler reorder sums to add several at once.

    NaN and infinity keep their meaning; only the last digits of a sum depend on the machine.
    """
    return cast("F", numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})(function))


use_cache_of_this_source()
