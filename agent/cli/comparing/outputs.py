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
