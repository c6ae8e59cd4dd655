"""Sessions that are kept: one file for each recording with its options, in the user's own cache.

A session is a pickle, as numba's kernels are, so the folder belongs to the user alone and a file that others
may write is refused (decision 49).
"""

from __future__ import annotations

import hashlib
import os
import stat
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST = 20
"""Sessions that are kept, about 10 MB each; the oldest go."""


def sessions_folder() -> Path:
    """Return where sessions are kept: ``SLIPJUMP_SESSIONS``, else the cache folder of the user."""
    own = os.environ.get("SLIPJUMP_SESSIONS")
    if own:
        return Path(own)
    cache = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(cache) if cache else Path.home() / ".cache") / "slipjump" / "sessions"


def session_key(parts: Iterable[bytes]) -> str:
    """Return the name of a session from all that its answers depend on."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "big") + part)
    return digest.hexdigest()[:32]


def read_session(folder: Path, key: str) -> bytes | None:
    """Return a kept session; None where there is none, or one that others may have written."""
    path = _path(folder, key)
    try:
        status = path.stat()
        if hasattr(os, "getuid") and (
            status.st_uid != os.getuid() or status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
        ):
            return None
        return zlib.decompress(path.read_bytes())
    except (OSError, zlib.error):
        return None


def write_session(folder: Path, key: str, data: bytes) -> None:
    """Keep a session; the oldest go.

    Raises:
        OSError: It cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    path = _path(folder, key)
    new = path.with_suffix(f".{os.getpid()}")
    handle = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(handle, "wb") as file:
        file.write(zlib.compress(data, 1))
    new.replace(path)
    for old in sorted(folder.glob("*.session"), key=_age)[:-MOST]:
        old.unlink(missing_ok=True)


def _path(folder: Path, key: str) -> Path:
    return folder / f"{key}.session"


def _age(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
