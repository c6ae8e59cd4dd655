"""The grid and the two searches on the sticking loops of Lee's Table I whose OP and PV are public."""

import pytest

from agent.analysis.quantify import quantifier
from agent.analysis.record.window_of_recording import loop_window
from connectors.recording import read_recording


@pytest.mark.parametrize("method", ["choudhury2008", "jelali2008", "jelali2008_pattern"])
@pytest.mark.parametrize(("name", "s"), [("CHEM10", 1.70), ("CHEM12", 1.42)])
def test_they_say_stiction_with_about_the_s_of_the_paper(recordings, method, name, s):
    window = loop_window(read_recording(recordings / "isdb" / f"{name}.csv"))
    found = quantifier(method).quantify(window)
    assert found.decision == "stiction"
    assert found.stiction.s.value == pytest.approx(s, abs=0.1 * window.op_span)
