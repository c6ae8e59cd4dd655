"""JSON Schema of the configuration file, for editors that complete and check while the user types."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from agent.settings.loop_list import LoopList
from agent.settings.models import AgentSettings, LoopSettings
from connectors.kinds import KINDS, ROLES


def json_schema() -> dict[str, Any]:
    """Return the schema of the whole file. ``slipjump check`` checks which address fits which connection."""
    models: list[type[BaseModel]] = [AgentSettings, LoopSettings, LoopList]
    read = [kind for kind in KINDS if kind.roles]
    models += [model for kind in KINDS for model in (kind.options, kind.target)] + [kind.tag for kind in read]
    refs, joint = models_json_schema([(model, "validation") for model in models])
    definitions = joint["$defs"]
    for kind in KINDS:
        options = definitions[kind.options.__name__]
        options["properties"] = {"kind": {"const": kind.kind}, **options.get("properties", {})}
        options["required"] = ["kind", *options.get("required", [])]
    loop = definitions["LoopSettings"]["properties"]
    tag = {"anyOf": [refs[kind.tag, "validation"] for kind in read]}
    roles = dict.fromkeys((*ROLES, *(role for kind in read for role in kind.roles)), tag)
    loop["tags"] = {
        "type": "object",
        "description": loop["tags"]["description"],
        "properties": roles,
        "required": ["pv", "op"],
        "additionalProperties": False,
    }
    loop["publish"]["items"] = {"anyOf": [refs[kind.target, "validation"] for kind in KINDS]}
    definitions["LoopList"]["properties"]["defaults"] = {
        **definitions["LoopSettings"],
        "properties": {**loop, "tags": {"type": "object"}},  # parts of an address may be in the list
        "required": [],
        "description": definitions["LoopList"]["properties"]["defaults"]["description"],
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "slipjump",
        "type": "object",
        "additionalProperties": False,
        "required": ["connections", "loops"],
        "properties": {
            "agent": refs[AgentSettings, "validation"],
            "connections": {
                "type": "object",
                "additionalProperties": {"anyOf": [refs[kind.options, "validation"] for kind in KINDS]},
            },
            "loops": {
                "type": "array",
                "minItems": 1,
                "items": {"anyOf": [refs[LoopSettings, "validation"], refs[LoopList, "validation"]]},
            },
        },
        "$defs": definitions,
    }


if __name__ == "__main__":
    import json
    import sys

    json.dump(json_schema(), sys.stdout, indent=2)
    sys.stdout.write("\n")
