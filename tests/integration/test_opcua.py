"""What only OPC UA has: subscriptions that may die in silence, status codes, nodes that come late."""

import math

import pytest
from asyncua import Client, ua
from buses import START, connector_of, connector_to, wave

from connectors.base import ConnectionLostError, LoopRole, Publication, Quality, RefusedError
from connectors.checks import Reader
from connectors.checks.session import until
from simulators.plant import Row
from simulators.servers.opcua import OpcUaServer


def serving():
    return OpcUaServer({"FIC101": ("pv", "op", "mode")})


async def read(server, node):
    async with Client(f"opc.tcp://127.0.0.1:{server.port}") as client:
        return await client.get_node(node).read_value()


async def test_a_value_measured_again_counts_though_it_is_the_same():
    async with serving() as server:
        async with connector_to(server, ["FIC101"]).session() as session, Reader(session) as reading:
            for i in range(5):
                await server.put("FIC101", Row(START + i, {"pv": 1.0, "op": 50.0, "mode": "AUTO"}))
                await until(
                    lambda: reading.of(LoopRole("FIC101", "op"))
                )  # from the first on, it is subscribed
            await until(lambda: len(reading.of(LoopRole("FIC101", "op"))) == 5)
        assert {sample.value for sample in reading.of(LoopRole("FIC101", "op"))} == {50.0}


async def test_a_bad_status_is_a_bad_value_with_its_code():
    async with serving() as server:
        async with connector_to(server, ["FIC101"]).session() as session, Reader(session) as reading:
            await server.put("FIC101", Row(START, {"pv": math.nan, "op": 1.0, "mode": "MAN"}))
            await until(lambda: len(reading.samples) == 3)
        (pv,) = reading.of(LoopRole("FIC101", "pv"))
        assert (pv.quality, pv.code, pv.time) == (Quality.BAD, ua.StatusCodes.BadSensorFailure, START)
        assert reading.of(LoopRole("FIC101", "mode"))[0].value == "MAN"


async def test_an_unknown_node_is_reported_once_and_found_when_it_comes():
    async with serving() as server:
        entry = server.loop_settings("FIC101", 1.0)
        entry["tags"]["sp"] = {"node": "ns=2;s=FIC101.LATE"}
        connector = connector_of({**server.connection_settings(), "retry": 0.05}, [entry])
        async with connector.session() as session, Reader(session) as reading:
            await until(lambda: reading.of(LoopRole("FIC101", "sp")))
            await server.put("FIC101", next(wave("FIC101", 1).rows()))
            await until(lambda: reading.of(LoopRole("FIC101", "pv")))
            (told,) = reading.of(LoopRole("FIC101", "sp"))
            assert (told.quality, told.code) == (Quality.BAD, ua.StatusCodes.BadNodeIdUnknown)
            node = ua.NodeId.from_string("ns=2;s=FIC101.LATE")
            await server._server.nodes.objects.add_variable(node, "2:LATE", 7.0)
            await until(lambda: len(reading.of(LoopRole("FIC101", "sp"))) > 1)
        assert [sample.value for sample in reading.of(LoopRole("FIC101", "sp"))[1:]] == [7.0]


async def test_a_server_that_answers_but_no_longer_publishes_is_reported():
    async with serving() as server:
        quick = {"timeout": 0.4, "keep_alive": 2}
        async with (
            connector_to(server, ["FIC101"], **quick).session() as session,
            Reader(session) as reading,
        ):
            await server.put("FIC101", next(wave("FIC101", 1).rows()))
            await until(lambda: reading.samples)
            (subscription,) = server._server.iserver.subscription_service.subscriptions.values()
            await subscription.stop()
            with pytest.raises(ConnectionLostError, match="nothing for"):
                await reading.end(within=5.0)


async def test_silence_of_a_healthy_server_is_no_loss():
    async with serving() as server:
        quick = {"timeout": 0.2, "keep_alive": 2}
        async with (
            connector_to(server, ["FIC101"], **quick).session() as session,
            Reader(session) as reading,
        ):
            await until(lambda: session._client.state.name == "CONNECTED")
            with pytest.raises(TimeoutError):
                await reading.end(within=1.5)


