"""A session as bytes and back: whatever was fitted stays fitted."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING

from agent.workbench.hooks import silent
from agent.workbench.session.workbench import Workbench

if TYPE_CHECKING:
    from agent.workbench.hooks import Map, Progress


def dumped(bench: Workbench) -> bytes:
    """Return a session as bytes, without the hooks that belong to this process."""
    return pickle.dumps(_with_hooks(bench, map, silent), protocol=pickle.HIGHEST_PROTOCOL)


def loaded(data: bytes, run: Map, progress: Progress) -> Workbench:
    """Return the session of ``dumped``.

    Unpickling runs code: only bytes that the same user wrote may be given (decision 49).

    Args:
        data: Of ``dumped`` of this version.
        run: Tries effects, perhaps in parallel.
        progress: Called with what is tried next.

    Raises:
        ValueError: They are no session.
    """
    try:
        found = pickle.loads(data)  # noqa: S301 - a file of the user's own cache, as numba's kernels are
    except (pickle.UnpicklingError, EOFError, AttributeError, ImportError, IndexError, TypeError) as error:
        raise ValueError("no kept session") from error
    if not isinstance(found, Workbench):
        raise ValueError("no kept session")  # noqa: TRY004 - content of a file
    return _with_hooks(found, run, progress)


def _with_hooks(bench: Workbench, run: Map, progress: Progress) -> Workbench:
    other = copy.copy(bench)
    other.use_hooks(run, progress)
    return other
