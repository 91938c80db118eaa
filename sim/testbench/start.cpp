// SPDX-License-Identifier: Apache-2.0
// Starts a simulator inside the Python executable.
//
// A cocotb simulator embeds Python, which needs a libpython shared library; many distributions (Debian for one) ship an
// interpreter that is linked statically and exports the same interface from its executable instead. So the simulator is built as a
// shared library and preloaded into `python`, and its main is called here instead of the interpreter's. Python is not running
// yet at that point: cocotb starts it, with the executable's symbols, as it would with the library's.
#include <dlfcn.h>
#include <stdlib.h>

int slog_simulator_main(int argc, char **argv);

using Main = int (*)(int, char **, char **);
using Start = int (*)(Main, int, char **, void (*)(), void (*)(), void (*)(), void *);

static int run(int argc, char **argv, char **) {
  unsetenv("LD_PRELOAD");
  return slog_simulator_main(argc, argv);
}

extern "C" int __libc_start_main(Main, int argc, char **argv, void (*init)(), void (*fini)(), void (*rtld_fini)(),
                                 void *stack_end) {
  const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(run, argc, argv, init, fini, rtld_fini, stack_end);
}
