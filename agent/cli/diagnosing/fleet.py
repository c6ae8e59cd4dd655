"""All recordings of one command as a list of valves: its table, and its report as a file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from agent.cli.common.columns import terminal_width
from agent.cli.common.errors import complain
from agent.cli.diagnosing.one_valve import valve_of

if TYPE_CHECKING:
    from agent.cli.diagnosing.answer import Answer
    from agent.report.fleet.rows import RecordFinding, ValveRow

FORMATS = (".html", ".pdf", ".csv")


class Fleet:
    """The findings of a command, in the order of its recordings."""

    def __init__(self, names: Sequence[Path], valve: Sequence[int], report: Path | None) -> None:
        """Begin empty.

        Args:
            names: Of the recordings.
            valve: Of each, the index of the first recording of its valve.
            report: File to write; None: none.

        Raises:
            BadParameter: ``report`` has another suffix, or is one of the recordings.
        """
        if report is not None and report.suffix.lower() not in FORMATS:
            fault = f"{report}: expected a name that ends with {', '.join(FORMATS)}"
            raise typer.BadParameter(fault, param_hint="'--report'")
        if report is not None and report.resolve() in {path.resolve() for path in names}:
            raise typer.BadParameter(f"{report}: is one of the recordings", param_hint="'--report'")
        self._names, self._valve, self._report = names, valve, report
        self._recordings = Counter(valve)
        self._findings: list[tuple[int, RecordFinding]] = []
        self._not_read: list[str] = []

    def add(self, place: int, answer: Answer) -> None:
        """Add the answer of a recording; of one that could not be read the report lists the fault."""
        if answer.found is None:
            self._not_read += answer.faults
        else:
            self._findings.append((place, answer.found.finding))

    def table(self) -> Iterator[str]:
        """Yield the table; nothing for one recording alone."""
        from agent.report.fleet.table import fleet_lines

        if len(self._findings) > 1:
            yield ""
            yield from fleet_lines(self.rows(), terminal_width())

    def rows(self) -> list[ValveRow]:
        """Return the valves, the most urgent first."""
        from agent.report.fleet.rows import valve_rows

        findings = [each for _, each in self._findings]
        valve = [self._valve[place] for place, _ in self._findings]
        names = [self._name(place, each) for place, each in self._findings]
        return valve_rows(findings, valve, names)

    def write(self) -> bool:
        """Write the report, if one is wanted; return whether that went well."""
        if self._report is None:
            return True
        if not self._findings:
            complain(f"{self._report}: not written: no recording could be read")
            return False
        try:
            _write(self._report, self.rows(), self._not_read)
        except OSError as error:
            complain(f"{self._report}: cannot be written: {error.strerror}")
            return False
        return True

    def _name(self, place: int, finding: RecordFinding) -> str:
        """Return the name of a valve: the tag that its recordings share, else the loop of its only one."""
        tag = valve_of(self._names[place])
        alone = self._recordings[self._valve[place]] == 1
        return finding.loop if alone or tag is None else tag[1]


def _write(path: Path, rows: Sequence[ValveRow], not_read: Sequence[str]) -> None:
    title = f"Control valves: {path.stem}"
    match path.suffix.lower():
        case ".html":
            from agent.report.fleet.page import fleet_html

            path.write_text(fleet_html(rows, title, not_read), encoding="utf-8")
        case ".csv":
            from agent.report.fleet.table import fleet_csv

            path.write_text(fleet_csv(rows), encoding="utf-8")
        case _:
            from matplotlib.backends.backend_pdf import PdfPages

            from agent.plots.fleet import fleet_pages

            with PdfPages(path) as pages:
                for figure in fleet_pages(rows, title, not_read):
                    pages.savefig(figure)