async def test_an_alarm_is_written_in_each_nodes_type():
    async with serving() as server:
        async with connector_to(server, ["FIC101"]).session() as session:
            fields = {"active": True, "state": "unack_active", "s": 4, "j": None, "f_s": 2.5, "f_d": 1.5}
            await session.publish(Publication("FIC101", "state", "1", fields))
            await session.publish(Publication("FIC101", "event", "2", {**fields, "active": False}))
        assert await read(server, "ns=2;s=FIC101.STICTION") is True
        assert await read(server, "ns=2;s=FIC101.STICTION.S") == 4.0
        assert math.isnan(await read(server, "ns=2;s=FIC101.STICTION.J"))
        assert await read(server, "ns=2;s=FIC101.STICTION.STATE") == "unack_active"


@pytest.mark.parametrize(
    ("node", "said"), [("ns=2;s=NOWHERE", "BadNodeIdUnknown"), ("ns=2;s=FIC101.PV", "BadUserAccessDenied")]
)
async def test_an_alarm_the_server_refuses_is_reported(node, said):
    async with serving() as server:
        entry = server.loop_settings("FIC101", 1.0)
        entry["publish"] = [{"connection": "plant", "active": {"node": node}}]
        async with connector_of(server.connection_settings(), [entry]).session() as session:
            with pytest.raises(RefusedError, match=f"{node}: {said}"):
                await session.publish(Publication("FIC101", "state", "1", {"active": True}))


async def test_a_node_that_is_made_anew_is_found_and_spares_the_others():
    """asyncua's server forgets who watched a node that was deleted, and says nothing, as others do."""
    async with serving() as server:
        connector = connector_of(
            {**server.connection_settings(), "retry": 0.1}, [server.loop_settings("FIC101", 1.0)]
        )
        async with connector.session() as session, Reader(session) as reading:
            rows = wave("FIC101", 1000, roles=("pv", "op", "mode")).rows()
            await server.put("FIC101", next(rows))
            await until(lambda: reading.of(LoopRole("FIC101", "pv")))
            node = ua.NodeId.from_string("ns=2;s=FIC101.PV")
            aspace = server._server.iserver.aspace
            for handle, (watched, _) in list(aspace._handle_to_attribute_map.items()):
                if watched == node:  # as in a server that forgets
                    aspace.delete_datachange_callback(handle)
            await server._server.delete_nodes([server._server.get_node(node)])
            await until(lambda: reading.of(LoopRole("FIC101", "pv"))[-1].quality is Quality.BAD)
            assert reading.of(LoopRole("FIC101", "pv"))[-1].code == ua.StatusCodes.BadNodeIdUnknown
            await server._server.nodes.objects.add_variable(node, "2:PV", 7.0)
            await until(lambda: reading.of(LoopRole("FIC101", "pv"))[-1].value == 7.0)
            assert len(reading.of(LoopRole("FIC101", "op"))) == 1  # nothing was opened anew


async def test_a_node_that_the_server_forgot_to_report_is_watched_anew():
    async with serving() as server:
        connector = connector_of(
            {**server.connection_settings(), "retry": 0.1}, [server.loop_settings("FIC101", 1.0)]
        )
        async with connector.session() as session, Reader(session) as reading:
            first, second = wave("FIC101", 2, roles=("pv", "op", "mode")).rows()
            await server.put("FIC101", first)
            await until(lambda: reading.of(LoopRole("FIC101", "pv")))
            aspace = server._server.iserver.aspace
            for handle, (watched, _) in list(aspace._handle_to_attribute_map.items()):
                if watched == ua.NodeId.from_string("ns=2;s=FIC101.PV"):
                    aspace.delete_datachange_callback(handle)
            await server.put("FIC101", second)
            await until(lambda: reading.of(LoopRole("FIC101", "pv"))[-1].time == second.time)
            assert [sample.value for sample in reading.of(LoopRole("FIC101", "pv"))] == [0.0, 1.0]
