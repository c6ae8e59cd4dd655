"""`python -m benchmarks [--full] [NAME...]`: run the benchmarks and print their tables."""

from __future__ import annotations

import argparse
import os
import platform

from benchmarks import real_recordings, simulated, speed

BENCHMARKS = {"real_recordings": real_recordings.run, "simulated": simulated.run, "speed": speed.run}


def main() -> None:
    """Run all benchmarks, or those that are named."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS))
    parser.add_argument("--full", action="store_true", help="60 simulated loops of each kind, not 20")
    options = parser.parse_args()
    unknown = set(options.names) - set(BENCHMARKS)
    if unknown:
        parser.error(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(BENCHMARKS)}")
    print(
        f"{platform.platform()}, {len(os.sched_getaffinity(0))} cores, Python {platform.python_version()}\n"
    )
    for name in options.names or BENCHMARKS:
        BENCHMARKS[name](full=options.full)


if __name__ == "__main__":
    main()
