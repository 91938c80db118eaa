# SPDX-License-Identifier: Apache-2.0
"""`make soak MINUTES=60`: the Verilated board against the frame level, new seeds and power-up states in every case."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from golden.params import CONFIGS
from sim.board.build import BuildError, build
from tests.soak.campaign import PARTS, Campaign, play
from tests.soak.case import Case
from tests.soak.shrink import words


def main(arguments: list[str] | None = None) -> int:
    """Run a soak, or replay a kept case; 1 if the board differs."""
    parser = argparse.ArgumentParser(prog="make soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--cases", type=int, help="so many cases instead")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--parts", default=",".join(PARTS), help=f"of {', '.join(PARTS)}")
    parser.add_argument("--config", choices=sorted(CONFIGS), help="this configuration only")
    parser.add_argument("--out", type=Path, default=Path("out/soak"))
    parser.add_argument("--replay", type=Path, help="a kept case")
    given = parser.parse_args(arguments)
    parts = tuple(given.parts.split(","))
    if unknown := [part for part in parts if part not in PARTS]:
        parser.error(f"no part {', '.join(unknown)}: parts are {', '.join(PARTS)}")
    try:
        if given.replay:
            return _replay(given.replay)
        print(f"seed {given.seed}; building the boards", flush=True)
        for config in (given.config,) if given.config else sorted({c for p in parts for c in PARTS[p].configs}):
            build(config, checked=True)
    except (BuildError, OSError, ValueError) as error:
        print(f"soak: {error}", file=sys.stderr)
        return 2
    campaign = Campaign(given.seed, given.out, given.jobs, parts, given.config)
    kept = campaign.run(given.cases, None if given.cases else 60 * given.minutes)
    for part, counts in sorted(campaign.met.items()):
        print(f"{part}: " + ", ".join(f"{what} {count}" for what, count in sorted(counts.items())))
    print(campaign.progress())
    return 1 if kept else 0


def _replay(file: Path) -> int:
    case = Case.read(file)
    print("\n".join(words(case)))
    _, difference = play(case)
    print(difference or "no difference")
    return 1 if difference else 0


if __name__ == "__main__":
    sys.exit(main())
