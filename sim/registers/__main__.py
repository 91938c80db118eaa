"""`python -m sim.registers`: see `generate`."""

import sys

from sim.registers.generate import main

raise SystemExit(main(sys.argv[1:]))
