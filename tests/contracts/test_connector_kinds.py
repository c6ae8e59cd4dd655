"""What every bus in the registry promises."""

import pytest
from pydantic import ValidationError

from connectors.base import Connector
from connectors.kinds import KINDS, ROLES, LoopTags
from connectors.options import NoTag

OPTIONS = {"opcua": {"url": "opc.tcp://127.0.0.1:4840"}}
TAGS = {
    "modbus": {"table": "input", "address": 0},
    "opcua": {"node": "ns=2;s=FIC101.PV"},
    "mqtt": {"topic": "plant/FIC101/PV"},
}

each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.kind)


def test_names_differ():
    assert len({kind.kind for kind in KINDS}) == len(KINDS)


@each_kind
def test_opens_nothing_before_a_session_is_asked_for(kind):
    options = kind.options.model_validate(OPTIONS.get(kind.kind, {}))
    loops = {
        "FIC101": LoopTags(
            dict.fromkeys(kind.roles, kind.tag.model_validate(TAGS.get(kind.kind, {}))),
            [kind.target.model_validate({"connection": "unit1"})],
        )
    }
    connector: Connector = kind.open("unit1", options, loops)
    assert connector.name == "unit1"


@each_kind
def test_takes_every_role_or_none(kind):
    assert set(ROLES) <= set(kind.roles) or (kind.roles == () and kind.tag is NoTag)


@each_kind
@pytest.mark.parametrize("part", ["options", "tag", "target"])
def test_an_unknown_key_is_a_fault(kind, part):
    known = {
        "options": OPTIONS.get(kind.kind, {}),
        "tag": TAGS.get(kind.kind, {}),
        "target": {"connection": "unit1"},
    }
    model = getattr(kind, part)
    model.model_validate(known[part])
    with pytest.raises(ValidationError, match="typo"):
        model.model_validate({**known[part], "typo": 1})


@each_kind
def test_every_option_tells_what_it_is(kind):
    schema = kind.options.model_json_schema()
    plain = {"host", "port"}
    assert all(
        "description" in schema["properties"][name]
        for name in schema["properties"]
        if name not in plain | {"url"}
    )
