// SPDX-License-Identifier: Apache-2.0
// The Verilated board behind a C interface: whole frames and job lists per call, clocks counted, no callbacks. The functions
// of the registers are those of `driver_api.cpp`, on the driver that `slog_driver` returns. Calls that wait keep the job queue
// fed and collect results. Negative return values are errors: see `Error`.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accesses.hpp"
#include "clock.hpp"
#include "driver.hpp"

namespace {

enum Error { kTimeout = -1, kStreamBroken = -2 };

struct Board {
  explicit Board(uint32_t power_up) : clock(power_up) {}

  Clock clock;
  Driver driver{clock};
};

}  // namespace

extern "C" {

Board* slog_new(uint32_t power_up) { return new Board(power_up); }
void slog_free(Board* b) { delete b; }
Driver* slog_driver(Board* b) { return &b->driver; }
uint64_t slog_clocks(const Board* b) { return b->clock.clocks(); }
int slog_irq(const Board* b) { return b->clock.result_waiting(); }
int slog_asserted(const Board* b) { return b->clock.asserted(); }
int slog_trace(Board* b, const char* path) { return b->clock.trace(path); }

void slog_tick(Board* b, uint64_t clocks) {
  for (uint64_t k = 0; k < clocks; ++k) b->clock.tick();
}

// Resets the board and clears the host-side queues.
void slog_reset(Board* b) {
  b->clock.reset();
  b->driver.start();
}

// The same after a reset of `clocks` clocks, but the cameras go on sending what was queued for them.
void slog_restart(Board* b, int clocks) {
  b->clock.restart(clocks);
  b->driver.start();
}

// Queues beats (grey | user << 8 | last << 9) on a camera; they play while other calls run the clock.
void slog_play(Board* b, int camera, const uint16_t* beats, uint64_t count, uint32_t pause_permille, uint64_t seed) {
  Camera& c = b->clock.cameras[camera];
  c.beats.erase(c.beats.begin(), c.beats.begin() + static_cast<ptrdiff_t>(c.at));
  c.at = 0;
  c.beats.insert(c.beats.end(), beats, beats + count);
  c.pause.set(pause_permille, seed);
}

// Queues one whole frame of 8-bit grey.
void slog_play_frame(Board* b, int camera, const uint8_t* grey, int width, int height, uint32_t pause_permille,
                     uint64_t seed) {
  std::vector<uint16_t> beats(static_cast<size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t k = static_cast<size_t>(y) * width + x;
      beats[k] = grey[k] | (k == 0) << 8 | (x == width - 1) << 9;
    }
  }
  slog_play(b, camera, beats.data(), beats.size(), pause_permille, seed);
}

// Runs until every camera's beats are taken.
int slog_finish_playing(Board* b, uint64_t timeout) {
  Clock& clock = b->clock;
  const uint64_t start = clock.clocks();
  while (clock.playing()) {
    if (clock.clocks() - start > timeout) return kTimeout;
    if (b->driver.working()) {
      b->driver.pump();
    } else {
      for (int k = 0; k < Clock::kIdle && clock.playing(); ++k) clock.tick();
    }
  }
  return 0;
}

// Holds back the receiver of surfaces or maps in some of the clocks.
void slog_pause_stream(Board* b, uint32_t pause_permille, uint64_t seed) {
  b->clock.stream.pause.set(pause_permille, seed);
}

// Words of surfaces or maps that were received and not taken.
int64_t slog_stream_waiting(const Board* b) { return static_cast<int64_t>(b->clock.stream.words.size()); }

#if SLOG_DENSE
// Waits for the next whole map, until no word comes for the timeout; returns its number of words. More than `room` are an error.
int64_t slog_map(Board* b, uint64_t* words, int64_t room, uint64_t timeout) {
  Clock& clock = b->clock;
  Stream& stream = clock.stream;
  uint64_t moved = clock.clocks();
  for (size_t before = stream.words.size(); stream.ends.empty();) {
    for (int k = 0; k < Clock::kIdle && stream.ends.empty(); ++k) clock.tick();
    if (stream.words.size() != before) moved = clock.clocks();
    before = stream.words.size();
    if (clock.clocks() - moved > timeout) return kTimeout;
  }
  const auto count = static_cast<int64_t>(stream.ends.front());
  if (stream.broken || count > room) return kStreamBroken;
  stream.take(words, static_cast<size_t>(count));
  return count;
}
#else
// Waits for the next `count` scores of the surface stream.
int slog_surface(Board* b, uint16_t* scores, int64_t count, uint64_t timeout) {
  Clock& clock = b->clock;
  Stream& stream = clock.stream;
  uint64_t moved = clock.clocks();
  size_t before = stream.words.size();
  while (static_cast<int64_t>(stream.words.size()) < count) {
    if (b->driver.pump() || stream.words.size() != before) moved = clock.clocks();
    before = stream.words.size();
    if (clock.clocks() - moved > timeout) return kTimeout;
  }
  if (stream.broken) return kStreamBroken;
  stream.take(scores, static_cast<size_t>(count));
  return 0;
}
#endif

// Plays register accesses on the five channels, each in its own time (see accesses.hpp); returns how many rules of AXI4-Lite
// the board broke. The driver takes over again afterwards.
int64_t slog_accesses(Board* b, SlogAccess* accesses, int64_t count, int overlap) {
  const int64_t broken = AccessPlayer(b->clock, accesses, count, overlap).play();
  b->driver.take_over();
  return broken;
}

}  // extern "C"
