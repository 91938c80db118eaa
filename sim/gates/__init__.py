# SPDX-License-Identifier: Apache-2.0
"""The netlists that synthesis makes of the modules, under the modules' own tests: `SIGNUM_GATES=1`."""
