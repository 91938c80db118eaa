// The Verilated board behind a C interface: whole frames and job lists per call, clocks counted, no callbacks.
//
// Every clock, `tick` plays the cameras' beats, the surface sink and the one register access under way. Calls that wait also
// keep the job queue fed and collect results, so that captures and correlations overlap as they would on hardware.
// Negative return values are errors: see `Error`. Register places come from the generated header.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "Vslog_board.h"
#include "slog_csr.h"
#include "verilated.h"
#if VM_TRACE_FST
#include "verilated_fst_c.h"
using Trace = VerilatedFstC;
#elif VM_TRACE
#include "verilated_vcd_c.h"
using Trace = VerilatedVcdC;
#endif

namespace {

constexpr int kCameras = 2;
constexpr int kJobFields = 16;     // see slog_submit
constexpr int kResultFields = 14;  // see slog_collect
constexpr int kIdle = 64;          // clocks between looks at the board when there is nothing to do
constexpr int kBusLimit = 1 << 20; // clocks a register access may take

enum Error { kTimeout = -1, kSurfaceBroken = -2 };

#define ADDRESS(reg) static_cast<uint32_t>(offsetof(slog_csr_t, reg))
#define PACK(field, value) ((static_cast<uint32_t>(value) << field##_bp) & field##_bm)
#define UNPACK(field, word) (((word) & field##_bm) >> field##_bp)

// A stream of coin tosses: true with a probability in thousandths.
struct Coin {
  uint64_t state = 0x9E3779B97F4A7C15ull;
  uint32_t threshold = 0;

  void set(uint32_t permille, uint64_t seed) {
    threshold = static_cast<uint32_t>(permille * 4294967ull);
    state = seed * 0x9E3779B97F4A7C15ull + 0x632BE59BD9B4E019ull;
  }
  bool toss() {
    if (!threshold) return false;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return static_cast<uint32_t>(state >> 32) < threshold;
  }
};

struct Camera {
  std::vector<uint16_t> beats;  // grey | user << 8 | last << 9
  size_t at = 0;
  bool offered = false;  // an offered beat stays offered
  Coin pause;

  bool busy() const { return at < beats.size(); }
};

struct Board {
  VerilatedContext context;
  std::unique_ptr<Vslog_board> top;
#if VM_TRACE
  std::unique_ptr<Trace> trace;
#endif
  uint64_t clocks = 0;
  Camera cameras[kCameras];
  Coin surface_pause;
  std::vector<uint16_t> surface;
  bool surface_first = true;
  bool surface_broken = false;
  bool stuck = false;  // a register access was never answered
  std::deque<std::vector<int32_t>> jobs;  // not yet on the board
  std::deque<std::vector<int32_t>> results;
  int64_t outstanding = 0;  // results expected from jobs on the board
  uint32_t job_depth = 0;
  std::vector<int64_t> written;  // last value of each job register, -1 unknown

