"""An array of a publish response whose length is less than that of a null one."""

import struct

import pytest
from asyncua import ua
from asyncua.ua.ua_binary import struct_to_binary

from connectors.opcua.notification import read_response

AVAILABLE = 32
"""Where the available sequence numbers begin, behind header and subscription."""


def response(count):
    found = ua.PublishResponse(Parameters=ua.PublishResult(5, [7], False, ua.NotificationMessage(7)))
    data = bytearray(struct_to_binary(found))
    data[AVAILABLE : AVAILABLE + 4] = struct.pack("<i", count)
    return bytes(data)


@pytest.mark.parametrize("count", [-2, -(2**31)])
def test_it_is_left_to_asyncua(count):
    """Which refuses it."""

    def other(*_):
        pytest.fail("there is no item")

    assert read_response(response(1), other).available == [7]
    assert read_response(response(count), other) is None
