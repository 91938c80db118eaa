# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the peak unit and its parts, from mismatches to results and surfaces."""