  Board() : top(std::make_unique<Vslog_board>(&context)) {}
  ~Board() {
#if VM_TRACE
    if (trace) trace->close();
#endif
    top->final();
  }
};

void dump(Board& b, uint64_t half) {
#if VM_TRACE
  if (b.trace) b.trace->dump(2 * b.clocks + half);
#else
  (void)b;
  (void)half;
#endif
}

void tick(Board& b) {
  Vslog_board& t = *b.top;
  uint32_t data = 0, valid = 0, user = 0, last = 0;
  for (int c = 0; c < kCameras; ++c) {
    Camera& cam = b.cameras[c];
    if (!cam.busy()) continue;
    cam.offered = cam.offered || !cam.pause.toss();
    if (!cam.offered) continue;
    const uint32_t beat = cam.beats[cam.at];
    data |= (beat & 0xFF) << 8 * c;
    user |= (beat >> 8 & 1) << c;
    last |= (beat >> 9 & 1) << c;
    valid |= 1u << c;
  }
  t.vid_tdata_i = data;
  t.vid_tvalid_i = valid;
  t.vid_tuser_i = user;
  t.vid_tlast_i = last;
  t.surf_tready_i = !b.surface_pause.toss();
  t.clk_i = 0;
  t.eval();
  dump(b, 0);
  for (int c = 0; c < kCameras; ++c) {
    if (valid & t.vid_tready_o & 1u << c) {
      ++b.cameras[c].at;
      b.cameras[c].offered = false;
    }
  }
  // In a reset the board may say anything.
  if (!t.rst_i && t.surf_tvalid_o && t.surf_tready_i) {
    if (t.surf_tuser_o != b.surface_first) b.surface_broken = true;
    b.surface_first = t.surf_tlast_o;
    b.surface.push_back(t.surf_tdata_o);
  }
  t.clk_i = 1;
  t.eval();
  dump(b, 1);
  ++b.clocks;
}

// One register access at a time, as the board takes them: 10 clocks a write, 12 a read when the register answers at once.
void write(Board& b, uint32_t address, uint32_t data) {
  Vslog_board& t = *b.top;
  t.s_axil_awaddr = address;
  t.s_axil_wdata = data;
  t.s_axil_wstrb = 0xF;
  t.s_axil_awvalid = t.s_axil_wvalid = 1;
  t.s_axil_bready = 1;
  // With no access under way both channels are taken at once.
  tick(b);
  t.s_axil_awvalid = t.s_axil_wvalid = 0;
  for (int k = 0; !t.s_axil_bvalid && !b.stuck; ++k) {
    tick(b);
    b.stuck = k == kBusLimit;
  }
  tick(b);
  t.s_axil_bready = 0;
}

uint32_t read(Board& b, uint32_t address) {
  Vslog_board& t = *b.top;
  t.s_axil_araddr = address;
  t.s_axil_arvalid = 1;
  t.s_axil_rready = 1;
  tick(b);
  t.s_axil_arvalid = 0;
  for (int k = 0; !t.s_axil_rvalid && !b.stuck; ++k) {
    tick(b);
    b.stuck = k == kBusLimit;
  }
  const uint32_t data = t.s_axil_rdata;
  tick(b);
  t.s_axil_rready = 0;
  return data;
}

// A job register is written only when its value changes.
void write_cached(Board& b, uint32_t address, uint32_t data) {
  const size_t place = address / 4;
  if (b.written.size() <= place) b.written.resize(place + 1, -1);
  if (b.written[place] == data) return;
  write(b, address, data);
  b.written[place] = data;
}

void push_job(Board& b, const std::vector<int32_t>& j) {
  write_cached(b, ADDRESS(job.tpl), PACK(SLOG_CSR__JOB__TPL__SLOT, j[2]) | PACK(SLOG_CSR__JOB__TPL__X, j[3]) |
                                        PACK(SLOG_CSR__JOB__TPL__Y, j[4]));
  write_cached(b, ADDRESS(job.window),
               PACK(SLOG_CSR__JOB__WINDOW__WIDTH, j[5]) | PACK(SLOG_CSR__JOB__WINDOW__HEIGHT, j[6]));
  write_cached(b, ADDRESS(job.search), PACK(SLOG_CSR__JOB__SEARCH__SLOT, j[7]) |
                                           PACK(SLOG_CSR__JOB__SEARCH__X, j[8]) |
                                           PACK(SLOG_CSR__JOB__SEARCH__Y, j[9]));
  write_cached(b, ADDRESS(job.offsets),
               PACK(SLOG_CSR__JOB__OFFSETS__ACROSS, j[10]) | PACK(SLOG_CSR__JOB__OFFSETS__DOWN, j[11]));
  write_cached(b, ADDRESS(job.grid),
               PACK(SLOG_CSR__JOB__GRID__ACROSS, j[12]) | PACK(SLOG_CSR__JOB__GRID__DOWN, j[13]));
  write_cached(b, ADDRESS(job.step), PACK(SLOG_CSR__JOB__STEP__X, j[14]) | PACK(SLOG_CSR__JOB__STEP__Y, j[15]));
  write(b, ADDRESS(job.submit), PACK(SLOG_CSR__JOB__SUBMIT__TAG, j[0]) |
                                    PACK(SLOG_CSR__JOB__SUBMIT__SURFACE, j[1]) | SLOG_CSR__JOB__SUBMIT__GO_bm);
  b.outstanding += int64_t{std::max(j[12], 1)} * std::max(j[13], 1);
}

// Feeds the board from the host's queue; true when a job went.
bool feed(Board& b) {
  if (b.jobs.empty()) return false;
  const uint32_t status = read(b, ADDRESS(job.status));
  if (!UNPACK(SLOG_CSR__JOB__STATUS__READY, status)) return false;
  uint32_t room = b.job_depth - UNPACK(SLOG_CSR__JOB__STATUS__WAITING, status);
  bool fed = false;
  while (room && !b.jobs.empty()) {
    const bool grid = b.jobs.front()[12] > 1 || b.jobs.front()[13] > 1;
    push_job(b, b.jobs.front());
    b.jobs.pop_front();
    fed = true;
    if (grid) break;  // it may fill the queue: look again
    --room;
  }
  return fed;
}

// Takes the results that are there; true when one came.
bool drain(Board& b) {
  if (!b.top->irq_o) return false;
  bool came = false;
  for (;;) {
    const uint32_t head = read(b, ADDRESS(result.head));
    if (!UNPACK(SLOG_CSR__RESULT__HEAD__VALID, head)) return came;
    std::vector<int32_t> r(kResultFields);
    const uint32_t best = read(b, ADDRESS(result.best));
    const uint32_t scores = read(b, ADDRESS(result.scores));
    r[0] = UNPACK(SLOG_CSR__RESULT__HEAD__TAG, head);
    r[1] = UNPACK(SLOG_CSR__RESULT__HEAD__STATUS, head);
    r[2] = UNPACK(SLOG_CSR__RESULT__BEST__X, best);
    r[3] = UNPACK(SLOG_CSR__RESULT__BEST__Y, best);
    r[4] = UNPACK(SLOG_CSR__RESULT__SCORES__SCORE, scores);
    for (int k = 0; k < 4; ++k) {
      const uint32_t pair = read(b, ADDRESS(result.neighbour) + 4 * k);
      r[5 + 2 * k] = UNPACK(SLOG_CSR__RESULT__NEIGHBOUR__EVEN, pair);
      r[6 + 2 * k] = UNPACK(SLOG_CSR__RESULT__NEIGHBOUR__ODD, pair);
    }
    r[13] = UNPACK(SLOG_CSR__RESULT__SCORES__RUNNER_UP, scores);
    write(b, ADDRESS(result.pop), SLOG_CSR__RESULT__POP__GO_bm);
    b.results.push_back(std::move(r));
    --b.outstanding;
    came = true;
  }
}

// Keeps jobs and results moving for a while; true when something moved. Does nothing but clock an idle board.
bool pump(Board& b) {
  const bool fed = feed(b);
  const bool came = drain(b);
  if (fed || came) return true;
  for (int k = 0; k < kIdle && !b.top->irq_o; ++k) tick(b);
  return false;
}

}  // namespace

