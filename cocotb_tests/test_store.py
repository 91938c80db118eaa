"""`slog_store` against its cycle model on every clock: three banks, two slices."""

from sim.testbench.runner import simulate


def test_store() -> None:
    simulate("slog_store", ["rtl/slog_store_pkg.sv", "rtl/slog_ram.sv", "rtl/slog_store_slice.sv",
                            "rtl/slog_store.sv"], "cocotb_tests.store.test_store",
             {"Width": 8, "Words": 1296, "BankWords": 512, "SliceW": 4})
