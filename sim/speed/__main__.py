# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.speed`: see `bench`."""

from sim.speed.bench import main

raise SystemExit(main())
