// SPDX-License-Identifier: Apache-2.0
// Queues jobs, feeds them to the board and collects results, on any bus that reads and writes the board's registers. Register
// addresses and fields are defined in the generated header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "job.hpp"
#include "slog_csr.h"

#define ADDRESS(reg) static_cast<uint32_t>(offsetof(slog_csr_t, reg))
#define PACK(field, value) ((static_cast<uint32_t>(value) << field##_bp) & field##_bm)
#define UNPACK(field, word) (((word) & field##_bm) >> field##_bp)

// Access to the registers. Only read and write are needed; the other functions save time where they are known.
class Bus {
 public:
  virtual ~Bus() = default;
  virtual uint32_t read(uint32_t address) = 0;
  virtual void write(uint32_t address, uint32_t data) = 0;
  // Whether an access has failed: the driver then stops waiting.
  virtual bool failed() const { return false; }
  // False when certainly no result is waiting (the board's interrupt output, with its result enabled).
  virtual bool result_waiting() const { return true; }
  // Called when there is nothing to do: lets some time pass.
  virtual void idle() {}
  // The time that timeouts are measured in: clocks of a simulated board, here the number of calls.
  virtual uint64_t now() { return ++calls_; }

 private:
  uint64_t calls_ = 0;
};

// Waiting functions return false when nothing moved for the timeout. While they wait they keep the job queue fed and collect
// results, so that captures and correlations overlap.
class Driver {
 public:
  explicit Driver(Bus& bus) : bus_(bus) {}

  Bus& bus() { return bus_; }

  // Clears the host-side queues and sets up the registers: for a board that was just reset.
  void start() {
    jobs_.clear();
    results_.clear();
    on_board_ = 0;
    job_depth_ = UNPACK(SLOG_CSR__BUILD_QUEUE__JOB_DEPTH, bus_.read(ADDRESS(build_queue)));
    take_over();
  }

  // To be called after anybody else has written registers: forgets what they hold, and enables the interrupt that tells of
  // results.
  void take_over() {
    written_.assign(sizeof(slog_csr_t) / 4, kUnknown);
    bus_.write(ADDRESS(irq_enable), SLOG_CSR__IRQ_ENABLE__RESULT_bm);
  }

  // Sets the kernels (`count` coefficients each, centre first) and the image size; waits until they are in use.
  bool set_filter(const int32_t* g, const int32_t* g2, int count, int width, int height, uint64_t timeout) {
    for (int second = 0; second < 2; ++second) {
      for (int k = 0; k < count; ++k) {
        bus_.write(ADDRESS(coef), PACK(SLOG_CSR__COEF__VALUE, (second ? g2 : g)[k]) |
                                      PACK(SLOG_CSR__COEF__SECOND, second) | PACK(SLOG_CSR__COEF__INDEX, k) |
                                      SLOG_CSR__COEF__GO_bm);
      }
    }
    bus_.write(ADDRESS(image_size),
               PACK(SLOG_CSR__IMAGE_SIZE__WIDTH, width) | PACK(SLOG_CSR__IMAGE_SIZE__HEIGHT, height));
    bus_.write(ADDRESS(filter), SLOG_CSR__FILTER__GO_bm);
    return wait_filter(timeout);
  }

  // Waits until the last filter change is in use.
  bool wait_filter(uint64_t timeout) {
    const uint64_t start = bus_.now();
    while (bus_.read(ADDRESS(filter)) & SLOG_CSR__FILTER__BUSY_bm) {
      if (late(start, timeout)) return false;
    }
    return true;
  }

  // Drops the frames that the board is receiving; returns the cameras, as a mask, that had a frame in progress.
  uint32_t abort_frames() {
    const uint32_t cameras = UNPACK(SLOG_CSR__FILTER__ACTIVE, bus_.read(ADDRESS(filter)));
    bus_.write(ADDRESS(filter), PACK(SLOG_CSR__FILTER__ABORT_0, cameras) | PACK(SLOG_CSR__FILTER__ABORT_1, cameras >> 1));
    return cameras;
  }

