# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.board`: see `build`."""

from sim.board.build import main

raise SystemExit(main())
