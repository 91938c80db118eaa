// SPDX-License-Identifier: Apache-2.0
// For a simulator of which one process serves many mutants, each in a copy of itself.
#include "verilated.h"

namespace {
// A copy of a process has no other threads: the simulator must not make any.
struct OneThread {
  OneThread() { Verilated::threadContextp()->threads(1); }
} one_thread;
}  // namespace

// Adds a plusarg after the simulator has been started.
extern "C" void slog_add_plusarg(const char *text) {
  const char *arguments[] = {text};
  Verilated::commandArgsAdd(1, arguments);
}