  // Requests a camera's next frame for a slot; false if the board refuses.
  bool arm(int camera, int slot) {
    bus_.write(ADDRESS(capture), PACK(SLOG_CSR__CAPTURE__SLOT, slot) | PACK(SLOG_CSR__CAPTURE__CAMERA, camera) |
                                     SLOG_CSR__CAPTURE__GO_bm);
    return !(bus_.read(ADDRESS(slot_status)) & SLOG_CSR__SLOT_STATUS__REFUSED_bm);
  }

  void disarm(int camera) {
    bus_.write(ADDRESS(capture), PACK(SLOG_CSR__CAPTURE__CAMERA, camera) | SLOG_CSR__CAPTURE__CANCEL_bm |
                                     SLOG_CSR__CAPTURE__GO_bm);
  }

  // Waits until no camera of the mask is armed.
  bool wait_captured(uint32_t cameras, uint64_t timeout) {
    const uint64_t start = bus_.now();
    while (UNPACK(SLOG_CSR__SLOT_STATUS__ARMED, bus_.read(ADDRESS(slot_status))) & cameras) {
      if (late(start, timeout)) return false;
      if (working()) {
        pump();
      } else {
        bus_.idle();
      }
    }
    return true;
  }

  // Queues jobs; those that the board has no room for wait here.
  void submit(const SlogJob* jobs, int64_t count) {
    jobs_.insert(jobs_.end(), jobs, jobs + count);
    feed();
  }

  // Waits for the next `count` results; the timeout is for each.
  bool collect(SlogResult* results, int64_t count, uint64_t timeout) {
    uint64_t moved = bus_.now();
    while (static_cast<int64_t>(results_.size()) < count) {
      if (pump()) moved = bus_.now();
      if (late(moved, timeout)) return false;
    }
    for (int64_t k = 0; k < count; ++k) {
      results[k] = results_.front();
      results_.pop_front();
    }
    return true;
  }

  // Results of submitted jobs that were not collected.
  int64_t outstanding() const {
    int64_t count = on_board_ + static_cast<int64_t>(results_.size());
    for (const SlogJob& job : jobs_) count += job.count();
    return count;
  }

  // Whether jobs wait or results are expected: then `pump` has something to do.
  bool working() const { return !jobs_.empty() || on_board_; }

  // Moves jobs to the board and results from it; when none moved, lets time pass and returns false.
  bool pump() {
    const bool fed = feed();
    const bool drained = drain();
    if (fed || drained) return true;
    bus_.idle();
    return false;
  }

  // Reads `count` 32-bit pieces of the store from a word address on.
  void peek(uint32_t word, uint32_t* data, int64_t count) {
    bus_.write(ADDRESS(peek_address), PACK(SLOG_CSR__PEEK_ADDRESS__WORD, word) | SLOG_CSR__PEEK_ADDRESS__GO_bm);
    for (int64_t k = 0; k < count; ++k) data[k] = bus_.read(ADDRESS(peek_data));
  }

  // Reads the counters in the order of their addresses; returns how many there are.
  int64_t counters(uint32_t* values) {
    constexpr uint32_t count = sizeof(slog_csr__counter_t) / 4;
    for (uint32_t k = 0; k < count; ++k) values[k] = bus_.read(ADDRESS(counter) + 4 * k);
    return count;
  }

 private:
  static constexpr int64_t kUnknown = -1;

  bool late(uint64_t since, uint64_t timeout) { return bus_.failed() || bus_.now() - since > timeout; }

  // Writes a job register unless it holds the value already.
  void write_changed(uint32_t address, uint32_t data) {
    int64_t& written = written_[address / 4];
    if (written == data) return;
    bus_.write(address, data);
    written = data;
  }

