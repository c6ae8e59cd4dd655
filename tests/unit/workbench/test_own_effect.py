"""The example of docs/howto/own_effect.md, offered as an installed package offers it."""

import os
import re
import shlex
import subprocess
import sys
import tomllib
from importlib.metadata import EntryPoint

import numpy as np
import pytest
from loops import slack

from agent.checks import checks_of, plug_ins
from agent.cli import main
from agent.physics import effects as registry
from agent.physics.effects import EFFECTS, effects
from agent.workbench.session import Workbench
from tests.conftest import ROOT

PAGE = (ROOT / "docs" / "howto" / "own_effect.md").read_text(encoding="utf-8")


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
def two_slopes(offered, monkeypatch, tmp_path):
    source = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL).group(1)
    (tmp_path / "plant_effects.py").write_text(source, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "plant_effects", raising=False)
    offer = tomllib.loads(re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL).group(1))
    for group, own in offer["project"]["entry-points"].items():
        offered.extend(EntryPoint(name, value, group) for name, value in own.items())
    return effects()[-1]


def test_the_example_joins_the_others(two_slopes):
    assert two_slopes.name == "two_slopes"
    assert effects()[:-1] == EFFECTS


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture
def written(tmp_path):
    """The files of the page, in a folder."""
    for name, text in zip(
        ("plant_effects", "test_plant_effects", "plant_detector"), blocks("python"), strict=True
    ):
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    return tmp_path


def run(folder, *words):
    where = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}
    return subprocess.run(
        [sys.executable, *words],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env=where,
        timeout=200,
    )


