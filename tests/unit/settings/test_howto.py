"""The configurations printed in the how-tos are valid."""

import re
import textwrap
from pathlib import Path

import pytest
import yaml

from agent.settings.load import settings_of
from connectors.kinds import KINDS

HOWTO = Path(__file__).parents[3] / "docs" / "howto"


@pytest.mark.parametrize("kind", [kind.kind for kind in KINDS])
def test_the_how_to_of_each_bus_shows_a_valid_configuration(kind):
    (block,) = re.findall(r"```yaml\n(.*?)```", (HOWTO / f"{kind}.md").read_text(), re.DOTALL)
    settings = settings_of(yaml.safe_load(block))
    kinds = {each.kind: each.roles for each in KINDS}
    others = [each for each in settings.connections.values() if each.kind != kind]
    assert not others or not kinds[kind], "only what cannot be read needs another connection"
    (connection,) = [each for each in settings.connections.values() if each.kind == kind]
    unset = set(type(connection.options).model_fields) - connection.options.model_fields_set
    assert not unset, "the page shows every option"


def test_the_how_to_of_lists_shows_a_valid_one(tmp_path):
    text = (HOWTO / "many_loops.md").read_text()
    (block,) = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    rows = re.search(r":\n\n((?: {4}.*\n)+)", text)
    assert rows is not None
    (tmp_path / "plant_loops.csv").write_text(textwrap.dedent(rows[1]))
    first, second = settings_of(yaml.safe_load(block), tmp_path).loops
    assert (first.name, first.op_range, first.tags["sp"].node) == ("FIC101", (0, 100), "ns=2;s=FIC101.SP")
    assert (second.acting, second.window.seconds) == ("direct", 3000)
