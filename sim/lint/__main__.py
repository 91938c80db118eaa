# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.lint`: see `lint`."""

from sim.lint.lint import main

raise SystemExit(main())
