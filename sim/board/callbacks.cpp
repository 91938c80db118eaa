// SPDX-License-Identifier: Apache-2.0
// The driver on a pair of functions of the caller: registers reached over UART or Ethernet, or a log that is replayed.
// Both return 0, or anything else when the access failed; no access follows one that failed.

#include <cstdint>

#include "driver.hpp"

namespace {

using Read = int (*)(uint32_t address, uint32_t* data);
using Write = int (*)(uint32_t address, uint32_t data);

class Callbacks final : public Bus {
 public:
  Callbacks(Read read, Write write) : read_(read), write_(write) {}

  uint32_t read(uint32_t address) override {
    uint32_t data = 0;
    if (!failed_) failed_ = read_(address, &data) != 0;
    return failed_ ? 0 : data;
  }
  void write(uint32_t address, uint32_t data) override {
    if (!failed_) failed_ = write_(address, data) != 0;
  }
  bool failed() const override { return failed_; }

 private:
  Read read_;
  Write write_;
  bool failed_ = false;
};

struct CallbackDriver {
  Callbacks bus;
  Driver driver{bus};
};

}  // namespace

extern "C" {

CallbackDriver* slog_callbacks_new(Read read, Write write) { return new CallbackDriver{Callbacks(read, write)}; }
void slog_callbacks_free(CallbackDriver* c) { delete c; }
Driver* slog_driver(CallbackDriver* c) { return &c->driver; }

}  // extern "C"
