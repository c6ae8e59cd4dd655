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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

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
HIDDEN, EFFECT = "WB104", "deadband"
"""Scenario of the workbench, and what it hides."""
SPEED = 60
PATIENCE = 400
"""Longest wait for all verdicts, s."""
COMMAND = (sys.executable, "-c", "from agent.cli import main; main()")
SETTLED = "document.querySelectorAll('[data-testid=work-list] [data-loop]:not([data-verdict=none])').length"


def main() -> None:
    """Write ``work_list.png``, ``loop_page.png`` and ``workbench.png`` beside this file."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        compared(folder)
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


def compared(folder: Path) -> None:
    """Take the picture of the workbench, with the hidden effect ticked."""
    scenario = ROOT / "config" / "scenarios" / "workbench" / f"{HIDDEN.lower()}.yaml"
    started(folder, "simulate", str(scenario), "-o", f"{HIDDEN}.csv").wait()
    with started(folder, "workbench", "--no-browser") as serving:
        address = wait_for(serving, "address: ").partition("address: ")[2].strip()
        with browser_page(1440) as page:
            page.goto(address)
            page.set_input_files("[data-testid=upload]", str(folder / f"{HIDDEN}.csv"))
            page.wait_for_selector(f"[data-effect={EFFECT}] input:not([disabled])", timeout=PATIENCE * 1000)
            page.locator(f"[data-effect={EFFECT}] input").click()
            page.wait_for_selector("[data-step='1']", timeout=PATIENCE * 1000)
            page.wait_for_selector(
                "[data-effect] input:not(:checked):not([disabled])", timeout=PATIENCE * 1000
            )
            page.wait_for_timeout(1000)
            clip = {"x": 0, "y": 0, "width": 1440, "height": 1400}
            page.screenshot(path=FOLDER / "workbench.png", clip=clip, full_page=True)
        serving.terminate()


@contextmanager
def browser_page(width: int) -> Iterator[Any]:
    """Yield a page of a browser."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415

    with sync_playwright() as library:
        browser = library.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        yield browser.new_context(viewport={"width": width, "height": 800}, device_scale_factor=1).new_page()
        browser.close()


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
    with browser_page(1280) as page:
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


if __name__ == "__main__":
    main()
