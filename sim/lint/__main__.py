"""`python -m sim.lint`: see `lint`."""

from sim.lint.lint import main

raise SystemExit(main())
