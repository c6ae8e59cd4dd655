"""Where the YAML files that come with slipjump are: beside the checkout, or inside the installed wheel."""

from __future__ import annotations

from pathlib import Path


def config_folder() -> Path:
    """Return the folder with ``demo.yaml`` and ``scenarios``."""
    package = Path(__file__).parent.parent.parent
    packaged = package / "_config"
    return packaged if packaged.is_dir() else package.parent / "config"
