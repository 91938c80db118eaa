# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.formal`: see `flow`."""

from sim.formal.flow import main

raise SystemExit(main())
