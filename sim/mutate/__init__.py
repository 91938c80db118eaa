# SPDX-License-Identifier: Apache-2.0
"""Mutation testing: small faults put into the RTL and the golden model, which their tests must find."""
