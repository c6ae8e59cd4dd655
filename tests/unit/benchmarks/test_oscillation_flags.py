"""How the flagged OP records are counted, and what the docs claim of them."""

from pathlib import Path

from benchmarks.oscillation import agreement, counts, disputed, flagged

RESULTS = (Path(__file__).parents[3] / "docs" / "results.md").read_text(encoding="utf-8")


def test_the_docs_state_what_is_seen_today(recordings):
    records = flagged(recordings)
    hits, quiet, agree = counts(records, [each.seen.detected for each in records])
    assert f"| `detect_oscillation` | {hits} | {quiet} | {agree} |" in RESULTS
    assert disputed(records) in RESULTS
    rows = [line for line in agreement(records).splitlines() if line.startswith("| `")]
    assert [row for row in rows if row not in RESULTS] == []
