"""The workbench as a person uses it: upload, look where it fails, tick the missing effect, and back."""

import re
import subprocess
import sys

import pytest

from agent.cli.common.page import free_port
from simulators.plant import rows
from simulators.record_file import write_rows
from simulators.scenario import load_scenario
from tests.browser.test_page import serious
from tests.conftest import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]
CODE = "from agent.cli import main; main()"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """The first twenty minutes of a loop with a hidden dead band."""
    file = tmp_path_factory.mktemp("recordings") / "WB104.csv"
    scenario = load_scenario(ROOT / "config" / "scenarios" / "workbench" / "wb104.yaml")
    write_rows(file, list(rows(scenario))[:1200])
    return file


@pytest.fixture(scope="module")
def workbench(tmp_path_factory):
    """Address of a workbench as a user starts it."""
    port = free_port(0)
    words = [sys.executable, "-c", CODE, "workbench", "--no-browser", "--port", str(port)]
    folder = tmp_path_factory.mktemp("workbench")
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=folder)
    line = process.stdout.readline()
    assert line == f"address: http://127.0.0.1:{port}/\n"
    yield line.partition(": ")[2].strip()
    process.terminate()
    assert process.wait(30) == 0
    process.stdout.close()


def errors(page):
    """Held-out error of each step of the staircase."""
    return page.evaluate(
        "[...document.querySelectorAll('[data-step]')].map((each) => Number(each.dataset.error))"
    )


def uploaded(page, workbench, recording):
    page.goto(workbench)
    page.set_input_files("[data-testid=upload]", str(recording))
    page.wait_for_selector("[data-testid=staircase] [data-step='0']")
    page.wait_for_selector("[data-effect=deadband] input:not([disabled])")


def test_the_missing_effect_is_seen_ticked_and_taken_back(workbench, recording, open_page):
    page = open_page()
    uploaded(page, workbench, recording)
    assert re.search("session=", page.url)  # a permalink
    page.select_option("[data-testid=axis]", "travel_since_reversal")
    page.wait_for_selector("[aria-label*='travel since reversal']")
    (base,) = errors(page)
    page.locator("[data-effect=deadband] input").click()
    page.wait_for_selector("[data-testid=staircase] [data-step='1']")
    page.wait_for_selector("[data-effect=deadband] input:checked:not([disabled])")
    page.wait_for_selector("[data-testid=verdict]")
    first = errors(page)
    assert first[0] == base
    assert first[1] < 0.8 * base
    floor = page.locator("text=/Noise floor .* to/").inner_text()
    low, high = (float(each) for each in re.findall(r"[\d.]+", floor)[:2])
    assert low <= first[1] <= 1.2 * high  # down to the floor
    page.locator("[data-effect=deadband] input").click()
    page.wait_for_selector("[data-step='1']", state="detached")
    page.wait_for_selector("[data-effect=deadband] input:not(:checked):not([disabled])")
    assert errors(page) == [base]
    page.locator("[data-effect=deadband] input").click()
    page.wait_for_selector("[data-testid=staircase] [data-step='1']")
    assert errors(page) == first
    assert page.locator(".wb-node").count() == 2  # no branch twice
    page.locator("input[type=range]").first.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector("button:has-text('Fit from here'):not([disabled])")
    page.reload()
    page.wait_for_selector("[data-testid=staircase] [data-step='1']")
    assert errors(page) == first
    assert serious(page) == []


def test_a_bad_file_gets_a_clear_line_and_the_next_one_is_taken(workbench, recording, open_page, tmp_path):
    page = open_page(390, 844, "dark", errors_expected=True)
    bad = tmp_path / "<img src=x onerror=alert(1)>.csv"
    bad.write_text("time,a,b\n1,2,3\n2,3,4\n", encoding="utf-8")
    page.goto(workbench)
    page.set_input_files("[data-testid=upload]", str(bad))
    page.wait_for_selector("[data-testid=fault]")
    assert "<img src=x" in page.inner_text("[data-testid=fault]")
    uploaded(page, workbench, recording)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert serious(page) == []
