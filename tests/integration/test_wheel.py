"""Installed from its wheel into an empty environment, away from the checkout, slipjump works too."""

import itertools
import json
import os
import subprocess
import sys
import zipfile

import pytest

from agent.checks import FAMILIES
from agent.cli.common.compilation import COMPILING
from simulators.plant import rows
from simulators.record_file import write_rows
from simulators.scenario import load_scenario
from tests.conftest import ROOT, missing
from tests.docs.page import blocks
from tests.docs.page import run as run_as_printed

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]


def run(*words, cwd, timeout=200):
    apart = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL"))}
    return subprocess.run(
        [*map(str, words)], capture_output=True, text=True, check=False, cwd=cwd, timeout=timeout, env=apart
    )


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    built = run(
        sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", folder, ROOT, cwd=folder
    )
    assert built.returncode == 0, built.stdout + built.stderr
    (path,) = folder.glob("slipjump-*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """Path of the command in an environment that has nothing but the wheel and what it asks for."""
    folder = tmp_path_factory.mktemp("empty")
    assert run(sys.executable, "-m", "venv", folder / "venv", cwd=folder).returncode == 0
    python = folder / "venv" / "bin" / "python"
    pip = [python, "-m", "pip", "--disable-pip-version-check"]
    done = run(*pip, "install", "--quiet", "-c", ROOT / "constraints.txt", wheel, cwd=folder)
    if done.returncode and "No matching distribution" in done.stderr:
        missing(f"the package registry ({done.stderr.strip().splitlines()[-1]})")
    assert done.returncode == 0, done.stderr
    return python.with_name("slipjump")


def test_the_configuration_travels_and_nothing_else_does(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    shipped = {path.relative_to(ROOT / "config") for path in (ROOT / "config").rglob("*.*")}
    assert {f"agent/_config/{path}" for path in shipped} <= set(names)
    folders = {name.split("/")[0] for name in names}
    assert folders - {"agent", "connectors", "simulators"} == {
        name for name in folders if name.endswith(".dist-info")
    }
    assert not [name for name in names if name.endswith((".nbi", ".nbc", ".pyc"))]


CHECKED = """
import sys

sys.modules["pytest"] = sys.modules["hypothesis"] = None
from agent import checks
from agent.analysis.oscillation import AcfFiltered

checks.check_all("oscillation_detectors", AcfFiltered())
print(checks.__file__, *checks.FAMILIES)
for family in checks.FAMILIES:
    assert checks.checks_of(family)
"""


def test_the_checks_are_in_the_wheel_and_need_no_test_tools(wheel, tmp_path):
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    words = f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r})\n{CHECKED}"
    done = run(sys.executable, "-c", words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    file, *families = done.stdout.split()
    assert file.startswith(str(tmp_path))
    assert families == list(FAMILIES)


@pytest.mark.bench  # an environment of its own installs everything and compiles every kernel anew
def test_it_is_the_wheel_that_answers(installed, tmp_path):
    python = installed.with_name("python")
    told = run(python, "-c", "import agent; print(agent.__file__)", cwd=tmp_path)
    assert told.stdout.startswith(str(installed.parents[1])), told.stdout + told.stderr
    assert "diagnose" in run(installed, "--help", cwd=tmp_path).stdout


@pytest.mark.bench
def test_diagnose(installed, tmp_path):
    scenario = load_scenario(ROOT / "config" / "scenarios" / "fic101_stick_slip.yaml")
    write_rows(tmp_path / "FIC101.csv", itertools.islice(rows(scenario), 600))
    done = run(installed, "diagnose", "FIC101.csv", "--json", "--plot", "pictures", cwd=tmp_path)
    assert done.returncode == 0
    assert set(done.stderr.splitlines()) <= {COMPILING}  # at first use, once
    assert json.loads(done.stdout)["verdict"] == "stiction"
    assert (tmp_path / "pictures" / "FIC101.png").is_file()


@pytest.mark.bench
def test_demo(installed, tmp_path):
    done = run(installed, "demo", "--seconds", "3", "--no-web", "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr  # three seconds are too short, and it says so
    assert "verdicts missing: give it longer" in done.stderr
    assert len(json.loads(done.stdout)["loops"]) >= 6


@pytest.mark.bench
@pytest.mark.timeout(900)
@pytest.mark.parametrize("page", ["report", "compare", "own_effect"])
def test_a_journey_runs_from_the_wheel_as_the_page_prints_it(installed, tmp_path, page):
    """From an export to the report; from a conversation to a missing effect, and to one of one's own."""
    text = (ROOT / "docs" / "howto" / f"{page}.md").read_text(encoding="utf-8")
    (tmp_path / "config").symlink_to(ROOT / "config")
    source = next((each.text for each in blocks(text) if each.kind == "python"), "")
    (tmp_path / "plant_effects.py").write_text(source, encoding="utf-8")
    apart = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL"))}
    apart |= {"PATH": f"{installed.parent}:{apart['PATH']}", "SLIPJUMP_SESSIONS": str(tmp_path / "sessions")}
    journey = [each for each in blocks(text) if each.kind == "console"]
    assert journey
    wrong = [line for each in journey for line in run_as_printed(each, tmp_path, apart)]
    assert not wrong, "\n\n".join(wrong)