extern "C" {

Board* slog_new() { return new Board; }
void slog_free(Board* b) { delete b; }
uint64_t slog_clocks(const Board* b) { return b->clocks; }
int slog_stuck(const Board* b) { return b->stuck; }
int slog_irq(const Board* b) { return b->top->irq_o; }

// Starts a wave dump; false when this build has none.
int slog_trace(Board* b, const char* path) {
#if VM_TRACE
  b->context.traceEverOn(true);
  b->trace = std::make_unique<Trace>();
  b->top->trace(b->trace.get(), 99);
  b->trace->open(path);
  return 1;
#else
  (void)b;
  (void)path;
  return 0;
#endif
}

void slog_tick(Board* b, uint64_t clocks) {
  for (uint64_t k = 0; k < clocks; ++k) tick(*b);
}

// Everything queued or under way, on the host's side too, is forgotten.
void slog_reset(Board* b) {
  Vslog_board& t = *b->top;
  for (Camera& cam : b->cameras) {
    cam.beats.clear();
    cam.at = 0;
    cam.offered = false;
  }
  b->jobs.clear();
  b->results.clear();
  b->surface.clear();
  b->written.clear();
  b->outstanding = 0;
  b->surface_first = true;
  b->surface_broken = b->stuck = false;
  t.s_axil_awvalid = t.s_axil_wvalid = t.s_axil_arvalid = t.s_axil_bready = t.s_axil_rready = 0;
  t.rst_i = 1;
  for (int k = 0; k < 4; ++k) tick(*b);
  t.rst_i = 0;
  for (int k = 0; k < 4; ++k) tick(*b);
  b->job_depth = UNPACK(SLOG_CSR__BUILD_QUEUE__JOB_DEPTH, read(*b, ADDRESS(build_queue)));
  write(*b, ADDRESS(irq_enable), SLOG_CSR__IRQ_ENABLE__RESULT_bm);
}

void slog_write(Board* b, uint32_t address, uint32_t data) { write(*b, address, data); }
uint32_t slog_read(Board* b, uint32_t address) { return read(*b, address); }

// Coefficients (centre first, `count` of each kernel) and image size; waits until they are in use.
int slog_set_filter(Board* b, const int32_t* g, const int32_t* g2, int count, int width, int height,
                    uint64_t timeout) {
  for (int second = 0; second < 2; ++second) {
    for (int k = 0; k < count; ++k) {
      write(*b, ADDRESS(coef), PACK(SLOG_CSR__COEF__VALUE, (second ? g2 : g)[k]) |
                                   PACK(SLOG_CSR__COEF__SECOND, second) | PACK(SLOG_CSR__COEF__INDEX, k) |
                                   SLOG_CSR__COEF__GO_bm);
    }
  }
  write(*b, ADDRESS(image_size),
        PACK(SLOG_CSR__IMAGE_SIZE__WIDTH, width) | PACK(SLOG_CSR__IMAGE_SIZE__HEIGHT, height));
  write(*b, ADDRESS(filter), SLOG_CSR__FILTER__GO_bm);
  const uint64_t start = b->clocks;
  while (read(*b, ADDRESS(filter)) & SLOG_CSR__FILTER__BUSY_bm) {
    if (b->clocks - start > timeout) return kTimeout;
  }
  return 0;
}

// Queues beats (grey | user << 8 | last << 9) on a camera; they play while other calls run the clock.
void slog_play(Board* b, int camera, const uint16_t* beats, uint64_t count, uint32_t pause_permille, uint64_t seed) {
  Camera& cam = b->cameras[camera];
  cam.beats.erase(cam.beats.begin(), cam.beats.begin() + static_cast<ptrdiff_t>(cam.at));
  cam.at = 0;
  cam.beats.insert(cam.beats.end(), beats, beats + count);
  cam.pause.set(pause_permille, seed);
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

// Runs until every camera's beats are taken; jobs and results keep moving.
int slog_finish_playing(Board* b, uint64_t timeout) {
  const uint64_t start = b->clocks;
  while (std::any_of(b->cameras, b->cameras + kCameras, [](const Camera& c) { return c.busy(); })) {
    if (b->clocks - start > timeout) return kTimeout;
    if (!b->jobs.empty() || b->outstanding) {
      pump(*b);
    } else {
      for (int k = 0; k < kIdle; ++k) {
        tick(*b);
        if (!b->cameras[0].busy() && !b->cameras[1].busy()) break;
      }
    }
  }
  return 0;
}

// Arms a camera for a slot; returns whether the board took the request.
int slog_arm(Board* b, int camera, int slot) {
  write(*b, ADDRESS(capture), PACK(SLOG_CSR__CAPTURE__SLOT, slot) | PACK(SLOG_CSR__CAPTURE__CAMERA, camera) |
                                  SLOG_CSR__CAPTURE__GO_bm);
  return !(read(*b, ADDRESS(slot_status)) & SLOG_CSR__SLOT_STATUS__REFUSED_bm);
}

void slog_disarm(Board* b, int camera) {
  write(*b, ADDRESS(capture), PACK(SLOG_CSR__CAPTURE__CAMERA, camera) | SLOG_CSR__CAPTURE__CANCEL_bm |
                                  SLOG_CSR__CAPTURE__GO_bm);
}

// Runs until none of the cameras in the mask has a request left.
int slog_wait_captured(Board* b, uint32_t cameras, uint64_t timeout) {
  const uint64_t start = b->clocks;
  while (UNPACK(SLOG_CSR__SLOT_STATUS__ARMED, read(*b, ADDRESS(slot_status))) & cameras) {
    if (b->clocks - start > timeout) return kTimeout;
    pump(*b);
  }
  return 0;
}

// Queues jobs: tag, surface, tpl_slot, tpl_x, tpl_y, width, height, search_slot, search_x, search_y, offsets_x,
// offsets_y, grid across, down, step_x, step_y each. The host's side holds what the board has no room for.
void slog_submit(Board* b, const int32_t* jobs, int64_t count) {
  for (int64_t k = 0; k < count; ++k) b->jobs.emplace_back(jobs + k * kJobFields, jobs + (k + 1) * kJobFields);
  feed(*b);
}

// Runs until `count` results are there and hands them out: tag, status, best_x, best_y, score, eight neighbours,
// runner_up each. The timeout is for a single result.
int slog_collect(Board* b, int32_t* results, int64_t count, uint64_t timeout) {
  uint64_t moved = b->clocks;
  while (static_cast<int64_t>(b->results.size()) < count) {
    if (pump(*b)) moved = b->clocks;
    if (b->clocks - moved > timeout) return kTimeout;
  }
  for (int64_t k = 0; k < count; ++k) {
    std::copy(b->results.front().begin(), b->results.front().end(), results + k * kResultFields);
    b->results.pop_front();
  }
  return 0;
}

// Results queued for, on the board or still on the host's side, and not handed out.
int64_t slog_outstanding(const Board* b) {
  int64_t waiting = b->outstanding + static_cast<int64_t>(b->results.size());
  for (const auto& j : b->jobs) waiting += int64_t{std::max(j[12], 1)} * std::max(j[13], 1);
  return waiting;
}

void slog_pause_surface(Board* b, uint32_t pause_permille, uint64_t seed) { b->surface_pause.set(pause_permille, seed); }

// Runs until `count` scores have streamed out and hands them out.
int slog_surface(Board* b, uint16_t* scores, int64_t count, uint64_t timeout) {
  uint64_t moved = b->clocks;
  size_t before = b->surface.size();
  while (static_cast<int64_t>(b->surface.size()) < count) {
    if (pump(*b) || b->surface.size() != before) moved = b->clocks;
    before = b->surface.size();
    if (b->clocks - moved > timeout) return kTimeout;
  }
  if (b->surface_broken) return kSurfaceBroken;
  std::copy(b->surface.begin(), b->surface.begin() + count, scores);
  b->surface.erase(b->surface.begin(), b->surface.begin() + count);
  return 0;
}

int64_t slog_surface_waiting(const Board* b) { return static_cast<int64_t>(b->surface.size()); }

// Reads `count` 32-bit pieces of the store from a word address on.
void slog_peek(Board* b, uint32_t word, uint32_t* data, int64_t count) {
  write(*b, ADDRESS(peek_address), PACK(SLOG_CSR__PEEK_ADDRESS__WORD, word) | SLOG_CSR__PEEK_ADDRESS__GO_bm);
  for (int64_t k = 0; k < count; ++k) data[k] = read(*b, ADDRESS(peek_data));
}

}  // extern "C"
