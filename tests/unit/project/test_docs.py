"""The docs have a page for everything that is registered, no dead link, and no command that isn't there."""

import re
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from agent.analysis.oscillation import DETECTORS
from agent.analysis.quantify import QUANTIFIERS
from agent.analysis.stiction import DETECTORS as STICTION_DETECTORS
from agent.cli.commands import app
from agent.physics.processes import PROCESSES
from agent.settings.load import settings_of
from connectors.kinds import KINDS

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
COMMAND = re.compile(r"(?:^ {4}|^\$ |`)slipjump ([a-z]+)", re.MULTILINE)


@pytest.mark.parametrize(
    "method", [each.name for each in (*QUANTIFIERS, *DETECTORS, *STICTION_DETECTORS, *PROCESSES)]
)
def test_every_method_has_a_page_whose_title_names_it(method):
    titles = [page.read_text(encoding="utf-8").splitlines()[0] for page in (DOCS / "methods").glob("*.md")]
    assert [title for title in titles if f"`{method}`" in title]


def test_the_table_of_quantifiers_names_every_one_and_no_other():
    table = (DOCS / "methods" / "quantifiers.md").read_text(encoding="utf-8")
    named = re.findall(r"^\| \[?`(\w+)`", table, re.MULTILINE)
    assert sorted(named) == sorted(each.name for each in QUANTIFIERS)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.kind)
def test_every_bus_has_a_how_to_and_one_that_is_read_an_example_in_the_readme(kind):
    assert (DOCS / "howto" / f"{kind.kind}.md").is_file()
    examples = [yaml.safe_load(block) for block in re.findall(r"```yaml\n(.*?)```", README, re.DOTALL)]
    read = [settings_of(example) for example in examples]
    shown = [one for one in read if {entry.kind for entry in one.connections.values()} == {kind.kind}]
    assert shown or not kind.roles


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_relative_link_leads_somewhere(page):
    links = LINK.findall(page.read_text(encoding="utf-8"))
    targets = [link.split("#")[0] for link in links if "://" not in link and not link.startswith("#")]
    assert [target for target in targets if not (page.parent / target).exists()] == []


@pytest.mark.parametrize("page", [ROOT / "README.md", DOCS / "tutorial.md"], ids=lambda page: page.name)
def test_every_command_shown_to_a_newcomer_is_there(page):
    shown = set(COMMAND.findall(page.read_text(encoding="utf-8")))
    listed = CliRunner().invoke(app, ["--help"]).output
    assert {"diagnose", "replay", "check", "run"} <= shown
    assert [name for name in shown if not re.search(rf"^\W*{name}\b", listed, re.MULTILINE)] == []


def test_every_page_is_reached_from_the_index():
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    reached = {(DOCS / link).resolve() for link in LINK.findall(index)}
    for page in [page for page in reached if page.name == "index.md"]:
        reached |= {(page.parent / link).resolve() for link in LINK.findall(page.read_text(encoding="utf-8"))}
    missed = [
        str(page.relative_to(DOCS))
        for page in sorted(DOCS.rglob("*.md"))
        if page.name != "index.md" and page.resolve() not in reached and page.parent.resolve() not in reached
    ]
    assert missed == []
