# SPDX-License-Identifier: Apache-2.0
"""The cocotb runner and the test benches in SystemVerilog that it builds."""
