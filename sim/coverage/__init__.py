# SPDX-License-Identifier: Apache-2.0
"""Coverage of the RTL by the regression: recorded by each run, merged, held to its bars and shown on one page."""
