"""The page as a person uses it, in Debian's chromium, on a simulated plant whose alarms go to MQTT."""

import json
import queue
import re

import paho.mqtt.client as mqtt
import pytest
from playwright.sync_api import expect

from agent.analysis.plant.plant import PlantFinding, PlantGroup
from agent.analysis.plant.root import Suspect
from agent.analysis.plant.wave import Wave
from agent.runtime.plant_wide import PlantLook
from agent.web.screens.work_list import groups_of
from tests.browser.plant import HOSTILE
from tests.conftest import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]
ALL_SIZES = [
    (390, "dark"),
    *(
        pytest.param(*each, marks=pytest.mark.bench)
        for each in ((390, "light"), (1280, "dark"), (1280, "light"))
    ),
]
AXE = (ROOT / "tests" / "browser" / "vendor" / "axe.min.js").read_text(encoding="utf-8")
STICKS = "[data-testid=work-list] [data-loop=FIC101][data-verdict=stiction]"


def alarm_states(port, loop):
    """Published states of an alarm, as a client of the plant gets them."""
    states, topic = queue.Queue(), f"slipjump/{loop}/alarm"
    client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)

    def received(_client, _data, message):
        if message.topic == topic:  # amqtt was seen to send messages of other topics
            states.put(json.loads(message.payload))

    client.on_message = received
    client.connect("127.0.0.1", port)
    client.subscribe(topic, qos=1)
    client.loop_start()
    return client, states


def serious(page):
    """What axe finds that keeps somebody out."""
    page.evaluate(AXE)
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [
        (each["id"], [node["html"][:160] for node in each["nodes"]][:4])
        for each in found
        if each["impact"] in ("serious", "critical")
    ]


def wider(page):
    """By how much the page is wider than its window, px."""
    return page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")


def test_the_sticking_loop_is_at_the_top_opened_acknowledged_and_seen_on_mqtt(plant, open_page):
    page = open_page()
    page.goto(plant.address)
    page.wait_for_selector(f"{STICKS}.unacked_active", timeout=400_000)  # compiles and fits
    assert page.locator("[data-testid=work-list] [data-loop]").first.get_attribute("data-loop") == "FIC101"
    assert page.locator(f"[data-loop='{HOSTILE}']").inner_text().startswith(HOSTILE)
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(f"{plant.address}alarms")
    page.wait_for_selector("[data-testid=acknowledge-here]")  # what is hidden beside its word was too wide
    assert wider(page) <= 0
    page.goto(plant.address)
    page.set_viewport_size({"width": 1280, "height": 900})
    page.click(f"{STICKS} a")
    page.wait_for_url("**/loops/FIC101")
    page.wait_for_selector("[aria-label^='PV and PV of the model'] canvas")
    client, states = alarm_states(plant.broker, "FIC101")
    try:
        page.fill("#decision-by", "jane")
        page.fill("textarea", "packing is ordered <b>today</b>")
        page.click("[data-testid=acknowledge]")
        page.wait_for_selector("text=Alarm, acknowledged")
        while (state := states.get(timeout=60))["state"] != "acked_active":
            pass
        assert state["by"] == "jane"
    finally:
        client.loop_stop()
        client.disconnect()
    page.wait_for_selector("[data-testid=acknowledge]:disabled")
    page.goto(f"{plant.address}alarms")
    page.wait_for_selector("[data-loop=FIC101][data-alarm=acked_active]")
    page.wait_for_selector("text=packing is ordered <b>today</b>")


def tab_to(page, selector, presses=120):
    """Press Tab until the element has the focus."""
    for _ in range(presses):
        page.keyboard.press("Tab")
        if page.evaluate("selector => document.activeElement.matches(selector)", selector):
            return
    raise AssertionError(f"Tab does not lead to {selector}")


def test_by_keyboard_alone(plant, open_page):
    """Open the loop, shelve its alarm with a reason, take it back, acknowledge: no mouse."""
    page = open_page()
    page.goto(plant.address)
    page.wait_for_selector(STICKS)
    tab_to(page, "[data-loop=FIC101] a")
    page.keyboard.press("Enter")
    page.wait_for_url("**/loops/FIC101")
    page.wait_for_selector("[data-testid=acknowledge]")
    tab_to(page, "#decision-by")
    page.keyboard.press("Control+A")
    page.keyboard.type("joe")
    tab_to(page, "#decision-comment")
    page.keyboard.type("calibration")
    tab_to(page, "[data-testid=shelve]:not([disabled])")
    page.keyboard.press("Enter")
    page.wait_for_selector("[data-testid=unshelve]:not([disabled])")
    tab_to(page, "[data-testid=unshelve]")
    page.keyboard.press("Space")
    page.wait_for_selector("[data-testid=acknowledge]:not([disabled])")  # the valve sticks all the same
    tab_to(page, "[data-testid=acknowledge]")
    page.keyboard.press("Enter")
    page.wait_for_selector("text=Alarm, acknowledged")


@pytest.mark.parametrize(("width", "theme"), ALL_SIZES)
def test_every_screen_fits_and_keeps_nobody_out(plant, open_page, width, theme):
    page = open_page(width, 844, theme)
    for path, sign in (
        ("", STICKS),
        ("?view=map", ".plant-map .area"),
        ("loops/FIC101", ".chart canvas"),
        ("alarms", "[data-loop=FIC101]"),
        ("system", "[data-connection=mqtt]"),
        ("api/docs", ".operation"),
    ):
        page.goto(plant.address + path)
        page.wait_for_selector(sign)
        assert wider(page) <= 0, path
        assert serious(page) == [], path


