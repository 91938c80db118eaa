"""`python -m sim.speed`: see `bench`."""

from sim.speed.bench import main

raise SystemExit(main())
