# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.registers`: see `generate`."""

import sys

try:
    from sim.registers.generate import main
except ModuleNotFoundError as error:
    raise SystemExit(f"{error.name} is not installed: it comes with the extra `dev`: pip install 'signum[dev]' "
                     "(in a clone: make setup)") from error

raise SystemExit(main(sys.argv[1:]))
