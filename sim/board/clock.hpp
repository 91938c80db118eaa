// SPDX-License-Identifier: Apache-2.0
// The Verilated model under its clock: plays the cameras' video, receives the stream of surfaces or, with SLOG_DENSE, of the
// dense engine's maps, and is a bus to the registers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "Vslog_board.h"
#include "driver.hpp"
#include "verilated.h"
#if VM_TRACE_FST
#include "verilated_fst_c.h"
using Trace = VerilatedFstC;
#elif VM_TRACE
#include "verilated_vcd_c.h"
using Trace = VerilatedVcdC;
#endif

// A reproducible random stream: true with a probability in thousandths.
class Coin {
 public:
  void set(uint32_t permille, uint64_t seed) {
    threshold_ = static_cast<uint32_t>(permille * 4294967ull);
    state_ = seed * 0x9E3779B97F4A7C15ull + 0x632BE59BD9B4E019ull;
  }
  bool toss() {
    if (!threshold_) return false;
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<uint32_t>(state_ >> 32) < threshold_;
  }

 private:
  uint64_t state_ = 0x9E3779B97F4A7C15ull;
  uint32_t threshold_ = 0;
};

struct Camera {
  std::vector<uint16_t> beats;  // grey | user << 8 | last << 9
  size_t at = 0;
  bool offered = false;  // an offered beat stays offered until it is taken
  Coin pause;

  bool busy() const { return at < beats.size(); }
};

#if SLOG_DENSE
using Word = uint64_t;  // a pixel of a map
#else
using Word = uint16_t;  // a score of a surface
#endif

// What the board streams out: surfaces or maps, one after another.
struct Stream {
  std::vector<Word> words;
  std::deque<size_t> ends;  // of the surfaces and maps that are there whole: the number of words up to their last
  Coin pause;
  bool first = true;    // the next word is the first of a surface or map
  bool broken = false;  // a mark of a first word was missing or wrong

  void receive(Word word, bool user, bool last) {
    if (user != first) broken = true;
    first = last;
    words.push_back(word);
    if (last) ends.push_back(words.size());
  }
  // Hands over the first `count` words.
  void take(Word* into, size_t count) {
    std::copy(words.begin(), words.begin() + static_cast<ptrdiff_t>(count), into);
    words.erase(words.begin(), words.begin() + static_cast<ptrdiff_t>(count));
    while (!ends.empty() && ends.front() <= count) ends.pop_front();
    for (size_t& end : ends) end -= count;
  }
  void forget() {
    words.clear();
    ends.clear();
    first = true;
    broken = false;
  }
};

class Clock final : public Bus {
 public:
  static constexpr int kCameras = 2;
  static constexpr int kIdle = 64;           // clocks between looks at the board when there is nothing to do
  static constexpr int kResetEnd = 8;        // clocks from the end of rst_i until the board takes a register access
  static constexpr int kBusLimit = 1 << 20;  // clocks a register access may take

  Camera cameras[kCameras];
  Stream stream;

  // With a power-up seed other than 0, registers of a checked build start with random values; other builds ignore it.
  explicit Clock([[maybe_unused]] uint32_t power_up) {
#if SLOG_CHECKED
    context_.randReset(power_up ? 2 : 0);
    context_.randSeed(static_cast<int>(power_up));
    context_.fatalOnError(false);
    context_.assertOn(true);
#endif
    top_ = std::make_unique<Vslog_board>(&context_);
    Vslog_board& t = *top_;
    t.clk_i = t.vid_tvalid_i = t.s_axil_awvalid = t.s_axil_wvalid = t.s_axil_arvalid = 0;
    t.rst_i = 1;
  }

  // Whether an assertion of the RTL failed; its message is on the standard output.
  bool asserted() const { return context_.gotError(); }
  Vslog_board& pins() { return *top_; }

  ~Clock() override {
#if VM_TRACE
    if (trace_) trace_->close();
#endif
    top_->final();
  }

  // Starts a wave dump; false when this build has none.
  bool trace(const char* path) {
#if VM_TRACE
    context_.traceEverOn(true);
    trace_ = std::make_unique<Trace>();
    top_->trace(trace_.get(), 99);
    trace_->open(path);
    return true;
#else
    (void)path;
    return false;
#endif
  }

  // Resets the board; beats that were queued and words that were received are forgotten.
  void reset() {
    for (Camera& camera : cameras) {
      camera.beats.clear();
      camera.at = 0;
      camera.offered = false;
    }
    restart(4);
  }

  // Resets the board for some clocks while the cameras go on sending; words that were received are forgotten.
  void restart(int clocks) {
    Vslog_board& t = *top_;
    t.s_axil_awvalid = t.s_axil_wvalid = t.s_axil_arvalid = t.s_axil_bready = t.s_axil_rready = 0;
    t.rst_i = 1;
    for (int k = 0; k < clocks; ++k) tick();
    t.rst_i = 0;
    for (int k = 0; k < kResetEnd; ++k) tick();
    stream.forget();
    stuck_ = false;
  }

