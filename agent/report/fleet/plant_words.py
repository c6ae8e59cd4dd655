"""What a plant says as a whole, in words and as JSON: all keys always there."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.plant.plant import PlantFinding, PlantGroup

CLUES = {
    "drives": "its past says more of the future of the others than theirs of its own",
    "harmonics": "its wave is less like a sine than those of the others",
}
CLEAR = 0.3
"""Value of a clue from which it is given as a reason."""


def plant_lines(finding: PlantFinding) -> Iterator[str]:
    """Yield each group with its root, the reasons and the path."""
    compared = len(finding.compared)
    if not finding.groups:
        yield f"plant: no two of {compared} loops oscillate together"
        return
    yield f"plant: of {compared} loops these oscillate together:"
    for number, group in enumerate(finding.groups, 1):
        first = group.suspects[0]
        yield f"{number}  period {group.period:.4g} s, {len(group.suspects)} loops"
        yield f"   likeliest root: {first.loop}, probability {first.probability:.2f}"
        for reason in reasons(group):
            yield f"   - {reason}"
        others = ", ".join(f"{each.loop} {each.probability:.2f}" for each in group.suspects[1:4])
        yield f"   then: {others}"
        yield f"   path: {', '.join(f'{one} to {other}' for one, other in group.path)}"


def reasons(group: PlantGroup) -> list[str]:
    """Return what speaks for the root, in words."""
    clues = group.suspects[0].clues
    found = [words for name, words in CLUES.items() if clues.get(name, 0.0) >= CLEAR]
    return found or ["no clue is clear: the loops of the group are alike"]


def plant_json(finding: PlantFinding) -> dict[str, object]:
    """Return the same as JSON."""
    return {
        "compared": list(finding.compared),
        "seconds": finding.seconds,
        "groups": [
            {
                "period_s": group.period,
                "root": group.root,
                "reasons": reasons(group),
                "loops": [
                    {
                        "loop": each.loop,
                        "probability": each.probability,
                        "period_s": each.wave.period,
                        "share": each.wave.share,
                    }
                    for each in group.suspects
                ],
                "path": [list(pair) for pair in group.path],
            }
            for group in finding.groups
        ],
    }
