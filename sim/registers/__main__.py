# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.registers`: see `generate`."""

import sys

from sim.registers.generate import main

raise SystemExit(main(sys.argv[1:]))
