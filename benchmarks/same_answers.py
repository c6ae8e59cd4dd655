"""Two checkouts compared: do they give the same numbers?

`python -m benchmarks.same_answers loops FOLDER` writes twenty simulated loops;
`... answers CHECKOUT FOLDER -o FILE` runs `diagnose` and `compare` of a checkout over them and
over every recording of SLIPJUMP_DATA; `... differ OLD NEW` compares two such files.
Words (reasons, advice) and seconds may differ; no number, verdict, name or key may.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from benchmarks.cases.recordings_folder import recordings_folder
from simulators.draws.random_plants import Kind, random_plant
from simulators.plant import rows
from simulators.record_file import write_rows

FIRST_SEED = 91_000
LOOPS = 20
WORDS = {"reasons", "advice", "note", "seconds", "words", "text", "reason"}
"""Keys whose values are prose or a duration."""
PROGRAM = "from agent.cli import main; main()"


def main() -> None:
    """Run one of the three steps."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.same_answers", description=__doc__)
    steps = parser.add_subparsers(dest="step", required=True)
    steps.add_parser("loops").add_argument("folder", type=Path)
    answers = steps.add_parser("answers")
    answers.add_argument("checkout", type=Path)
    answers.add_argument("folder", type=Path)
    answers.add_argument("-o", dest="output", type=Path, required=True)
    differ = steps.add_parser("differ")
    differ.add_argument("old", type=Path)
    differ.add_argument("new", type=Path)
    given = parser.parse_args()
    if given.step == "loops":
        _write_loops(given.folder)
    elif given.step == "answers":
        _write_answers(given.checkout.resolve(), given.folder.resolve(), given.output)
    else:
        sys.exit(_print_differences(given.old, given.new))


def _write_loops(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for seed in range(FIRST_SEED, FIRST_SEED + LOOPS):
        kind: Kind = "stiction" if seed % 2 else ("tuning" if seed % 4 else "sinusoid")
        write_rows(folder / f"loop{seed}.csv", rows(random_plant(seed, kind)))


def _recordings(folder: Path) -> list[Path]:
    real = recordings_folder()
    if real is None:
        sys.exit("the recordings folder is missing: set SLIPJUMP_DATA")
    return [
        *sorted((real / "isdb").glob("*.csv")),
        *sorted((real / "refinery").glob("*.csv")),
        *sorted(folder.glob("*.csv")),
    ]


def _write_answers(checkout: Path, folder: Path, output: Path) -> None:
    files = _recordings(folder)
    with output.open("w", encoding="utf-8") as file:
        for answer in chain(
            _run(checkout, "diagnose", [*map(str, files), "--json"]),
            *(_run(checkout, "compare", [str(each), "--json"]) for each in files),
        ):
            file.write(json.dumps(answer) + "\n")
            file.flush()


def _run(checkout: Path, command: str, arguments: list[str]) -> Iterator[dict[str, Any]]:
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    program = [sys.executable, "-c", PROGRAM, command, *arguments]
    done = subprocess.run(program, cwd=checkout, env=environment, capture_output=True, text=True, check=False)  # noqa: S603
    sys.stderr.write(done.stderr)
    for line in done.stdout.splitlines():
        yield {"command": command, **json.loads(line)}


def _numbers(value: object, place: str = "") -> Iterator[tuple[str, object]]:
    """Yield each leaf that is no prose, with its place."""
    if isinstance(value, dict):
        for key, each in value.items():
            if key not in WORDS:
                yield from _numbers(each, f"{place}.{key}")
    elif isinstance(value, list):
        yield f"{place}.length", len(value)
        for k, each in enumerate(value):
            yield from _numbers(each, f"{place}[{k}]")
    else:
        yield place, value


def _print_differences(old: Path, new: Path) -> int:
    before, after = _read(old), _read(new)
    differences = [f"{key}: only in one" for key in sorted(before.keys() ^ after.keys())]
    leaves = 0
    for key in sorted(before.keys() & after.keys()):
        was, now = dict(_numbers(before[key])), dict(_numbers(after[key]))
        leaves += len(was)
        differences += [
            f"{key}{place}: {was.get(place)} -> {now.get(place)}"
            for place in sorted(was.keys() | now.keys())
            if was.get(place) != now.get(place)
        ]
    for each in differences:
        print(each)
    print(f"{len(before)} answers before, {len(after)} after")
    print(f"{leaves} values compared, {len(differences)} differences")
    return bool(differences)


def _read(path: Path) -> dict[str, dict[str, Any]]:
    answers = map(json.loads, path.read_text(encoding="utf-8").splitlines())
    return {f"{each['command']} {each['recording']}": each for each in answers}


if __name__ == "__main__":
    main()
