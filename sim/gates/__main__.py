# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.gates`: see sim.gates.flow."""

from sim.gates.flow import main

raise SystemExit(main())
