# SPDX-License-Identifier: Apache-2.0
"""`make soak`: long runs of the Verilated board against the frame level, with new seeds and power-up states."""