  bool playing() const {
    return std::any_of(cameras, cameras + kCameras, [](const Camera& camera) { return camera.busy(); });
  }

  uint64_t now() override { return clocks_; }
  uint64_t clocks() const { return clocks_; }
  bool failed() const override { return stuck_; }
  bool result_waiting() const override { return top_->irq_o; }
  void idle() override {
    for (int k = 0; k < kIdle && !top_->irq_o; ++k) tick();
  }

  // One register access at a time, as the board takes them: 10 clocks a write, 12 a read when the register answers at once.
  void write(uint32_t address, uint32_t data) override {
    Vslog_board& t = *top_;
    t.s_axil_awaddr = address;
    t.s_axil_wdata = data;
    t.s_axil_wstrb = 0xF;
    t.s_axil_awvalid = t.s_axil_wvalid = 1;
    t.s_axil_bready = 1;
    // With no access under way both channels are taken at once.
    tick();
    t.s_axil_awvalid = t.s_axil_wvalid = 0;
    for (int k = 0; !t.s_axil_bvalid && !stuck_; ++k) {
      tick();
      stuck_ = k == kBusLimit;
    }
    tick();
    t.s_axil_bready = 0;
  }

  uint32_t read(uint32_t address) override {
    Vslog_board& t = *top_;
    t.s_axil_araddr = address;
    t.s_axil_arvalid = 1;
    t.s_axil_rready = 1;
    tick();
    t.s_axil_arvalid = 0;
    for (int k = 0; !t.s_axil_rvalid && !stuck_; ++k) {
      tick();
      stuck_ = k == kBusLimit;
    }
    const uint32_t data = t.s_axil_rdata;
    tick();
    t.s_axil_rready = 0;
    return data;
  }

  void tick() { edge(settle()); }

  // The first half of a clock: outputs answer the inputs. Returns the cameras that offer a beat, for `edge`.
  uint32_t settle() {
    Vslog_board& t = *top_;
    const uint32_t valid = drive_cameras();
    ready_ = !stream.pause.toss();
#if SLOG_DENSE
    t.map_tready_i = ready_;
#else
    t.surf_tready_i = ready_;
#endif
    t.clk_i = 0;
#if SLOG_CHECKED
    Verilated::threadContextp(&context_);
    context_.timeInc(kHalf);
#endif
    t.eval();
    dump(0);
    return valid;
  }

  // The second half: what was handed over, then the rising edge.
  void edge(uint32_t valid) {
    Vslog_board& t = *top_;
    for (int c = 0; c < kCameras; ++c) {
      if (valid & t.vid_tready_o & 1u << c) {
        ++cameras[c].at;
        cameras[c].offered = false;
      }
    }
    // Outputs are arbitrary during a reset.
#if SLOG_DENSE
    if (!t.rst_i && t.map_tvalid_o && ready_) stream.receive(t.map_tdata_o, t.map_tuser_o, t.map_tlast_o);
#else
    if (!t.rst_i && t.surf_tvalid_o && ready_) stream.receive(t.surf_tdata_o, t.surf_tuser_o, t.surf_tlast_o);
#endif
    t.clk_i = 1;
#if SLOG_CHECKED
    context_.timeInc(kHalf);
#endif
    t.eval();
    dump(1);
    ++clocks_;
  }

 private:
#if SLOG_CHECKED
  static constexpr uint64_t kHalf = 5;  // half a clock in the model's time: some assertions wait until 200, which is 20 clocks
#endif

  // Drives the video inputs; returns the cameras that offer a beat, as a mask.
  uint32_t drive_cameras() {
    uint32_t data = 0, valid = 0, user = 0, last = 0;
    for (int c = 0; c < kCameras; ++c) {
      Camera& camera = cameras[c];
      if (!camera.busy()) continue;
      camera.offered = camera.offered || !camera.pause.toss();
      if (!camera.offered) continue;
      const uint32_t beat = camera.beats[camera.at];
      data |= (beat & 0xFF) << 8 * c;
      user |= (beat >> 8 & 1) << c;
      last |= (beat >> 9 & 1) << c;
      valid |= 1u << c;
    }
    top_->vid_tdata_i = data;
    top_->vid_tvalid_i = valid;
    top_->vid_tuser_i = user;
    top_->vid_tlast_i = last;
    return valid;
  }

  void dump([[maybe_unused]] uint64_t half) {
#if VM_TRACE
    if (trace_) trace_->dump(2 * clocks_ + half);
#endif
  }

  VerilatedContext context_;
  std::unique_ptr<Vslog_board> top_;
#if VM_TRACE
  std::unique_ptr<Trace> trace_;
#endif
  uint64_t clocks_ = 0;
  bool ready_ = true;   // the stream's receiver is ready in this clock
  bool stuck_ = false;  // a register access was never answered
};
