"""Configure: a loop or a connection, tried on the bus before it is saved, applied without a restart."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, HTTPException
from pydantic import BaseModel, Field

from agent.settings.schema import json_schema
from agent.web.configuration import Configuration, EntryChange, What, findings_json, form_yaml
from agent.web.screens.screen import PageScreen
from connectors.kinds import KINDS

LARGEST = 60_000
"""Characters of an entry."""


class Wish(BaseModel):
    """One loop or connection as somebody wants it: as a form, or as YAML."""

    what: What
    name: Annotated[str, Field(min_length=1, max_length=200)]
    entry: dict[str, Any] | None = None
    """From the form; what is empty is left out."""
    yaml: Annotated[str, Field(max_length=LARGEST)] | None = None
    """Instead of the form."""

    def change(self) -> EntryChange:
        """Return it as YAML."""
        text = self.yaml if self.yaml is not None else form_yaml(self.entry or {})
        return EntryChange(self.what, self.name, text)


class Saving(Wish):
    """What shall be saved."""

    digest: Annotated[str, Field(max_length=64)]
    """Of the file, as `check` returned it."""
    by: Annotated[str, Field(min_length=1, max_length=80)]
    """Who saves it."""


def screen(configuration: Configuration) -> PageScreen:
    """Return the screen of a configuration file."""
    router = APIRouter(prefix="/api/configure", tags=["configure"])

    @router.get("")
    async def entries() -> dict[str, Any]:
        """Connections and loops of the file, and what a loop needs on each kind of bus."""
        schema = json_schema()["$defs"]
        kinds = {
            kind.kind: {
                "roles": list(kind.roles),
                "tag": schema[kind.tag.__name__]["properties"] if kind.roles else {},
                "required": schema[kind.tag.__name__].get("required", []) if kind.roles else [],
                "options": schema[kind.options.__name__]["properties"],
            }
            for kind in KINDS
        }
        return await configuration.entries() | {"kinds": kinds}

    @router.post("/check")
    async def check(wish: Wish) -> dict[str, Any]:
        """All faults of an entry, the YAML and the lines of the file that would change. Writes nothing."""
        change = wish.change()
        found = await configuration.checked(change)
        return {
            "faults": list(found.faults),
            "yaml": change.text,
            "difference": found.difference,
            "digest": found.digest,
        }

    @router.post("/try")
    async def attempt(wish: Wish) -> dict[str, Any]:
        """Read each tag of a loop once from the live bus, or open a connection. Writes nothing."""
        change = wish.change()
        found = await configuration.checked(change)
        if found.settings is None:
            raise HTTPException(422, "; ".join(found.faults))
        return {"findings": findings_json(await configuration.tried(change, found.settings))}

    @router.post("/save")
    async def save(saving: Saving) -> dict[str, Any]:
        """Write the file and apply it; loops and connections that did not change go on."""
        try:
            faults = await configuration.saved(saving.change(), saving.digest, saving.by)
        except OSError as error:
            raise HTTPException(500, f"{configuration.path} cannot be written: {error.strerror}") from error
        if faults:
            raise HTTPException(409, "; ".join(faults))
        return {"saved": str(configuration.path)}

    return PageScreen("configure", "Configure", "/configure", router)
