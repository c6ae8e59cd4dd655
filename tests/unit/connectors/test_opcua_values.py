"""Data values of OPC UA become samples, fields of an alarm become variants."""

import math
from datetime import UTC, datetime

import pytest
from asyncua import ua

from connectors.base import LoopRole, Quality
from connectors.opcua.values import change_of, is_waiting, sample, variant

SOURCE = datetime(2023, 11, 14, 22, 13, 20, tzinfo=UTC)
Kind = ua.VariantType


def value(number, kind=Kind.Double, status=ua.StatusCodes.Good, **stamps):
    stamps = stamps or {"SourceTimestamp": SOURCE}
    return change_of(ua.DataValue(ua.Variant(number, kind), ua.StatusCode(status), **stamps))


@pytest.mark.parametrize(
    ("status", "quality"),
    [
        (ua.StatusCodes.Good, Quality.GOOD),
        (ua.StatusCodes.GoodClamped, Quality.GOOD),
        (ua.StatusCodes.UncertainLastUsableValue, Quality.UNCERTAIN),
        (ua.StatusCodes.BadSensorFailure, Quality.BAD),
    ],
)
def test_status_becomes_quality_and_the_code_stays(status, quality):
    got = sample("FIC101.PV", value(2.5, status=status))
    assert (got.value, got.time, got.quality, got.code) == (2.5, 1.7e9, quality, status)


def test_the_servers_time_stands_in_for_the_sources():
    assert sample(LoopRole("FIC101", "pv"), value(1.0, ServerTimestamp=SOURCE)).time == 1.7e9


@pytest.mark.parametrize(("number", "kind"), [(3, Kind.Int16), (True, Kind.Boolean), (3.0, Kind.Float)])
def test_every_number_is_a_float(number, kind):
    got = sample(LoopRole("FIC101", "pv"), value(number, kind))
    assert got.value == float(number)
    assert isinstance(got.value, float)


@pytest.mark.parametrize(
    "data",
    [
        value(math.nan),
        value("text", Kind.String),
        value([1.0, 2.0]),
        change_of(ua.DataValue(None, ua.StatusCode(ua.StatusCodes.Good), SourceTimestamp=SOURCE)),
    ],
)
def test_what_is_no_number_is_missing(data):
    got = sample(LoopRole("FIC101", "pv"), data)
    assert math.isnan(got.value)
    assert got.quality is Quality.BAD


def test_a_mode_may_be_text():
    assert sample(LoopRole("FIC101", "mode"), value("CAS", Kind.String)).value == "CAS"


def test_a_node_that_waits_has_no_value_yet():
    assert is_waiting(change_of(ua.DataValue(None, ua.StatusCode(ua.StatusCodes.BadWaitingForInitialData))))
    assert not is_waiting(value(1.0))


@pytest.mark.parametrize(
    ("field", "kind", "written"),
    [
        (True, Kind.Boolean, True),
        (True, Kind.Int16, 1),
        (2.6, Kind.Int32, 3),
        (1e9, Kind.Int16, 2**15 - 1),
        (-1.0, Kind.UInt16, 0),
        (2.5, Kind.Float, 2.5),
        (3, Kind.Double, 3.0),
        (3, Kind.String, "3"),
        (None, Kind.String, ""),
        (1.7e9, Kind.DateTime, SOURCE),
    ],
)
def test_a_field_takes_the_nodes_type(field, kind, written):
    got = variant(field, kind)
    assert got.Value == written
    assert got.VariantType == kind


def test_not_known_is_nan_where_the_type_has_it_and_nothing_where_it_has_not():
    assert math.isnan(variant(None, Kind.Double).Value)
    assert variant(None, Kind.Int32) is None
    assert variant(math.nan, Kind.DateTime) is None
    assert variant("text", Kind.Double) is None
    assert variant(1.0, Kind.Guid) is None
