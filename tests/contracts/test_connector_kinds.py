"""What every registered bus promises: the checks of ``connectors.checks``, and the models of its options."""

from functools import partial

import pytest
from pydantic import ValidationError

from connectors.checks import LOOPS, checks_of, garbage
from connectors.kinds import KINDS, ROLES
from connectors.options import NoTag
from simulators.servers.peers import peers_of

each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.kind)
OFTEN = 10_000


def items():
    """Each check of each kind; garbage ten thousand times in the bench."""
    for kind in KINDS:
        for check in checks_of(kind):
            yield pytest.param(kind, check, id=f"{kind.kind}-{check.__name__}")
        often = garbage.clients_may_send_garbage if kind.listens else garbage.garbage_is_a_loss
        marks = [pytest.mark.bench, pytest.mark.timeout(3600)]
        name = f"{kind.kind}-{often.__name__}-often"
        yield pytest.param(kind, partial(often, times=OFTEN), id=name, marks=marks)


@pytest.mark.parametrize(("kind", "check"), list(items()))
async def test_contract(kind, check):
    await check(kind, peers_of(kind))


def test_names_differ():
    assert len({kind.kind for kind in KINDS}) == len(KINDS)


@each_kind
def test_takes_every_role_or_none(kind):
    assert set(ROLES) <= set(kind.roles) or (kind.roles == () and kind.tag is NoTag)


@each_kind
async def test_an_unknown_key_is_a_fault(kind):
    async with peers_of(kind)() as peer:
        loop = peer.loop(LOOPS[0])
        known = [
            (kind.options, peer.connection()),
            *((kind.tag, tag) for tag in loop["tags"].values()),
            *((kind.target, {"connection": "unit1", **target}) for target in loop["publish"]),
        ]
    assert len(known) >= 2
    for model, entry in known:
        model.model_validate(entry)
        with pytest.raises(ValidationError, match="typo"):
            model.model_validate({**entry, "typo": 1})


@each_kind
def test_every_option_has_a_description(kind):
    schema = kind.options.model_json_schema()
    plain = {"host", "port", "url"}
    assert [
        name
        for name, entry in schema["properties"].items()
        if "description" not in entry and name not in plain
    ] == []
