"""Commands and their output in a page, run as they are printed.

A block that shows a command of slipjump is fenced as ``console``, its commands begin with ``$``. Comments
before it say what is special: ``<!-- not run: reason -->``, ``<!-- long -->`` (in make bench only),
``<!-- exit code 2 -->``, ``<!-- numbers within 5 % -->``. In the output ``...`` stands for any text in a
line, alone for any lines.
"""

from __future__ import annotations

import math
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

MARK = re.compile(r"<!-- (.*?) -->")
FENCE = re.compile(r"^```(\w*)$")
SHOWS_COMMAND = re.compile(
    r"^(?:\$ |(?:\$ )?(?:sudo )?\S*\bslipjump (?!is |listens |reads )[a-z-]+( |$))", re.MULTILINE
)
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?")
LIMIT = 600.0
"""s that a command may take, on a machine that is shared."""


@dataclass(frozen=True, slots=True)
class Block:
    """One block of a page."""

    line: int
    kind: str
    text: str
    marks: tuple[str, ...]

    @property
    def shows_a_command(self) -> bool:
        return bool(SHOWS_COMMAND.search(self.text))

    @property
    def not_run(self) -> str | None:
        """The reason why it is not run."""
        return next(
            (mark.removeprefix("not run: ") for mark in self.marks if mark.startswith("not run: ")), None
        )

    @property
    def long(self) -> bool:
        return "long" in self.marks

    @property
    def exit_code(self) -> int:
        return next((int(mark.rsplit(" ", 1)[1]) for mark in self.marks if mark.startswith("exit code ")), 0)

    @property
    def tolerance(self) -> float:
        """Share by which a number may differ."""
        found = [re.fullmatch(r"numbers within (\d+) %", mark) for mark in self.marks]
        return next((int(each[1]) / 100 for each in found if each), 0.0)

    @property
    def commands(self) -> list[tuple[str, str]]:
        """Each command with the output that is printed below it."""
        parts = re.split(r"^\$ ", self.text, flags=re.MULTILINE)[1:]
        found = []
        for part in parts:
            command, _, output = part.partition("\n")
            while command.endswith("\\"):
                more, _, output = output.partition("\n")
                command = command[:-1] + more
            found.append((command, output))
        return found


def blocks(text: str) -> list[Block]:
    """Return the fenced and the indented blocks of a page's ``text``."""
    found: list[Block] = []
    marks: list[str] = []
    lines = text.splitlines()
    at = 0
    while at < len(lines):
        start = at
        fence = FENCE.match(lines[at])
        if fence:
            at = lines.index("```", at + 1)
            found.append(Block(start + 1, fence[1], "\n".join(lines[start + 1 : at]), tuple(marks)))
            marks = []
        elif lines[at].startswith("    ") and (at == 0 or not lines[at - 1].strip()):
            while at + 1 < len(lines) and (lines[at + 1].startswith("    ") or not lines[at + 1].strip()):
                at += 1
            found.append(
                Block(start + 1, "", "\n".join(line[4:] for line in lines[start : at + 1]), tuple(marks))
            )
            marks = []
        elif lines[at].startswith("<!--"):
            marks += MARK.findall(lines[at])
        elif lines[at].strip():
            marks = []
        at += 1
    return found


def same_line(expected: str, got: str, tolerance: float) -> bool:
    """Whether a line is as printed, but for what ``...`` stands for and numbers within the tolerance."""
    expected, got = " ".join(expected.split()), " ".join(got.split())
    pieces = []
    for piece in re.split(r"(\.\.\.)", expected):
        if piece == "...":
            pieces.append(".*")
        else:
            words = NUMBER.split(piece)
            pieces.append(f"({NUMBER.pattern})".join(re.escape(word) for word in words))
    match = re.fullmatch("".join(pieces), got)
    if match is None:
        return False
    numbers = NUMBER.findall(expected)
    return all(
        math.isclose(float(a.replace(",", "")), float(b.replace(",", "")), rel_tol=tolerance, abs_tol=1e-12)
        for a, b in zip(numbers, match.groups(), strict=True)
    )


def same_output(expected: list[str], got: list[str], tolerance: float) -> bool:
    """Whether the lines are as printed; ``...`` alone stands for any number of lines."""
    if not expected:
        return not got
    if expected[0].strip() == "...":
        return any(same_output(expected[1:], got[at:], tolerance) for at in range(len(got) + 1))
    return (
        bool(got)
        and same_line(expected[0], got[0], tolerance)
        and same_output(expected[1:], got[1:], tolerance)
    )


def run(block: Block, folder: Path, environment: dict[str, str]) -> list[str]:
    """Run the commands of a block in ``folder``; return what is not as printed, empty where all is."""
    wrong = []
    for command, expected in block.commands:
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=False,
        )
        if done.returncode != block.exit_code:
            wrong.append(f"$ {command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        lines = [line for line in expected.splitlines() if line.strip()]
        output = done.stderr if block.exit_code else done.stdout
        got = [line for line in output.splitlines() if line.strip()]
        if lines and not same_output(lines, got, block.tolerance):
            wrong.append(f"$ {command}\n" + "\n".join(got) + "\nis not as printed:\n" + "\n".join(lines))
    return wrong


def shim(folder: Path) -> Path:
    """Make a ``slipjump`` that is the code under test; return its folder, which goes first in the PATH."""
    program = folder / "slipjump"
    program.write_text(f"#!/bin/sh\nexec {sys.executable} -c 'from agent.cli import main; main()' \"$@\"\n")
    program.chmod(0o755)
    return folder
