# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.mutate`: see `flow`."""

from sim.mutate.flow import main

raise SystemExit(main())
