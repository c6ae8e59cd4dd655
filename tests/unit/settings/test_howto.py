"""The configurations printed in the how-tos are valid."""

import re
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
    assert {connection.kind for connection in settings.connections.values()} == {kind}
    (connection,) = settings.connections.values()
    unset = set(type(connection.options).model_fields) - connection.options.model_fields_set
    assert not unset, "the page shows every option"
