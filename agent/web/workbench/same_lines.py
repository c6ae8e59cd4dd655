"""The same model in a shell and in Python: what somebody types to get without the page what it shows."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.workbench.session.step_tree import TreeNode

BASE = "fopdt"
"""Process of ``compare`` where none is named."""


@dataclass(frozen=True, slots=True)
class ReadSource:
    """What was read, and how."""

    recording: str
    """Name of the file, as its user knows it."""
    columns: Mapping[str, str] = field(default_factory=dict)
    """Role (OP, PV, SP, time) -> column, where the user named it; the others are recognised. ``ts`` -> s."""
    loop: str | None = None
    """Which loop of a file with several."""


def command_of(source: ReadSource, node: TreeNode) -> str:
    """Return the command; a stretch cannot be left out there, which it says."""
    words = ["slipjump", "compare", source.recording]
    for role, column in sorted(source.columns.items()):
        words += [f"--{role.lower()}", column]
    if source.loop is not None:
        words += ["--loop", source.loop]
    if node.bench.base.name != BASE:
        words += ["--base", node.bench.base.name]
    for effect in node.step.effects:
        words += ["--add", effect]
    line = shlex.join(words)
    return f"{line}  # with the whole record: see Python" if node.left_out else line


def python_of(source: ReadSource, node: TreeNode) -> str:
    """Return the lines, which run as they are where the recording lies in the folder."""
    names = {role.lower(): column for role, column in source.columns.items()}
    given = [f"Path({source.recording!r})"]
    if names:
        words = (
            f"{role}={column if role == 'ts' else repr(column)}" for role, column in sorted(names.items())
        )
        given.append(f"Columns({', '.join(words)})")
    if source.loop is not None:
        given.append(f"loop={source.loop!r}")
    cut = [
        f"pv[(time >= {start!r}) & (time <= {end!r})] = np.nan  # left out" for start, end in node.left_out
    ]
    part = node.bench.part
    stretch = (
        () if part is None else (f"window = part_of(window, slice({part.where.start}, {part.where.stop}))",)
    )
    without = ["time, pv = window.ts * np.arange(len(window)), window.pv.copy()", *cut] if cut else []
    return "\n".join(
        (
            *(("from dataclasses import replace",) if cut else ()),
            "from pathlib import Path",
            *(("import numpy as np",) if cut else ()),
            "from agent.analysis.record.window_of_recording import loop_window",
            *(("from agent.analysis.recording_stretches import part_of",) if stretch else ()),
            "from agent.workbench.session import Workbench",
            f"from connectors.recording import {'Columns, ' if names else ''}read_recording",
            "",
            f"window = loop_window(read_recording({', '.join(given)}))",
            *stretch,
            *without,
            *(("window = replace(window, pv=pv)",) if cut else ()),
            f"bench = Workbench(window, base={node.bench.base.name!r})",
            *(f"bench.add({each!r})" for each in node.step.effects),
            "print(bench.comparison().verdict)",
        )
    )
