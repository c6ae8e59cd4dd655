"""Servers that refuse too much at once are asked for less, and every question gets its own answer."""

from types import SimpleNamespace

import pytest
from asyncua import ua

from connectors.opcua.batches import Batches
from connectors.opcua.options import OpcUaOptions
from connectors.opcua.subscription import NodeSubscription


class Server:
    """Takes ``most`` questions at once."""

    def __init__(self, most, code=ua.StatusCodes.BadTooManyOperations):
        self.most = most
        self.code = code
        self.asked = []

    async def answer(self, questions):
        self.asked.append(len(questions))
        if len(questions) > self.most:
            raise ua.UaStatusCodeError(self.code)
        return [10 * question for question in questions]


@pytest.mark.parametrize("most", [1, 7, 100, 1000])
async def test_all_are_answered_in_order(most):
    server, batches = Server(most), Batches()
    assert await batches.ask(server.answer, range(700)) == [10 * n for n in range(700)]
    before = len(server.asked)
    await batches.ask(server.answer, range(20))
    assert all(count <= max(most, 1) for count in server.asked[before:])  # it was remembered


async def test_no_question_is_no_request():
    server = Server(5)
    assert await Batches().ask(server.answer, []) == []
    assert server.asked == []


@pytest.mark.parametrize(
    ("server", "error"),
    [
        (Server(0), "too many operations"),
        (Server(5, ua.StatusCodes.BadUserAccessDenied), "permission"),
    ],
)
async def test_other_refusals_and_one_question_that_is_too_many_are_reported(server, error):
    with pytest.raises(ua.UaStatusCodeError, match=error):
        await Batches().ask(server.answer, range(20))


async def test_an_answer_too_few_is_reported():
    async def short(questions):
        return questions[1:]

    with pytest.raises(ua.UaError, match="19 answers to 20 questions"):
        await Batches().ask(short, range(20))


async def test_a_subscription_watches_all_nodes_of_such_a_server():
    watched, nodes = [], [f"ns=2;i={n}" for n in range(90)]
    unknown = ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown)

    async def create(params):
        if len(params.ItemsToCreate) > 20:
            raise ua.UaStatusCodeError(ua.StatusCodes.BadTooManyOperations)
        asked = [request.ItemToMonitor.NodeId.to_string() for request in params.ItemsToCreate]
        watched.extend(asked)
        return [
            ua.MonitoredItemCreateResult(
                StatusCode=unknown if node == nodes[33] else ua.StatusCode(), MonitoredItemId=7
            )
            for node in asked
        ]

    fake = SimpleNamespace(create_monitored_items=create)
    wanted = ua.CreateSubscriptionParameters()
    refused = await NodeSubscription(fake, wanted, OpcUaOptions(url="opc.tcp://plant")).add(nodes)
    assert watched == nodes
    assert refused == {nodes[33]: unknown}
