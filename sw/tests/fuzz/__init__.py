# SPDX-License-Identifier: Apache-2.0
"""Fuzzing of the commands: seeded mutations of every kind of input, each run in a child with limits."""
