"""Files that a session reads and writes: models as YAML, the report as HTML."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from agent.cli.common.errors import complain

if TYPE_CHECKING:
    from agent.workbench.comparison import Comparison
    from agent.workbench.session import Workbench
    from agent.workbench.several.together import Together


def mapping_of(path: Path) -> object:
    """Return what a YAML file holds.

    Raises:
        ValueError: it cannot be read.
    """
    import yaml

    try:
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ValueError(" ".join(str(error).split())) from error


def deliver(bench: Workbench, found: Comparison, save: Path | None, report: Path | None) -> bool:
    """Write the files of a comparison; return whether they could be written.

    What took no part, a part of the recording or an effect that failed in a fit, is named.
    """
    report_part(bench)
    for line in () if bench.reason is not None else bench.trials.left_out.values():
        complain(f"{line}; it is left out")
    written = [True]
    if save is not None:
        written.append(save_model(bench, save))
    if report is not None:
        written.append(write_report(bench, found, report))
    return all(written)


def report_part(bench: Workbench, name: str | None = None) -> None:
    """State what of a very long recording, with a name where there are several, is not compared."""
    if bench.part is not None:
        words = f"not compared: {bench.part.words}; --start and --end choose others"
        complain(words if name is None else f"{name}: {words}")


def save_model(bench: Workbench, path: Path) -> bool:
    """Write the last model; return whether it could be written."""
    import yaml

    if bench.reason is not None:
        complain(f"{path}: not written: the recording is not testable")
        return True
    return _write(path, yaml.safe_dump(bench.save(), sort_keys=False))


def write_report(bench: Workbench, found: Comparison, path: Path) -> bool:
    """Write the page; return whether it could be written."""
    from agent.plots.workbench.comparison_figures import comparison_figures
    from agent.plots.workbench.report import report_html

    return _write(path, report_html(found, comparison_figures(bench, found)))


def write_together(found: Together, path: Path) -> bool:
    """Write the page of several recordings; return whether it could be written."""
    from agent.plots.workbench.several_report import together_html

    return _write(path, together_html(found))


def _write(path: Path, text: str) -> bool:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        complain(f"{path}: cannot be written: {error.strerror}")
        return False
    return True
