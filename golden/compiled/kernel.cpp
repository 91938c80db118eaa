// SPDX-License-Identifier: Apache-2.0
// The golden board's arithmetic for hosts: signs of the LoG, results of correlation jobs and of the dense search,
// the same bits as golden/log.py, golden/correlate.py and golden/dense_job.py, which specify them. `calls.py` calls it, `build.py` compiles it.
//
// A sign plane is packed: row after row of `pitch` 64-bit words, pixel x of a row in bit x % 64 of word x / 64. A row
// has one word more than its pixels fill, so that 64 bits can be read from any of its pixels on; unused bits are 0.
//
// The files below are compiled once for each set of instructions, and the caller chooses among them at run time.

#include <cstdint>
#include <cstdlib>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace {

using Word = std::uint64_t;
constexpr std::int32_t NoScore = 32767;  // golden.params.NO_SCORE

// A job that golden.correlate.check accepts, and the fields of its result in the order of golden.correlate.Result.
struct Job {
  std::int32_t tpl_slot, tpl_x, tpl_y, width, height, search_slot, search_x, search_y, offsets_x, offsets_y;
};
struct Result {
  std::int32_t best_x, best_y, score, neighbours[8], runner_up;
};

// A pass of the dense search that golden.dense_job.check_job accepts; see golden.dense_job.DenseJob.
struct DenseJob {
  std::int32_t window, offsets, start, down, step_x, step_y, most, margin, check;
};
// Where the answer goes, in the order of golden.dense_job.DenseResult: every step_x-th pixel of every step_y-th row.
struct DenseMaps {
  std::int16_t *counts[5];
  std::uint8_t *flags[3];
};

// Memory that grows with the largest job of a batch.
class Scratch {
 public:
  ~Scratch() { std::free(memory_); }
  // At least `bytes`, aligned to 64; nullptr where there is not that much.
  void *take(std::size_t bytes) {
    if (bytes > size_) {
      std::free(memory_);
      size_ = (bytes + 63) / 64 * 64;
      memory_ = std::aligned_alloc(64, size_);
      if (!memory_) size_ = 0;
    }
    return memory_;
  }

 private:
  void *memory_ = nullptr;
  std::size_t size_ = 0;
};

// The 64 bits of a row from pixel x on.
inline Word bits_at(const Word *row, int x) {
  const Word *word = row + (x >> 6);
  const int shift = x & 63;
  return word[0] >> shift | word[1] << 1 << (63 - shift);
}

// A short loop over an array of vectors: only unrolled does the compiler keep them in registers.
#define SLOG_EACH(index, count) _Pragma("GCC unroll 4") for (int index = 0; index < count; ++index)

// The lowest `count` bits, 1..64.
inline Word low_bits(int count) { return ~Word{0} >> (64 - count); }

}  // namespace

namespace plain {
#include "dense.hpp"
#include "filter.hpp"
#include "search.hpp"
}  // namespace plain

#if defined(__x86_64__)
#define SLOG_SCALAR_COLUMNS
#pragma GCC push_options
#pragma GCC target("popcnt")
namespace popcnt {
#include "dense.hpp"
#include "filter.hpp"
#include "search.hpp"
}  // namespace popcnt
#pragma GCC pop_options

#define SLOG_NIBBLES
#pragma GCC push_options
#pragma GCC target("popcnt,avx2,fma,bmi2")
namespace avx2 {
#include "dense.hpp"
#include "filter.hpp"
#include "search.hpp"
}  // namespace avx2
#pragma GCC pop_options

#define SLOG_VECTOR_COUNT
#pragma GCC push_options
#pragma GCC target("popcnt,avx2,fma,bmi2,avx512f,avx512bw,avx512vl,avx512dq,avx512vpopcntdq")
namespace avx512 {
#include "dense.hpp"
#include "filter.hpp"
#include "search.hpp"
}  // namespace avx512
#pragma GCC pop_options
#endif

namespace {

struct Variant {
  const char *name;
  bool (*present)();
  decltype(&plain::search) search;
  decltype(&plain::filter) filter;
  decltype(&plain::dense) dense;
};

// From the slowest to the fastest.
const Variant Variants[] = {
    {"plain", [] { return true; }, plain::search, plain::filter, plain::dense},
#if defined(__x86_64__)
    {"popcnt", [] { return __builtin_cpu_supports("popcnt") != 0; }, popcnt::search, popcnt::filter, popcnt::dense},
    {"avx2",
     [] {
       return __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
              __builtin_cpu_supports("bmi2");
     },
     avx2::search, avx2::filter, avx2::dense},
    {"avx512",
     [] {
       return Variants[2].present() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
              __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
              __builtin_cpu_supports("avx512vpopcntdq");
     },
     avx512::search, avx512::filter, avx512::dense},
#endif
};
constexpr int VariantCount = sizeof Variants / sizeof *Variants;

}  // namespace

extern "C" {

// Name of variant `index` where this processor has its instructions, "" where it has not, nullptr after the last.
const char *slog_variant(int index) {
  if (index < 0 || index >= VariantCount) return nullptr;
  return Variants[index].present() ? Variants[index].name : "";
}

// Results of `count` jobs on the planes of the slots that they name, all of `pitch` words a row; with `surface`, the
// scores of the only job, too, int32, offsets_y rows of offsets_x. Returns 0, or 1 where memory is short.
int slog_search(int variant, const Word *const *planes, int pitch, const Job *jobs, Result *results, long count,
                std::int32_t *surface) {
  return Variants[variant].search(planes, pitch, jobs, results, count, surface);
}

// Signs of the LoG of a grey image, packed, and, unless nullptr, its response. `taps` are the radius + 1 coefficients
// of g, then those of g2, the centre first. Returns 0, or 1 where memory is short.
int slog_filter(int variant, const std::uint8_t *image, int width, int height, const std::int32_t *taps, int radius,
                Word *signs, int pitch, std::int64_t *response) {
  return Variants[variant].filter(image, width, height, taps, radius, signs, pitch, response);
}

// The dense search on two planes of `pitch` words a row. Returns 0, or 1 where memory is short.
int slog_dense(int variant, const Word *left, const Word *right, int pitch, int width, int height, const DenseJob *job,
               const DenseMaps *maps) {
  return Variants[variant].dense(left, right, pitch, width, height, *job, *maps);
}
}