def test_filter_search_and_hostile_name(plant, open_page):
    page = open_page()
    page.goto(plant.address)
    page.wait_for_selector(STICKS)
    page.click("button.filter.sticks")
    expect(page.locator("[data-testid=work-list] [data-loop]")).to_have_count(1, timeout=60_000)
    page.click("button.filter.sticks")
    page.fill("input[type=search]", "<SCRIPT>")
    expect(page.locator("[data-testid=work-list] [data-loop]")).to_have_count(1, timeout=60_000)
    page.click("[data-testid=work-list] th a")
    page.wait_for_selector("h1")
    assert page.locator("h1").inner_text() == HOSTILE
    assert page.title() == HOSTILE


def group_of(period, loops, path):
    """A group whose first loop is the likeliest root; all else of a wave is not shown."""
    suspects = tuple(
        Suspect(loop, Wave(k, period, 0.5), p, {"drives": 1.0}) for k, (loop, p) in enumerate(loops)
    )
    return PlantGroup(period, suspects, path)


def test_groups_of_loops_with_root_and_path_and_a_hostile_name(plant, open_page):
    page = open_page(390)
    page.goto(plant.address)
    before = page.locator("[data-testid=groups]")
    assert "not yet since the start" in before.inner_text()  # the first look comes after an hour
    root, last = "11-PIC/1 <b>bold</b>", "LIC9"
    finding = PlantFinding(
        (
            group_of(612.0, ((root, 0.72), (HOSTILE, 0.2), (last, 0.08)), ((root, HOSTILE), (HOSTILE, last))),
            group_of(61.5, (("FIC101", 0.9), (last, 0.1)), (("FIC101", last),)),
        ),
        (root, HOSTILE, last, "FIC101"),
        7200.0,
    )
    answer = groups_of(PlantLook(1.7e9, finding, 3))
    page.route("**/api/work-list/groups", lambda route: route.fulfill(json=answer))
    page.goto(plant.address)
    page.wait_for_selector(STICKS)
    seen = page.locator("details[data-testid=groups]")
    assert seen.locator("summary").inner_text().startswith("4 loops oscillate together, in 2 groups")
    assert ", 3 not (" in seen.locator("summary").inner_text()
    page.click("[data-testid=groups] summary")
    first = seen.locator("[data-group-root]").first
    assert first.get_attribute("data-group-root") == root
    text = first.locator("p").inner_text()
    assert text.startswith(f"Period 612 s, 3 loops. Likeliest root {root}, 72 %: its past says more")
    # The path: each loop is a list item within that of the loop it follows.
    assert first.locator(".path > li > ul > li > ul > li > a").inner_text() == last
    assert first.locator(".path > li > ul > li > a").inner_text() == HOSTILE
    address = first.locator(".path > li > a").get_attribute("href")
    assert address == "/loops/11-PIC%2F1%20%3Cb%3Ebold%3C%2Fb%3E"
    assert seen.locator("b, script").count() == 0
    assert wider(page) <= 0
    assert serious(page) == []


def test_filters_that_an_engineer_looks_for_are_always_there_and_the_map_dims_the_others(plant, open_page):
    page = open_page()
    page.goto(plant.address)
    page.wait_for_selector(STICKS)
    for group in ("sticks", "suspected", "tight_tuning", "disturbance", "not_testable", "stale"):
        assert re.fullmatch(r".+ \d+", page.locator(f"button.filter.{group}").inner_text().replace("\n", " "))
    page.goto(f"{plant.address}?view=map&group=sticks")
    page.wait_for_selector(".mark.sticks:not(.dim)")
    page.wait_for_selector(".mark.healthy.dim, .mark.waiting.dim, .mark.undecided.dim")
    assert serious(page) == []
    assert "S " in page.locator(".mark.sticks").inner_text()


def test_what_needs_a_reason_is_refused_without_one_and_a_repair_stands_in_the_history(plant, open_page):
    page = open_page()
    page.goto(f"{plant.address}loops/FIC103")
    page.fill("#decision-by", "jane")
    page.click("[data-testid=repaired]")
    page.wait_for_selector("text=Enter what was done as the comment first.")
    assert page.evaluate("document.activeElement.id") == "decision-comment"
    page.fill("#decision-comment", "positioner <i>replaced</i>")
    page.click("[data-testid=repaired]")
    page.wait_for_selector("tr:has-text('Repaired'):has-text('positioner <i>replaced</i>')")
    page.click("[data-testid=shelve]")
    page.wait_for_selector("text=Enter a reason as the comment first.")
    page.fill("#decision-comment", "stop in week 48")
    page.click("[data-testid=shelve]")
    page.click("button:has-text('Unshelve')")
    page.wait_for_selector("button:has-text('Unshelve')", state="detached")
    page.click("summary:has-text('Download')")
    assert page.locator(".menu-items a").count() >= 1
    opening = page.locator("a:has-text('Open in the workbench')").get_attribute("href")
    assert opening == "/workbench?loop=FIC103"


def test_the_theme_button_changes_the_theme_and_it_is_kept(plant, open_page):
    page = open_page()
    page.goto(plant.address)
    ground = "getComputedStyle(document.documentElement).backgroundColor"
    before = page.evaluate(ground)
    page.click("button.theme")
    page.click("button.theme")
    assert page.evaluate(ground) != before
    page.reload()
    page.wait_for_selector("button.theme")
    assert page.evaluate(ground) != before


@pytest.mark.bench
def test_a_lost_connection_is_shown_and_mends_itself(plant, open_page):
    page = open_page(errors_expected=True)
    page.goto(plant.address)
    page.wait_for_selector("[data-testid=work-list] [data-loop]")
    plant.stop()
    page.wait_for_selector(".lost:not([hidden])")
    plant.start()
    page.wait_for_selector(".lost", state="hidden")
    page.wait_for_selector(STICKS)
