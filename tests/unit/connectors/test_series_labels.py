"""Loops in the labels of a series, as Prometheus and Grafana name it."""

import pytest

from connectors.exports.cells.tag_roles import tag_role


@pytest.mark.parametrize(
    ("name", "loop", "role"),
    [
        ('PV {loop="FIC101"}', "FIC101", "pv"),
        ('plant_pv{instance="dcs:9100", loop="FIC101", job="opc"}', "FIC101", "pv"),
        ('value {loop="FIC101", role="OP"}', "FIC101", "op"),
        ('opcua_value{id="FIC101.OP",host="h"}', "FIC101", "op"),
        ("mqtt.value {topic: plant/FIC101/PV}", "plant/FIC101", "pv"),
        ('{__name__="op", device="FIC101"}', "FIC101", "op"),
        ("pv {site: x, area: A1}", "x/A1", "pv"),
        ("FIC101_PV {}", "FIC101", "pv"),
    ],
)
def test_loop_and_role_of_a_series(name, loop, role):
    found = tag_role(name)
    assert (found.loop, found.role) == (loop, role)


@pytest.mark.parametrize("name", ['up{job="opc"}', "{}", "value {loop: FIC101}", "{PV"])
def test_what_is_no_series_of_a_loop(name):
    assert tag_role(name) is None
