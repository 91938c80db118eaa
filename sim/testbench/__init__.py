"""The cocotb runner and the test benches in SystemVerilog that it builds."""
