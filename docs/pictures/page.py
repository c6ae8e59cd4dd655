"""Pictures of the page, taken in Debian's chromium from a running agent: ``python -m docs.pictures.page``.

Simulated loops are served on MQTT and watched by the daemon, both as a user starts them; pictures are taken
when each loop has its verdict.
"""
# ruff: noqa: INP001, S603 - a script beside the pages that it writes; it starts our own commands

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

FOLDER = Path(__file__).resolve().parent
ROOT = FOLDER.parents[1]
SCENARIOS = (
    "fic101_stick_slip",
    "fic102_moderate_stiction",
    "fic103_healthy",
    "fic104_tight_tuning",
    "pic401_direct_stick_slip",
    "pic402_sinusoid",
    "tic302_second_order",
)
SPEED = 60
PATIENCE = 400
"""Longest wait for all verdicts, s."""
COMMAND = (sys.executable, "-c", "from agent.cli import main; main()")
SETTLED = "document.querySelectorAll('[data-testid=work-list] [data-loop]:not([data-verdict=none])').length"


def main() -> None:
    """Write ``work_list.png`` and ``loop_page.png`` beside this file."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        config = folder / "plant.yaml"
        serve = ("serve", *SCENARIOS, "--bus", "mqtt", "--speed", str(SPEED), "--config", str(config))
        with started(folder, *serve) as serving:
            wait_for(serving, "watch them")
            watched(config)
            with started(folder, "run", str(config)) as running:
                take(wait_for(running, "address: ").partition("address: ")[2].strip())
                running.terminate()
            serving.terminate()


def watched(config: Path) -> None:
    """Have the loops watched as the demo does, with a page on a free port."""
    content = yaml.safe_load(config.read_text(encoding="utf-8"))
    content["agent"] = {**content.get("agent", {}), "http": {"port": 9188}}
    for loop in content["loops"]:
        del loop["tags"]["mv"]  # a plant seldom measures it
        loop |= {"window": {"seconds": 1000, "hop": 0.25}, "alarm": {"on_delay": 2, "priority": "high"}}
    config.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")


def started(folder: Path, *words: str) -> subprocess.Popen[str]:
    """Start a command of slipjump."""
    return subprocess.Popen(
        [*COMMAND, *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        env={"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip


def wait_for(process: subprocess.Popen[str], text: str) -> str:
    """Return the first line of a command that has a text."""
    return next(line for line in process.stdout or () if text in line)


def take(address: str) -> None:
    """Take the pictures when every loop has its verdict."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415

    browser_path = shutil.which("chromium")
    with sync_playwright() as library:
        browser = library.chromium.launch(
            executable_path=browser_path, args=["--no-sandbox", "--disable-gpu"]
        )
        page = browser.new_context(viewport={"width": 1280, "height": 800}, device_scale_factor=1).new_page()
        page.goto(address)
        deadline = time.monotonic() + PATIENCE
        while page.evaluate(SETTLED) < len(SCENARIOS) or page.locator(".unacked_active").count() < 3:
            if time.monotonic() > deadline:
                raise TimeoutError("verdicts are missing")
            page.wait_for_timeout(500)
        page.screenshot(path=FOLDER / "work_list.png", full_page=True)
        page.goto(f"{address}loops/FIC101")
        page.wait_for_selector("[aria-label^='PV and PV of the model'] canvas")
        page.wait_for_timeout(1000)
        page.screenshot(
            path=FOLDER / "loop_page.png",
            clip={"x": 0, "y": 0, "width": 1280, "height": 1150},
            full_page=True,
        )
        browser.close()


if __name__ == "__main__":
    main()
