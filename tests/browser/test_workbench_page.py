"""The workbench as a person uses it: upload, look where it fails, tick the missing effect, and back."""

import re
import subprocess
import sys

import pytest

from agent.cli.common.page import free_port
from simulators.plant import rows
from simulators.record_file import write_rows
from simulators.scenario import load_scenario
from tests.browser.test_page import serious, tab_to
from tests.conftest import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]
CODE = "from agent.cli import main; main()"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """The first quarter of an hour of a loop with a hidden dead band."""
    file = tmp_path_factory.mktemp("recordings") / "WB104.csv"
    scenario = load_scenario(ROOT / "config" / "scenarios" / "workbench" / "wb104.yaml")
    write_rows(file, list(rows(scenario))[:900])
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


def shown(page, workbench, recording):
    """Upload a recording and wait until its base is fitted."""
    page.goto(workbench)
    page.set_input_files("[data-testid=upload]", str(recording))
    page.wait_for_selector("[data-testid=staircase] [data-step='0']")


def uploaded(page, workbench, recording):
    """And until its effects are tried."""
    shown(page, workbench, recording)
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
    tab_to(page, "[data-effect=deadband] input")  # the second time by keyboard
    page.keyboard.press("Space")
    page.wait_for_selector("[data-testid=staircase] [data-step='1']")
    assert errors(page) == first
    assert page.locator(".wb-node").count() == 2  # no branch twice
    page.locator("input[type=range]").first.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector("button:has-text('Fit from here'):not([disabled])")
    page.fill("[aria-label^='Begin of the stretch']", "300")
    page.fill("[aria-label^='End of the stretch']", "500")
    page.keyboard.press("Enter")
    page.wait_for_selector("button:has-text('Leave it out and fit again'):not([disabled])")
    page.wait_for_selector(".wb-panel .lit")  # in every picture
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
    page.wait_for_selector("[data-testid=roles]")
    assert serious(page) == []
    renamed = tmp_path / "renamed.csv"
    columns = recording.read_text(encoding="utf-8").split("\n", 1)
    header = ",".join({"OP": "u", "PV": "y"}.get(each, each) for each in columns[0].split(","))
    renamed.write_text(f"{header}\n{columns[1]}", encoding="utf-8")
    page.set_input_files("[data-testid=upload]", str(renamed))
    page.wait_for_selector("[data-testid=roles]:has-text('renamed.csv')")
    page.select_option("[data-testid=roles] [data-role=op]", "u")
    page.select_option("[data-testid=roles] [data-role=pv]", "y")
    page.click("text=Read it by these columns")
    page.wait_for_selector("[data-testid=staircase] [data-step='0']")
    page.wait_for_selector("text=OP = u")
    shown(page, workbench, recording)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert serious(page) == []


def test_a_file_without_names_and_times_is_read_by_numbers_and_a_sampling_time(
    workbench, recording, open_page, tmp_path
):
    page = open_page(390, 844, "light", errors_expected=True)
    bare = tmp_path / "dryer.dat"
    names, *rows = recording.read_text(encoding="utf-8").splitlines()
    places = [names.split(",").index(each) for each in ("OP", "PV")]
    bare.write_text("\n".join(" ".join(row.split(",")[k] for k in places) for row in rows), encoding="utf-8")
    page.goto(workbench)
    page.set_input_files("[data-testid=upload]", str(bare))
    page.wait_for_selector("[data-testid=fault]:has-text('no line of column names')")
    page.select_option("[data-testid=roles] [data-role=op]", "1")
    page.select_option("[data-testid=roles] [data-role=pv]", "2")
    page.fill("[data-testid=roles] [data-role=ts]", "0.5")
    assert serious(page) == []
    page.click("text=Read it by these columns")
    page.wait_for_selector("[data-testid=staircase] [data-step='0']")
    assert "--op 1 --pv 2 --ts 0.5" in page.content()


MOVES = 40
PAINTED = """
async (moves) => {
  const slider = document.querySelector('input[type=range]');
  const waits = [];
  for (let k = 0; k < moves; k++) {
    const begun = performance.now();
    const answered = new Promise((done) => new PerformanceObserver((list, self) => {
      if (list.getEntries().some((each) => each.name.endsWith('/simulate'))) {
        self.disconnect();
        done();
      }
    }).observe({ type: 'resource' }));
    slider.value = String(100 + 15 * k);
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    await answered;
    await new Promise((done) => requestAnimationFrame(() => done()));
    waits.push(performance.now() - begun);
  }
  return waits.sort((a, b) => a - b)[moves >> 1];
}
"""


@pytest.mark.bench
def test_the_curve_of_a_slider_is_there_within_50_ms_in_the_median(workbench, recording, open_page):
    page = open_page()
    uploaded(page, workbench, recording)
    page.wait_for_selector("input[type=range]:not([disabled])")
    assert page.evaluate(PAINTED, MOVES) < 50