  void write_job(const SlogJob& job) {
    write_changed(ADDRESS(job.tpl), PACK(SLOG_CSR__JOB__TPL__SLOT, job.tpl_slot) |
                                        PACK(SLOG_CSR__JOB__TPL__X, job.tpl_x) |
                                        PACK(SLOG_CSR__JOB__TPL__Y, job.tpl_y));
    write_changed(ADDRESS(job.window), PACK(SLOG_CSR__JOB__WINDOW__WIDTH, job.width) |
                                           PACK(SLOG_CSR__JOB__WINDOW__HEIGHT, job.height));
    write_changed(ADDRESS(job.search), PACK(SLOG_CSR__JOB__SEARCH__SLOT, job.search_slot) |
                                           PACK(SLOG_CSR__JOB__SEARCH__X, job.search_x) |
                                           PACK(SLOG_CSR__JOB__SEARCH__Y, job.search_y));
    write_changed(ADDRESS(job.offsets), PACK(SLOG_CSR__JOB__OFFSETS__ACROSS, job.offsets_x) |
                                            PACK(SLOG_CSR__JOB__OFFSETS__DOWN, job.offsets_y));
    write_changed(ADDRESS(job.grid), PACK(SLOG_CSR__JOB__GRID__ACROSS, job.grid_across) |
                                         PACK(SLOG_CSR__JOB__GRID__DOWN, job.grid_down));
    write_changed(ADDRESS(job.step), PACK(SLOG_CSR__JOB__STEP__X, job.step_x) |
                                         PACK(SLOG_CSR__JOB__STEP__Y, job.step_y));
    bus_.write(ADDRESS(job.submit), PACK(SLOG_CSR__JOB__SUBMIT__TAG, job.tag) |
                                        PACK(SLOG_CSR__JOB__SUBMIT__SURFACE, job.surface) |
                                        SLOG_CSR__JOB__SUBMIT__GO_bm);
    on_board_ += job.count();
  }

  // Moves waiting jobs to the board while it has room; true if any moved.
  bool feed() {
    if (jobs_.empty()) return false;
    const uint32_t status = bus_.read(ADDRESS(job.status));
    if (!UNPACK(SLOG_CSR__JOB__STATUS__READY, status)) return false;
    uint32_t room = job_depth_ - UNPACK(SLOG_CSR__JOB__STATUS__WAITING, status);
    bool fed = false;
    while (room && !jobs_.empty()) {
      const SlogJob job = jobs_.front();
      jobs_.pop_front();
      write_job(job);
      fed = true;
      if (job.count() > 1) break;  // a grid may fill the queue: the status must be read again
      --room;
    }
    return fed;
  }

  // Takes the results that are waiting; true if there were any.
  bool drain() {
    if (!bus_.result_waiting()) return false;
    bool drained = false;
    for (;;) {
      const uint32_t head = bus_.read(ADDRESS(result.head));
      if (!UNPACK(SLOG_CSR__RESULT__HEAD__VALID, head) || bus_.failed()) return drained;
      results_.push_back(read_result(head));
      bus_.write(ADDRESS(result.pop), SLOG_CSR__RESULT__POP__GO_bm);
      --on_board_;
      drained = true;
    }
  }

  SlogResult read_result(uint32_t head) {
    SlogResult result{};
    const uint32_t best = bus_.read(ADDRESS(result.best));
    const uint32_t scores = bus_.read(ADDRESS(result.scores));
    result.tag = UNPACK(SLOG_CSR__RESULT__HEAD__TAG, head);
    result.status = UNPACK(SLOG_CSR__RESULT__HEAD__STATUS, head);
    result.best_x = UNPACK(SLOG_CSR__RESULT__BEST__X, best);
    result.best_y = UNPACK(SLOG_CSR__RESULT__BEST__Y, best);
    result.score = UNPACK(SLOG_CSR__RESULT__SCORES__SCORE, scores);
    for (int k = 0; k < 4; ++k) {
      const uint32_t pair = bus_.read(ADDRESS(result.neighbour) + 4 * k);
      result.neighbours[2 * k] = UNPACK(SLOG_CSR__RESULT__NEIGHBOUR__EVEN, pair);
      result.neighbours[2 * k + 1] = UNPACK(SLOG_CSR__RESULT__NEIGHBOUR__ODD, pair);
    }
    result.runner_up = UNPACK(SLOG_CSR__RESULT__SCORES__RUNNER_UP, scores);
    return result;
  }

  Bus& bus_;
  std::deque<SlogJob> jobs_;         // not yet on the board
  std::deque<SlogResult> results_;   // not yet collected
  std::vector<int64_t> written_;     // last value written to each register, or kUnknown
  int64_t on_board_ = 0;             // results expected from jobs on the board
  uint32_t job_depth_ = 0;           // jobs that the board's queue holds
};
