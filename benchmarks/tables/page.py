"""A page of the docs that has a part written by a benchmark, between two marks."""

from __future__ import annotations

from pathlib import Path

END = "<!-- end -->"


def put(text: str, page: Path, benchmark: str) -> None:
    """Put a text between the marks of the page, which keeps what stands around them."""
    begin = f"<!-- by python -m benchmarks {benchmark} -->\n"
    before, _, rest = page.read_text(encoding="utf-8").partition(begin)
    after = rest.partition(END)[2]
    page.write_text(f"{before}{begin}\n{text}\n{END}{after}", encoding="utf-8")
