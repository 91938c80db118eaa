# SPDX-License-Identifier: Apache-2.0
"""`make fuzz MINUTES=10`: a campaign with a new seed."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from tests.fuzz.campaign import Campaign
from tests.fuzz.corpus import KINDS


def main() -> int:
    """Run a campaign; 1 if there was a failure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--cases", type=int, help="so many cases instead")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    given = parser.parse_args()
    print(f"seed {given.seed}", flush=True)
    campaign = Campaign(given.out, given.seed, given.jobs, tuple(given.kinds.split(",")))
    started = time.monotonic()
    campaign.run(given.cases, None if given.cases else 60 * given.minutes)
    print(campaign.summary())
    print(f"{sum(sum(c.values()) for c in campaign.outcomes.values())} cases in "
          f"{time.monotonic() - started:.0f} s, slowest {max(campaign.seconds)[0]:.1f} s ({max(campaign.seconds)[1]})")
    return 1 if campaign.failures else 0


if __name__ == "__main__":
    sys.exit(main())
