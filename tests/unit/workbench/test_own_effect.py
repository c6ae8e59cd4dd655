"""The example of docs/howto/own_effect.md, offered as an installed package offers it."""

import re
import sys
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

from agent.physics import effects as registry
from agent.physics.bases import BASES
from agent.physics.effects import EFFECTS, effects
from tests.contracts import test_effects as contract

PAGE = (Path(__file__).parents[3] / "docs" / "howto" / "own_effect.md").read_text(encoding="utf-8")


@pytest.fixture
def offered(monkeypatch):
    """Entry points of packages that are installed."""
    entries = []
    monkeypatch.setattr(
        registry, "entry_points", lambda group: [each for each in entries if each.group == group]
    )
    effects.cache_clear()
    yield entries
    effects.cache_clear()


@pytest.fixture
def split_range(offered, monkeypatch, tmp_path):
    source = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL).group(1)
    (tmp_path / "plant_effects.py").write_text(source, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "plant_effects", raising=False)
    told = tomllib.loads(re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL).group(1))
    for group, own in told["project"]["entry-points"].items():
        offered.extend(EntryPoint(name, value, group) for name, value in own.items())
    return effects()[-1]


def test_the_example_joins_the_others(split_range):
    assert split_range.name == "split_range"
    assert effects()[:-1] == EFFECTS


@pytest.mark.parametrize(
    "promise",
    [
        contract.test_at_the_null_it_is_not_there,
        contract.test_every_parameter_counts,
        contract.test_op_in_other_units_gives_the_same_in_other_units,
        contract.test_time_in_other_units_gives_the_same,
    ],
    ids=lambda promise: promise.__name__,
)
@pytest.mark.parametrize("base", BASES, ids=lambda base: base.name)
def test_the_example_keeps_the_contract(split_range, promise, base):
    promise(split_range, base)


def test_the_example_has_known_names_bounds_and_output(split_range):
    contract.test_names_units_and_stage_are_known_words(split_range)
    contract.test_bounds_are_finite_and_in_order(split_range, 60)
    contract.test_what_comes_out_is_finite_and_what_goes_in_is_left(split_range, BASES[0], 1.0)


def test_above_the_split_the_slope_is_another(split_range):
    position = split_range.apply(np.array([40.0, 50.0, 60.0]), np.array([50.0, 3.0]), 1.0)
    np.testing.assert_array_equal(position, [40, 50, 80])


def test_a_name_that_is_taken_is_refused_with_whose_it_is(offered):
    offered.append(EntryPoint("own", "agent.physics.effects.deadband:Deadband", "slipjump.effects"))
    with pytest.raises(ValueError, match=r"deadband:Deadband offers an effect 'deadband'"):
        effects()
