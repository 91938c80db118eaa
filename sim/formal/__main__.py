"""`python -m sim.formal`: see `flow`."""

from sim.formal.flow import main

raise SystemExit(main())
