"""Make random plans of every profile, and measure them; `make plans`.

Limits and ways go over many magnitudes. A row for each profile shows the worst of what was
measured, and with `number:` the number of its plan; `--first` and `--count 1` make it again.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from many_plans.campaign import ALLOWED, Outcome, run
from many_plans.cases import CASES

# Plans that a process makes before it reports.
CHUNK = 1000


def merged(outcomes: list[Outcome]) -> Outcome:
    """Put the outcomes of one profile together."""
    total = Outcome()
    for one in outcomes:
        total.plans += one.plans
        total.refused += one.refused
        total.faults += one.faults
        for name, (number, text) in one.reasons.items():
            total.reasons.setdefault(name, (number, text))
        for what, worst in one.worst.items():
            total.worst[what] = max(worst, total.worst.get(what, worst))
    return total


def row(profile: str, outcome: Outcome) -> str:
    """Write the row of a profile."""
    worst = [
        "" if what not in outcome.worst else "{:.1e} ({})".format(*outcome.worst[what])
        for what in ALLOWED
    ]
    return "| " + " | ".join([profile, str(outcome.plans), str(outcome.refused), *worst]) + " |"


def main() -> int:
    """Make the plans, print a row for each profile, and return 0 where nothing is wrong."""
    parser = argparse.ArgumentParser(prog="make plans", description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000, help="plans of each (1000000)")
    parser.add_argument("--seed", type=int, default=0, help="of the random numbers (0)")
    parser.add_argument("--first", type=int, default=0, help="number of the first plan (0)")
    parser.add_argument("--jobs", type=int, default=None, help="processes (as many as processors)")
    parser.add_argument("--profile", default="", help="one or more of " + ", ".join(CASES))
    arguments = parser.parse_args()
    chosen = arguments.profile.replace(",", " ").split() or list(CASES)
    unknown = [profile for profile in chosen if profile not in CASES]
    if unknown:
        parser.error(f"profile {unknown[0]!r}: one of {', '.join(CASES)} is expected")
    print("| " + " | ".join(["profile", "plans", "refused", *ALLOWED]) + " |")
    print("|---|" + "---|" * (2 + len(ALLOWED)))
    wrong = False
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for profile in chosen:
            began, end = time.monotonic(), arguments.first + arguments.count
            starts = range(arguments.first, end, CHUNK)
            counts = [min(CHUNK, end - start) for start in starts]
            several = len(starts)
            parts = pool.map(run, [profile] * several, counts, [arguments.seed] * several, starts)
            outcome = merged(list(parts))
            print(row(profile, outcome), flush=True)
            report(outcome, time.monotonic() - began)
            wrong = wrong or bool(outcome.faults)
    return 1 if wrong else 0


def report(outcome: Outcome, seconds: float) -> None:
    """Tell what does not fit into a row."""
    print(f"{seconds:.0f} s", file=sys.stderr)
    for name, (number, text) in outcome.reasons.items():
        print(f"refused: {name}, first plan {number}: {text[:200]}", file=sys.stderr)
    if outcome.faults:
        print(f"{len(outcome.faults)} faults", file=sys.stderr)
    for fault in outcome.faults[:10]:
        print(f"FAULT {fault[:300]}", file=sys.stderr)


if __name__ == "__main__":
    raise SystemExit(main())
