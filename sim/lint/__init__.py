# SPDX-License-Identifier: Apache-2.0
"""Lint of the RTL, with the reason of each waiver."""
