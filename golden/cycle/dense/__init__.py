# SPDX-License-Identifier: Apache-2.0
"""The dense engine: running sums, memory of the row above, winners of both planes."""
