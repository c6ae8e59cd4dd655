"""Orders by message: read, or counted and the first of its kind told."""

import json
import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from connectors.base import Order
from connectors.mqtt.orders import REMEMBERED, OrderReader

TOPIC, NOW = "slipjump/FIC101/alarm/order", 1.8e9


def reader():
    return OrderReader({TOPIC: "FIC101"})


def read(payload, *, of=None, retained=False):
    raw = payload if isinstance(payload, bytes) else json.dumps(payload).encode()
    return (of or reader()).order(TOPIC, raw, NOW, retained=retained)


@pytest.mark.parametrize(
    ("payload", "order"),
    [
        ({"action": "acknowledge", "by": "jane"}, Order("FIC101", "acknowledge", "jane")),
        (
            {"action": "acknowledge", "by": "jane", "alarm": "FIC101/1.000", "id": "7"},
            Order("FIC101", "acknowledge", "jane", None, "FIC101/1.000"),
        ),
        ({"action": "shelve", "by": "j", "minutes": 30}, Order("FIC101", "shelve", "j", NOW + 1800)),
        ({"action": "shelve", "by": "j", "until": NOW + 5}, Order("FIC101", "shelve", "j", NOW + 5)),
        (
            {"action": "shelve", "by": "j", "until": "2027-01-15T08:00:05Z"},
            Order("FIC101", "shelve", "j", 1800000005.0),
        ),
        ({"action": "in_service", "by": "Ω"}, Order("FIC101", "in_service", "Ω")),
    ],
)
def test_an_order_is_read(payload, order):
    assert read(payload) == order


@pytest.mark.parametrize(
    ("payload", "why"),
    [
        (b"acknowledge", "Invalid JSON"),
        (b"\xff", "Invalid JSON"),
        ([], "object"),
        ({}, "action"),
        ({"action": "explode", "by": "jane"}, "action"),
        ({"action": "acknowledge"}, "by"),
        ({"action": "acknowledge", "by": ""}, "by"),
        ({"action": "acknowledge", "by": "jane\nroot: all is well"}, "by"),
        ({"action": "acknowledge", "by": "jane", "untill": 5}, "untill"),
        ({"action": "acknowledge", "by": "jane", "minutes": 5}, "acknowledge has no minutes"),
        ({"action": "shelve", "by": "jane"}, "one of until and minutes"),
        ({"action": "shelve", "by": "jane", "minutes": 5, "until": NOW}, "one of until and minutes"),
        ({"action": "shelve", "by": "jane", "minutes": -5}, "minutes"),
        ({"action": "shelve", "by": "jane", "until": "tomorrow"}, "ISO 8601"),
        ({"action": "shelve", "by": "jane", "until": float("inf")}, "until"),
        (b"[" * 9000, "Invalid JSON"),
        (b" " * 20_000, "longer than"),
    ],
)
def test_what_is_no_order_is_counted_and_the_first_is_reported(payload, why, caplog):
    these = reader()
    for _ in range(3):
        assert read(payload, of=these) is None
    assert these.malformed == 3
    (told,) = [record.message for record in caplog.records]
    assert TOPIC in told
    assert why in told


@given(
    st.binary(max_size=200)
    | st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(),
        lambda inner: (
            st.lists(inner)
            | st.dictionaries(
                st.sampled_from(["action", "by", "until", "minutes", "alarm", "id", "x"]), inner
            )
        ),
    )
)
def test_nothing_that_comes_breaks_it(payload):
    logging.disable()
    try:
        order = read(payload)
    finally:
        logging.disable(logging.NOTSET)
    assert order is None or order.by


def test_an_order_that_the_broker_kept_never_acts(caplog):
    these = reader()
    order = {"action": "acknowledge", "by": "jane"}
    assert [read(order, of=these, retained=True) for _ in range(2)] == [None, None]
    assert these.retained == 2
    assert ["retained" in record.message for record in caplog.records] == [True]
    assert read(order, of=these) is not None


def test_an_order_with_an_id_acts_once_and_one_without_each_time():
    these = reader()
    numbered = [read({"action": "unshelve", "by": "j", "id": n}, of=these) for n in ("1", "1", "2", "1")]
    assert [order is not None for order in numbered] == [True, False, True, False]
    assert these.repeated == 2
    assert all(read({"action": "unshelve", "by": "j"}, of=these) for _ in range(2))


def test_ids_do_not_fill_the_memory():
    these = reader()
    for n in range(2 * REMEMBERED):
        read({"action": "unshelve", "by": "j", "id": str(n)}, of=these)
    assert len(these._obeyed) == REMEMBERED


def test_an_empty_message_says_nothing():
    these = reader()
    assert read(b"", of=these) is None
    assert these.malformed == 0
