"""What a column or tag is of: ``FIC101.PV``, ``FIC-101/PID1/OUT.CV`` or ``PV (t/h)``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

ROLES = {
    "pv": "pv meas measurement processvalue processvariable pvin actualvalue istwert messwert measuredvalue "
    "mesure",
    "op": "op out co output lmn controlleroutput controloutput outputvalue cout pidout stellwert stellgröße "
    "stellgroesse sortie",
    "sp": "sp sv setpoint spt setpointvalue sollwert wsp lsp setvalue",
    "mv": "mv valveposition position pos stem zt feedback travel readback valve",
    "mode": "mode md actualmode modeactual betriebsart automan auto_man",
    "quality": "quality status qual sts q statuscode opcquality confidence dataintegrity",
}
"""Role -> words for it, lower case, without blanks and underscores."""
ROLE = {word.replace("_", "").casefold(): role for role, words in ROLES.items() for word in words.split()}
VALUES = frozenset(
    {"cv", "value", "val", "fcv", "readvalue", "currentvalue", "act", "actual", "presentvalue", "v"}
)
"""Words behind a role that say no more than that its value is meant."""
BLOCK = re.compile(r"(?:PID|PIDA|AI|AO|FB|BLK|CTRL|LOOP|CTL)_?\d*", re.IGNORECASE)
"""Function blocks between tag and role."""
SERVER = re.compile(r"^(?:\\\\[^\\]+\\|\[[^\]]*\]|[A-Za-z]\w*://[^/]+/)")
"""``\\\\PISRV\\``, ``[default]`` before a tag."""
UNIT = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
TIME_WORDS = frozenset(
    [
        "time",
        "timestamp",
        "date",
        "datetime",
        "t",
        "zeit",
        "zeitstempel",
        "datum",
        "uhrzeit",
        "heure",
        "fecha",
        "hora",
        "tijd",
        "datetimeutc",
        "timeutc",
        "ts",
        "localtime",
        "utctime",
        "sampletime",
        "datumuhrzeit",
        "datetimelocal",
        "timelocal",
        "date/time",
        "elapsed",
        "elapsedtime",
        "epoch",
        "epochms",
        "eventtime",
        "readtime",
        "timestampms",
        "timestamputc",
        "tstamp",
        "unixtime",
    ]
)
TAG_WORDS = frozenset(
    [
        "tag",
        "tagname",
        "name",
        "point",
        "pointname",
        "item",
        "itemid",
        "itemname",
        "variable",
        "parameter",
        "sensor",
        "tagid",
        "path",
        "browsepath",
        "tagpath",
    ]
)
VALUE_WORDS = frozenset(
    [
        "value",
        "val",
        "reading",
        "wert",
        "valeur",
        "vvalue",
        "rawvalue",
        "tagvalue",
        "pointvalue",
        "numericvalue",
        "floatvalue",
        "avg",
        "average",
    ]
)


@dataclass(frozen=True, slots=True)
class TagRole:
    """A tag taken apart."""

    loop: str
    """Empty where the name is a role alone."""
    role: str
    """pv, op, sp, mv or mode."""
    of_quality: bool = False
    """Whether the column holds the quality of that role, not its value."""
    word: str = ""
    """The word for the role, lower case."""


def plain(name: str) -> str:
    """Return a name in lower case without unit, blanks, underscores and hyphens."""
    return re.sub(r"[\s_\-%]+", "", UNIT.sub("", name)).casefold()


def unit_of(name: str) -> str:
    """Return the unit in brackets behind a name, or an empty text."""
    found = UNIT.search(name)
    return found[1] if found else ""


@lru_cache(maxsize=100_000)
def tag_role(name: str) -> TagRole | None:
    """Return loop and role of a tag, or None where it has no word for a role."""
    bare = SERVER.sub("", UNIT.sub("", name)).strip()
    parts = [part for part in re.split(r"[./\\:|#]+", bare) if part]
    quality = False
    while parts and (plain(parts[-1]) in VALUES or (ROLE.get(plain(parts[-1])) == "quality")):
        quality = quality or ROLE.get(plain(parts[-1])) == "quality"
        parts.pop()
    if not parts:
        return None
    role = ROLE.get(plain(parts[-1]))
    if role is None or (role == "quality"):
        split = _within(parts[-1])
        if split is None:
            return None
        head, word, of_quality = split
        parts[-1:] = [head] if head else []
        quality = quality or of_quality
    else:
        word = plain(parts.pop())
    while len(parts) > 1 and BLOCK.fullmatch(parts[-1]):
        parts.pop()
    return TagRole("/".join(part.strip() for part in parts), ROLE[word], quality, word)


def _within(part: str) -> tuple[str, str, bool] | None:
    """Return loop, word of the role and whether quality is meant, of ``FIC101_PV`` or ``PV FIC101``."""
    words = [word for word in re.split(r"[\s_\-]+", part) if word]
    quality = len(words) > 1 and ROLE.get(plain(words[-1])) == "quality"
    if quality and len(words) == 2 and ROLE.get(plain(words[0]), "quality") != "quality":
        return "", plain(words[0]), True  # PV Status behind the loop of a path
    if (quality and len(words) > 2) or (len(words) > 2 and plain(words[-1]) in VALUES):
        words.pop()
    if len(words) < 2:
        return None
    for k, rest in ((-1, words[:-1]), (0, words[1:])):
        if ROLE.get(plain(words[k]), "quality") != "quality":
            mark = "-" if "-" in part and "_" not in part and " " not in part else "_"
            return mark.join(rest), plain(words[k]), quality
    return None
