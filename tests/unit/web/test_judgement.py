"""A person's judgement in place of the verdict, and what is printed for the workshop."""

import pytest

from agent.runtime.store.history_file import Entry, HistoryFile
from agent.web.judgement import Judgement, standing
from tests.unit.web.clients import csrf
from tests.unit.web.test_screens import HOSTILE, plant_of

PATH = "/api/loops/FIC101/judgement"


async def test_a_judgement_is_signed_shown_kept_and_withdrawn():
    async with plant_of() as (web, plant):
        said = {"judgement": "sound", "by": " jane ", "comment": "new packing <b>yesterday</b>"}
        assert (await web.post(PATH, json=said)).status_code == 403  # without a CSRF token
        headers = await csrf(web)
        row = (await web.post(PATH, json=said, headers=headers)).json()
        assert (row["group"], row["words"], row["verdict"]) == ("healthy", "No stiction", "stiction")
        assert (row["judgement"]["by"], row["judgement"]["judgement"]) == ("jane", "sound")
        assert row["alarm"] == "unacked_active"  # the alarm stays
        history = (await web.get("/api/loops/FIC101/history")).json()
        assert history[-1]["action"] == "judged: sound"
        assert history[-1]["comment"] == said["comment"]
        withdrawn = (await web.post(PATH, json={**said, "judgement": "withdrawn"}, headers=headers)).json()
        assert (withdrawn["group"], withdrawn["judgement"]) == ("sticks", None)
        assert plant.judgements == {}
        for wrong in ({**said, "by": ""}, {**said, "comment": ""}, {**said, "judgement": "perhaps"}):
            assert (await web.post(PATH, json=wrong, headers=headers)).status_code == 422


async def test_a_repair_is_signed_and_stands_in_the_history():
    async with plant_of() as (web, _):
        path, said = "/api/loops/FIC101/repair", {"by": " jane ", "comment": "new packing"}
        headers = await csrf(web)
        assert (await web.post(path, json=said, headers=headers)).status_code == 204
        newest = (await web.get("/api/loops/FIC101/history")).json()[-1]
        assert (newest["action"], newest["by"], newest["comment"]) == ("repaired", "jane", "new packing")
        assert (await web.post(path, json={**said, "comment": ""}, headers=headers)).status_code == 422
        nobody = "/api/loops/NOBODY/repair"
        assert (await web.post(nobody, json=said, headers=headers)).status_code == 404


def test_what_was_said_stands_after_a_restart(tmp_path):
    file = HistoryFile(tmp_path / "agent.history.sqlite")

    def note(time, loop, judgement):
        return Entry(time, loop, "note", {"judgement": judgement, "by": "jane", "comment": "why"})

    file.write(
        [
            note(1.0, "A", "sticks"),
            note(2.0, "B", "sound"),
            Entry(2.5, "B", "note", {"action": "acknowledge", "by": "joe"}),
            note(3.0, "A", "withdrawn"),
            Entry(4.0, "B", "diagnosis", {"verdict": "stiction"}),
        ],
        5.0,
    )
    assert standing(file.notes()) == {"B": Judgement("sound", "jane", "why", 2.0)}
    file.close()


@pytest.mark.parametrize("page", ["work-order", "figure.svg"])
async def test_what_is_printed_has_no_script_and_escapes_names(page):
    async with plant_of() as (web, _):
        answer = await web.get(f"/api/loops/{HOSTILE}/{page}")
        assert answer.status_code == 200
        assert "<script" not in answer.text
        assert "script-src" not in answer.headers["content-security-policy"]
        assert (await web.get(f"/api/loops/NOBODY/{page}")).status_code == 404
        if page == "work-order":
            order = (await web.get("/api/loops/FIC101/work-order")).text
            assert "Work order: control valve of FIC101" in order
            assert "bump test" in order
            assert "S = 4 OP units" in order
            assert "Found: ____" in order
            assert "<svg" in order
