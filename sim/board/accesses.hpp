// SPDX-License-Identifier: Apache-2.0
// Register accesses on the five channels of AXI4-Lite, each channel in its own time, while the bus's rules are checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "clock.hpp"

struct SlogAccess {
  uint32_t write, address, data, strobes;
  uint32_t wait_address, wait_data, wait_response;  // clocks from the access's start, or from its response, until valid or ready
  uint32_t value;                                   // of a read
  uint32_t answered;
};

class AccessPlayer {
 public:
  AccessPlayer(Clock& clock, SlogAccess* accesses, int64_t count, int overlap)
      : clock_(clock), next_(accesses), end_(accesses + count), overlap_(static_cast<size_t>(overlap)) {}

  // Plays all accesses; returns the number of rules broken, 1 or more if the board stops answering.
  int64_t play() {
    for (int quiet = 0; next_ != end_ || under_way(); ++quiet) {
      begin();
      drive();
      const uint32_t cameras = clock_.settle();
      if (observe()) quiet = 0;
      clock_.edge(cameras);
      if (quiet > kLongest) {
        ++broken_;
        break;
      }
    }
    quiet_pins();
    return broken_;
  }

 private:
  static constexpr int kLongest = 2000;  // clocks without a transfer: more than any wait

  struct Request {
    SlogAccess* access;
    uint32_t wait;
  };
  struct Response {
    std::deque<SlogAccess*> expected;
    size_t allowed = 0;  // requests taken whole and not answered
    uint32_t waited = 0;
    bool held = false;  // valid in the clock before, and not taken
    uint32_t value = 0;
  };

  size_t under_way() const { return b_.expected.size() + r_.expected.size(); }

  void begin() {
    while (next_ != end_ && under_way() < overlap_) {
      SlogAccess* a = next_++;
      a->answered = 0;
      if (a->write) {
        aw_.push_back({a, a->wait_address});
        w_.push_back({a, a->wait_data});
        b_.expected.push_back(a);
      } else {
        ar_.push_back({a, a->wait_address});
        r_.expected.push_back(a);
      }
    }
  }

  static bool offered(std::deque<Request>& queue) {
    if (queue.empty()) return false;
    if (!queue.front().wait) return true;
    --queue.front().wait;
    return false;
  }

  void drive() {
    Vslog_board& t = clock_.pins();
    // Idle wires carry garbage.
    t.s_axil_awvalid = offered(aw_);
    t.s_axil_awaddr = t.s_axil_awvalid ? aw_.front().access->address : ~t.s_axil_awaddr & 0xFF;
    t.s_axil_wvalid = offered(w_);
    t.s_axil_wdata = t.s_axil_wvalid ? w_.front().access->data : ~t.s_axil_wdata;
    t.s_axil_wstrb = t.s_axil_wvalid ? w_.front().access->strobes : 0xF;
    t.s_axil_arvalid = offered(ar_);
    t.s_axil_araddr = t.s_axil_arvalid ? ar_.front().access->address : ~t.s_axil_araddr & 0xFF;
    t.s_axil_bready = !b_.expected.empty() && b_.waited >= b_.expected.front()->wait_response;
    t.s_axil_rready = !r_.expected.empty() && r_.waited >= r_.expected.front()->wait_response;
  }

  // Takes what is handed over in this clock; true if anything is.
  bool observe() {
    const Vslog_board& t = clock_.pins();
    bool moved = answer(b_, t.s_axil_bvalid, t.s_axil_bready, t.s_axil_bresp, t.s_axil_bresp);
    moved |= answer(r_, t.s_axil_rvalid, t.s_axil_rready, t.s_axil_rdata, t.s_axil_rresp);
    if (t.s_axil_awvalid && t.s_axil_awready) aw_.pop_front(), ++addresses_, moved = true;
    if (t.s_axil_wvalid && t.s_axil_wready) w_.pop_front(), ++data_, moved = true;
    if (addresses_ && data_) --addresses_, --data_, ++b_.allowed;
    if (t.s_axil_arvalid && t.s_axil_arready) ar_.pop_front(), ++r_.allowed, moved = true;
    return moved;
  }

  // A response stays, unchanged, until it is taken; it answers a request that was taken whole in an earlier clock.
  bool answer(Response& response, bool valid, bool ready, uint32_t value, uint32_t code) {
    if (response.held && (!valid || value != response.value)) ++broken_;
    response.held = valid && !ready;
    response.value = value;
    if (!valid) return false;
    if (!response.allowed || code) ++broken_;
    ++response.waited;
    if (!ready) return false;
    SlogAccess* a = response.expected.front();
    response.expected.pop_front();
    if (response.allowed) --response.allowed;
    response.waited = 0;
    a->value = value;
    a->answered = 1;
    return true;
  }

  void quiet_pins() {
    Vslog_board& t = clock_.pins();
    t.s_axil_awvalid = t.s_axil_wvalid = t.s_axil_arvalid = t.s_axil_bready = t.s_axil_rready = 0;
    clock_.tick();
  }

  Clock& clock_;
  SlogAccess* next_;
  SlogAccess* end_;
  size_t overlap_;
  std::deque<Request> aw_, w_, ar_;
  Response b_, r_;
  size_t addresses_ = 0, data_ = 0;
  int64_t broken_ = 0;
};
