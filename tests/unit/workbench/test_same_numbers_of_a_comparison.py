"""One comparison in text, conversation, JSON, pictures and report: each number is the same everywhere."""

import json
import re
from html import unescape

import pytest
from loops import slack
from matplotlib.text import Text

from agent.cli.comparing.words import lines_of, view_of
from agent.physics.effects import EFFECTS
from agent.plots.workbench.comparison_figures import comparison_figures
from agent.plots.workbench.report import report_html
from agent.report.comparison_json import comparison_json
from agent.report.comparison_text import comparison_lines
from agent.report.numbers import odds_words
from agent.workbench.session import Workbench

pytestmark = pytest.mark.timeout(240)  # a cold cache of kernels takes a minute
TRIED = {"deadband", "sensor_lag", "load_step"}
PRINTED = ("text", "conversation", "report")


@pytest.fixture(scope="module")
def printed():
    """What one comparison prints, draws and writes; its JSON as a reader of the command gets it."""
    bench = Workbench(slack(), without=tuple(each.name for each in EFFECTS if each.name not in TRIED))
    bench.comparison()
    bench.add("deadband")
    found = bench.comparison()
    figures = comparison_figures(bench, found)
    words = {
        "text": "\n".join(comparison_lines(found)),
        "conversation": "\n".join(lines_of(view_of(found))),
        "report": unescape(re.sub(r"<[^>]+>", " ", report_html(found, figures))),
    }
    drawn = {
        name: " | ".join(each.get_text() for each in figure.findobj(Text)) for name, figure in figures.items()
    }
    return json.loads(json.dumps(comparison_json(found, "slack.csv"))), words, drawn


def test_errors_and_fits_of_the_steps(printed):
    own, words, drawn = printed
    base, last = own["steps"]
    for step in (base, last):
        assert all(f"{step['rmse_held_out']:.4g}" in words[name] for name in PRINTED)
        assert all(f"{step['rmse_fit']:.4g}" in words[name] for name in ("text", "report"))
        percent = f"{step['fit_percent']:.1f}"
        assert all(percent in words[name] for name in ("text", "report"))
        assert f"fit {percent} %" in drawn["overlay"]
    fall = f"{100 * (last['rmse_held_out'] / base['rmse_held_out'] - 1):+.0f} %"
    assert f"held-out error {fall}" in words["report"]
    assert f"held-out error {fall}" in words["conversation"]
    assert fall in drawn["staircase"]


def test_parameters_and_the_noise_floor(printed):
    own, words, _ = printed
    for name, each in own["steps"][-1]["parameters"].items():
        value, low, high = (f"{each[key]:.4g}" for key in ("value", "low", "high"))
        assert re.search(rf"{re.escape(name)}\s+{re.escape(value)}\b.*\({low} to {high}\)", words["text"])
        assert re.search(rf"{re.escape(name)}\s+{re.escape(value)}\s+{low} to {high}", words["report"])
    each = own["steps"][-1]["parameters"]["deadband.s"]
    headline = f"{each['value']:.4g} {each['unit']} ({each['low']:.4g} to {each['high']:.4g})"
    assert all(headline in words[name] for name in ("conversation", "report"))
    floor = own["noise_floor"]
    low, high = f"{floor['low']:.4g}", f"{floor['high']:.4g}"
    assert f"between {low} and {high}" in words["text"]
    assert f"between {low} and {high}" in words["report"]


def test_candidates_and_where_it_fails(printed):
    own, words, drawn = printed
    assert own["candidates"]
    for each in own["candidates"]:
        share, low, high = (
            re.sub(r"^-0\.0$", "0.0", f"{each[key]:.1f}")
            for key in ("error_reduction_percent", "low", "high")
        )
        share, ends = f"{share} %", f"({low} to {high})"
        line = rf"{each['effect']}\s+{re.escape(share)}\s+{re.escape(ends)}  (.*)$"
        said = [re.search(line, words[name], re.MULTILINE).group(1) for name in ("text", "conversation")]
        assert said[0] == said[1]
        exponent = each["log10_odds"]
        odds = None if exponent is None else odds_words(exponent)
        not_confirmed = f"not confirmed: {each['objection']}"
        assert said[0] in (
            odds,
            f"p = {each['p']:.2g}",
            "may be chance",
            "no likelier with it",
            not_confirmed,
        )
        beside = "not confirmed" if said[0].startswith("not confirmed") else said[0]
        assert f"{each['effect'].replace('_', ' ')}  ({beside})" in drawn["candidates"]
    for each in own["where_it_fails"]:
        axis = re.search(rf"{each['axis']}\s+([\d.]+) %  p = (\S+)", words["text"])
        assert axis is None or axis.groups() == (f"{100 * each['share']:.1f}", f"{each['p']:.2g}")
        assert f"p = {each['p']:.2g}" in drawn["where_it_fails"]
