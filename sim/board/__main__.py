"""`python -m sim.board`: see `build`."""

from sim.board.build import main

raise SystemExit(main())
