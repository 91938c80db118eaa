# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.synth`: see `flow`."""

from sim.synth.flow import main

raise SystemExit(main())
