// SPDX-License-Identifier: Apache-2.0
// The driver behind a C interface, on any bus. Functions that wait return 0, or kTimeout.

#include <cstdint>

#include "driver.hpp"

enum Error { kTimeout = -1 };

extern "C" {

uint32_t slog_read(Driver* d, uint32_t address) { return d->bus().read(address); }
void slog_write(Driver* d, uint32_t address, uint32_t data) { d->bus().write(address, data); }
int slog_failed(Driver* d) { return d->bus().failed(); }
void slog_start(Driver* d) { d->start(); }

int slog_set_filter(Driver* d, const int32_t* g, const int32_t* g2, int count, int width, int height, uint64_t timeout) {
  return d->set_filter(g, g2, count, width, height, timeout) ? 0 : kTimeout;
}

int slog_wait_filter(Driver* d, uint64_t timeout) { return d->wait_filter(timeout) ? 0 : kTimeout; }
uint32_t slog_abort_frames(Driver* d) { return d->abort_frames(); }

int slog_arm(Driver* d, int camera, int slot) { return d->arm(camera, slot); }
void slog_disarm(Driver* d, int camera) { d->disarm(camera); }
int slog_wait_captured(Driver* d, uint32_t cameras, uint64_t timeout) {
  return d->wait_captured(cameras, timeout) ? 0 : kTimeout;
}

void slog_submit(Driver* d, const SlogJob* jobs, int64_t count) { d->submit(jobs, count); }
int slog_collect(Driver* d, SlogResult* results, int64_t count, uint64_t timeout) {
  return d->collect(results, count, timeout) ? 0 : kTimeout;
}
int64_t slog_outstanding(Driver* d) { return d->outstanding(); }

void slog_peek(Driver* d, uint32_t word, uint32_t* data, int64_t count) { d->peek(word, data, count); }
int64_t slog_counters(Driver* d, uint32_t* values) { return d->counters(values); }

}  // extern "C"
