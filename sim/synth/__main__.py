"""`python -m sim.synth`: see `flow`."""

from sim.synth.flow import main

raise SystemExit(main())
