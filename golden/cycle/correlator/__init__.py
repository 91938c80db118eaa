# SPDX-License-Identifier: Apache-2.0
"""Cycle models from the job queue to the steps of the array: grid, check, plan, fetch, sequencer."""
