"""Installs peers of other makers into a folder of the user's cache, once; says in a line where it cannot."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

HERE = Path(__file__).parent
NPM = {"aedes": "1.2.0", "node-opcua": "2.186.4"}
DEBIAN = ("libmodbus-dev", "libmodbus5")
WITHIN = 600.0
"""s; node-opcua has many parts."""


class PeerMissingError(Exception):
    """A peer cannot be had here; why, in a line."""


def cache() -> Path:
    """Return the folder, which is made."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = base / "slipjump" / "peers"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def node_program(package: str, program: str) -> list[str]:
    """Return the command of a program of ours for node beside ``package``; raises PeerMissingError."""
    folder = cache() / package
    if not (folder / "node_modules" / package).is_dir():
        folder.mkdir(exist_ok=True)
        _run("npm", "install", "--no-audit", "--no-fund", f"{package}@{NPM[package]}", folder=folder)
    shutil.copy(HERE / program, folder)
    return ["node", str(folder / program), str(folder)]


def modbus_program() -> list[str]:
    """Return the command of the server of libmodbus, compiled; raises PeerMissingError."""
    folder = cache() / "libmodbus"
    if not list(folder.glob("usr/lib/*/libmodbus.so")):
        folder.mkdir(exist_ok=True)
        _run("apt-get", "download", *DEBIAN, folder=folder)
        for package in folder.glob("*.deb"):
            _run("dpkg", "-x", package.name, ".", folder=folder)
    (library,) = {each.parent for each in folder.glob("usr/lib/*/libmodbus.so")}
    program = folder / "server"
    where = [f"-I{folder}/usr/include/modbus", f"-L{library}", f"-Wl,-rpath,{library}"]
    _run(
        "cc",
        "-O1",
        "-o",
        program.name,
        str(HERE / "libmodbus_server.c"),
        *where,
        "-lmodbus",
        "-lm",
        folder=folder,
    )
    return [str(program)]


def _run(*words: str, folder: Path) -> None:
    if shutil.which(words[0]) is None:
        raise PeerMissingError(f"{words[0]} is not installed")
    try:
        done = subprocess.run(  # noqa: S603 - our own words
            words, cwd=folder, capture_output=True, text=True, timeout=WITHIN, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise PeerMissingError(f"{words[0]} did not end within {WITHIN:.0f} s") from error
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines() or ["no reason"]
        raise PeerMissingError(f"{' '.join(words[:2])}: {said[-1]}")
