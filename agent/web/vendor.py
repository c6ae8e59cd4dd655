"""Libraries of others that the browser loads: fetched once by npm, kept in the wheel, verified by a test.

``python -m agent.web.vendor`` fetches the versions of ``LIBRARIES`` anew and writes ``vendor.json``. Nothing
is fetched at installation or at run time.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import tarfile
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).parent / "static" / "vendor"
INDEX = "vendor.json"


@dataclass(frozen=True, slots=True)
class Library:
    """One package of the npm registry."""

    name: str
    version: str
    licence: str
    files: Mapping[str, str]
    """Path in the package -> name here."""
    imports: Mapping[str, str]
    """Bare name of a module -> path: browsers resolve bare names only by an import map, which is inline."""


LIBRARIES: Sequence[Library] = (
    Library(
        "preact",
        "11.2.0",
        "MIT",
        {
            "dist/preact.mjs": "preact.mjs",
            "dist/preact.mjs.map": "preact.mjs.map",
            "hooks/dist/hooks.mjs": "hooks.mjs",
            "hooks/dist/hooks.mjs.map": "hooks.mjs.map",
            "LICENSE": "preact.LICENSE",
        },
        {"preact": "./preact.mjs"},
    ),
    Library("htm", "3.1.1", "Apache-2.0", {"dist/htm.mjs": "htm.mjs", "LICENSE": "htm.LICENSE"}, {}),
    Library(
        "uplot",
        "1.6.32",
        "MIT",
        {
            "dist/uPlot.esm.js": "uPlot.esm.js",
            "dist/uPlot.min.css": "uPlot.min.css",
            "LICENSE": "uplot.LICENSE",
        },
        {},
    ),
)


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file, in hex."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def faults(folder: Path = FOLDER) -> list[str]:
    """Return each file that is missing, changed or unknown, one line each."""
    listed = {
        name: digest
        for library in json.loads((folder / INDEX).read_text(encoding="utf-8"))
        for name, digest in library["sha256"].items()
    }
    there = {path.name for path in folder.iterdir() if path.name != INDEX}
    changed = [name for name in listed.keys() & there if checksum(folder / name) != listed[name]]
    return sorted(
        [f"{name}: missing" for name in listed.keys() - there]
        + [f"{name}: not listed in {INDEX}" for name in there - listed.keys()]
        + [f"{name}: checksum differs from {INDEX}" for name in changed]
    )


def refresh(libraries: Sequence[Library] = LIBRARIES, folder: Path = FOLDER) -> None:
    """Fetch all libraries into ``folder`` and write their names, versions, licences and checksums."""
    folder.mkdir(parents=True, exist_ok=True)
    index = []
    for library in libraries:
        _fetch(library, folder)
        index.append(
            {
                "name": library.name,
                "version": library.version,
                "licence": library.licence,
                "sha256": {name: checksum(folder / name) for name in library.files.values()},
            }
        )
    (folder / INDEX).write_text(json.dumps(index, indent=2) + "\n", encoding="utf-8")


def _fetch(library: Library, folder: Path) -> None:
    with tempfile.TemporaryDirectory() as place:
        command = [
            "npm",
            "pack",
            "--silent",
            f"{library.name}@{library.version}",
            "--pack-destination",
            place,
        ]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # noqa: S603 - all words are constants
        (packed,) = Path(place).glob("*.tgz")
        with tarfile.open(packed) as archive:
            for path, name in library.files.items():
                member = archive.extractfile(f"package/{path}")
                if member is None:
                    raise FileNotFoundError(f"{library.name} {library.version} has no {path}")
                content = member.read()
                for bare, file in library.imports.items():
                    content = content.replace(f'from"{bare}"'.encode(), f'from"{file}"'.encode())
                (folder / name).write_bytes(content)


if __name__ == "__main__":
    refresh()