def test_the_commands_of_the_page_end_without_a_word(written):
    commands = [shlex.split(line) for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) == 2
    for program, *words in commands:
        assert program == "python"
        done = run(written, *words)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_the_tests_of_the_page_pass_one_for_each_demand(written):
    done = run(written, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_plant_effects.py")
    assert done.returncode == 0, done.stdout
    assert f"{len(checks_of('effects', plant_effect(written)))} passed" in done.stdout


def plant_effect(folder):
    scope = {"__name__": "plant_effects"}
    exec((folder / "plant_effects.py").read_text(encoding="utf-8"), scope)  # noqa: S102 - the page's own code
    return scope["TwoSlopes"]()


def test_a_wrong_effect_ends_with_the_line_of_the_page(written):
    source = (written / "plant_effects.py").read_text(encoding="utf-8")
    wrong = source.replace("return np.minimum(position, at)", "return np.nan * np.minimum(position, at)")
    (written / "plant_effects.py").write_text(wrong, encoding="utf-8")
    done = run(written, *shlex.split(blocks("sh")[0])[1:])
    assert done.returncode == 1
    (line,) = [line.strip() for line in PAGE.splitlines() if line.startswith("    effect two_slopes (")]
    assert line.replace("/home/jane", str(written)) in done.stderr


@pytest.fixture(name="offers")
def offering(offered, monkeypatch, tmp_path):
    """Offer an effect of a file of its own, as an installed package does."""

    def offer(name, text, module=None):
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.delitem(sys.modules, name, raising=False)
        offered.append(EntryPoint(name, f"{module or name}:Own", registry.ENTRY_POINTS))
        return tmp_path / f"{name}.py"

    monkeypatch.setattr(
        plug_ins, "entry_points", lambda group: [each for each in offered if each.group == group]
    )
    return offer


OWN = blocks("python")[0].replace("class TwoSlopes", "class Own")
BROKEN = {
    "import": ("import no_such_package\n" + OWN, "can be imported"),
    "syntax": ("class Own(:\n", "can be imported"),
    "exit": ("1 / 0\n", "can be imported"),
    "arguments": (OWN.replace('    name: str = "two_slopes"', "    name: str"), "without arguments"),
    "no_parameters": (OWN.replace("def parameters", "def no_parameters"), "no attribute 'parameters'"),
    "stage": (OWN.replace('"valve"', '"pump"'), "its stage is 'pump'"),
    "bounds": (OWN.replace("0.2, 5.0", "5.0, 0.2"), "finite bounds in order"),
    "shape": (OWN.replace("position - at, 0.0)", "position - at, 0.0)[1:]"), "finite numbers in the shape"),
    "nan": (
        OWN.replace("return ", "return np.nan * ").replace("np.nan * (", "("),
        "a position is not finite",
    ),
    "writes": (OWN.replace("at, ratio = values", "at, ratio = values; position += 0.0"), "leave its input"),
    "null": (OWN.replace("null=1.0", "null=2.0"), "must do nothing at its null"),
    "taken": (OWN.replace('"two_slopes"', '"deadband"'), "a name that no other effect has"),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_an_installed_effect_that_fails_is_left_out_in_one_line(offers, kind):
    text, demanded = BROKEN[kind]
    file = offers(f"broken_{kind}", text)
    offers("fine", OWN)
    found = plug_ins.usable_effects()
    assert found.effects[:-1] == EFFECTS
    assert found.effects[-1].name == "two_slopes"
    (line,) = found.left_out
    assert demanded in line
    assert str(file) in line
    assert line.startswith("effect ")
    assert line.endswith("it is left out")
    assert "\n" not in line


def test_a_module_that_is_not_there_is_named_as_the_entry_point_has_it(offers):
    offers("lost", "", module="lost_package.effects")
    (line,) = plug_ins.usable_effects().left_out
    assert line.startswith("effect lost (lost_package.effects:Own) must be a class that can be imported")


def test_compare_names_what_it_leaves_out_and_does_not_know_it(offers, capsys, tmp_path):
    offers("broken_nan", BROKEN["nan"][0])
    with pytest.raises(SystemExit) as ended:
        main(["compare", str(tmp_path / "none.csv"), "--add", "two_slopes"])
    assert ended.value.code == 2
    left_out, unknown = capsys.readouterr().err.splitlines()
    assert "effect two_slopes" in left_out
    assert "left out" in left_out
    assert "no effect 'two_slopes'" in unknown


NAN_IN_A_FIT = OWN.replace(
    "at, ratio = values\n",
    "at, ratio = values\n        if len(position) == 300:\n            return position * np.nan\n",
)
RAISES_IN_A_FIT = NAN_IN_A_FIT.replace("return position * np.nan", "raise ZeroDivisionError('of mine')")
SHORT_IN_A_FIT = NAN_IN_A_FIT.replace("return position * np.nan", "return position[1:]")


@pytest.mark.parametrize(
    ("text", "demanded"),
    [
        (NAN_IN_A_FIT, "must return finite numbers within all its bounds"),
        (RAISES_IN_A_FIT, "must not raise; it raised ZeroDivisionError: of mine"),
        (SHORT_IN_A_FIT, "must return 300 samples; it returned (299,)"),
    ],
    ids=["nan", "raises", "short"],
)
def test_an_effect_that_fails_in_the_middle_of_a_fit_is_left_out_in_one_line(tmp_path, text, demanded):
    name = f"own_{demanded.split()[1]}_{len(text)}"
    (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    found = plug_ins.usable_effects([f"{tmp_path / name}.py:Own"])
    assert found.left_out == ()
    few = [each.name for each in EFFECTS if each.name != "deadband"]
    bench = Workbench(slack(samples=300), without=few, effects=found.effects)
    assert [each.effect for each in bench.candidates().candidates] == ["deadband"]
    (line,) = bench.trials.left_out.values()
    assert line.startswith(f"effect two_slopes ({tmp_path / name}.py) ")
    assert demanded in line
    assert any("it was left out" in each for each in bench.comparison().unseen)
    with pytest.raises(ValueError, match="effect two_slopes"):
        bench.add("two_slopes")


@pytest.mark.bench
def test_the_conversation_of_the_page_finds_the_effect_in_its_file(written):
    scenario = ROOT / "config" / "scenarios" / "workbench" / "wb104.yaml"
    code = "from agent.cli import main; main()"
    run(written, "-c", code, "simulate", str(scenario), "-o", "WB104.csv")
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            code,
            "compare",
            "WB104.csv",
            "--guided",
            "--effect",
            "plant_effects.py:TwoSlopes",
        ],
        input="add two_slopes\nquit\n",
        capture_output=True,
        text=True,
        check=False,
        cwd=written,
        env={**os.environ, "PYTHONPATH": str(ROOT), "SLIPJUMP_SESSIONS": str(written / "sessions")},
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "+ two_slopes" in done.stdout
    assert "found: two slopes at " in done.stdout


@pytest.mark.parametrize("check", checks_of("effects"), ids=lambda check: check.name)
def test_the_example_keeps_the_contract(two_slopes, check):
    check(two_slopes)


def test_above_the_split_the_slope_is_another(two_slopes):
    position = two_slopes.apply(np.array([40.0, 50.0, 60.0]), np.array([50.0, 3.0]), 1.0)
    np.testing.assert_array_equal(position, [40, 50, 80])


def test_a_name_that_is_taken_is_refused_with_whose_it_is(offered):
    offered.append(EntryPoint("own", "agent.physics.effects.deadband:Deadband", "slipjump.effects"))
    with pytest.raises(ValueError, match=r"deadband:Deadband offers an effect 'deadband'"):
        effects()
