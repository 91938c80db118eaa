// SPDX-License-Identifier: Apache-2.0
// The dense search on packed planes. Included by kernel.cpp once for each set of instructions, inside a namespace.
//
// Rows are taken one after another. With a = left ^ right at offset k and d(x, y) = a(x, y) - a(x, y - window), the
// mismatches of a window grow from row to row by the sum of d over the window's columns, which is made by doublings: of
// two columns, of four, and so on. All pixels of a row lie side by side, a byte each, and each offset has a row of sums.
// Where an offset does not count its sum is Far, and stays so. Then both planes' pixels choose among the offsets.

#ifdef SLOG_NIBBLES
constexpr int ByteCount = 32;
#else
constexpr int ByteCount = 16;
#endif
constexpr int LaneCount = ByteCount / 2;
typedef std::uint8_t Bytes __attribute__((vector_size(ByteCount), aligned(1), may_alias));
typedef std::int8_t HalfBytes __attribute__((vector_size(LaneCount), aligned(1), may_alias));
typedef std::int16_t Lanes __attribute__((vector_size(ByteCount), aligned(2), may_alias));
constexpr int Margin = 64;  // spare places before and after a row: a block and the shift of the widest doubling
constexpr std::int16_t Far = 32767;

// Vectors that begin anywhere; as functions, as a template would lose the types' alignment.
#define SLOG_VECTOR(name, Vector, Element) \
  static inline __attribute__((always_inline)) Vector &name(Element *at) { return *(Vector *)at; }
SLOG_VECTOR(bytes_at, Bytes, std::uint8_t)
SLOG_VECTOR(half_at, HalfBytes, std::uint8_t)
SLOG_VECTOR(lanes_at, Lanes, std::int16_t)
#undef SLOG_VECTOR

namespace {

// A pass's memory, and the numbers that its steps need.
struct DenseRows {
  const DenseJob &job;
  int width, height, stride, window;
  bool nibbles;                // whether a byte holds four pixels; see gather_nibbles
  std::uint8_t *left, *right;  // planes, a byte for each pixel, `stride` a row, and behind them a row of zeros
  std::uint8_t *delta;         // a row
  std::int16_t *sums;          // a row for each offset
  std::int16_t *theirs;        // a row: the right pixels' winners
  std::int16_t *ours[8];       // a row each: index, best, lower, upper, rest, and the flags
  int first(int k) const { return window - 1 + (job.start + k > 0 ? job.start + k : 0); }
  int last(int k) const { return job.start + k < 0 ? width + job.start + k : width; }
};

}  // namespace

// A plane with a byte for each pixel: eight at a time, from the eight bits of a byte by multiplication.
static void spread(const Word *plane, int pitch, int width, int height, int stride, std::uint8_t *bytes) {
  constexpr Word Each = 0x0101010101010101, Diagonal = 0x8040201008040201;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; x += 8) {
      const Word picked = (plane[(std::size_t)y * pitch + (x >> 6)] >> (x & 63) & 255) * Each & Diagonal;
      const Word ones = (picked + 127 * Each) >> 7 & Each;
      std::memcpy(bytes + (std::size_t)y * stride + x, &ones, 8);
    }
}

#ifdef SLOG_NIBBLES
// The bytes of single pixels become those of a pixel and the three to its left, in the bits 0 to 3.
static void gather_nibbles(int width, int height, int stride, std::uint8_t *bytes) {
  for (int y = 0; y < height; ++y)
    for (int x = (width - 1) / ByteCount * ByteCount; x >= 0; x -= ByteCount) {
      std::uint8_t *at = bytes + (std::size_t)y * stride + x;
      const Bytes two = bytes_at(at - 2) + bytes_at(at - 3) + bytes_at(at - 3);
      const Bytes one = bytes_at(at) + bytes_at(at - 1) + bytes_at(at - 1);
      bytes_at(at) = one + two + two + two + two;
    }
}

// Bits that are set in each byte, 0..15.
static inline __attribute__((always_inline)) Bytes set_bits(Bytes nibbles) {
  const __m256i counts = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                          0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  return (Bytes)_mm256_shuffle_epi8(counts, (__m256i)nibbles);
}
#endif

// Add to the sums of offset k what row y brings and row y - window, unless it is above `top`, takes away.
static void add_row(const DenseRows &rows, int y, int top, int k) {
  const int shift = rows.job.start + k, first = rows.first(k), last = rows.last(k), from = first - rows.window + 1;
  if (first >= last) return;
  const int above = y - rows.window >= top ? y - rows.window : rows.height;
  const int above_right = above < rows.height ? above - rows.job.down : rows.height;
  std::uint8_t *left = rows.left + (std::size_t)y * rows.stride;
  std::uint8_t *left_above = rows.left + (std::size_t)above * rows.stride;
  std::uint8_t *right = rows.right + (std::size_t)(y - rows.job.down) * rows.stride - shift;
  std::uint8_t *right_above = rows.right + (std::size_t)above_right * rows.stride - shift;
  std::uint8_t *delta = rows.delta;
  const int blocks = (last - from + ByteCount - 1) / ByteCount;
  int summed = rows.nibbles ? 4 : 1;
  for (int x = from; x < from + blocks * ByteCount; x += ByteCount) {
    const Bytes comes = bytes_at(left + x) ^ bytes_at(right + x);
    const Bytes leaves = bytes_at(left_above + x) ^ bytes_at(right_above + x);
#ifdef SLOG_NIBBLES
    bytes_at(delta + x) = rows.nibbles ? set_bits(comes) - set_bits(leaves) : comes - leaves;
#else
    bytes_at(delta + x) = comes - leaves;
#endif
  }
  // From the end, as each takes what was there before; four at a time take fewer passes than two.
  for (; 4 * summed <= rows.window; summed *= 4)
    for (int x = from + (blocks - 1) * ByteCount; x >= from; x -= ByteCount)
      bytes_at(delta + x) = (bytes_at(delta + x) + bytes_at(delta + x - summed)) +
                            (bytes_at(delta + x - 2 * summed) + bytes_at(delta + x - 3 * summed));
  if (summed < rows.window)
    for (int x = from + (blocks - 1) * ByteCount; x >= from; x -= ByteCount)
      bytes_at(delta + x) += bytes_at(delta + x - summed);
  std::int16_t *sums = rows.sums + (std::size_t)k * rows.stride;
  std::memset(delta + last, 0, LaneCount);
  for (int x = first; x < last; x += LaneCount)
#ifdef SLOG_NIBBLES  // as the compiler finds no short way for the conversion
    lanes_at(sums + x) += (Lanes)_mm256_cvtepi8_epi16((__m128i)half_at(delta + x));
#else
    lanes_at(sums + x) += __builtin_convertvector(half_at(delta + x), Lanes);
#endif
}

// The best offsets of a row's pixels, and what lies beside them; `far` and `index` as in golden.dense.dense.
static void choose_left(const DenseRows &rows) {
  const Lanes far = Lanes{} + Far;
  for (int x = 0; x < rows.width; x += LaneCount) {
    std::int16_t *sums = rows.sums + x;
    Lanes best = far, earlier = far, last = far, rest = far, lower = far, upper = far, index = Lanes{} - 1;
    Lanes taken = {}, k = {};
    for (int n = 0; n < rows.job.offsets; ++n, sums += rows.stride, k += 1) {
      const Lanes now = lanes_at(sums), takes = now < best, other = taken ? far : now;
      upper = taken ? now : upper;
      rest = rest < other ? rest : other;
      rest = takes ? earlier : rest;
      lower = takes ? last : lower;
      index = takes ? k : index;
      earlier = best;
      best = now < best ? now : best;
      last = now;
      taken = takes;
    }
    upper = taken ? far : upper;
    const Lanes *found[] = {&index, &best, &lower, &upper, &rest};
    for (int n = 0; n < 5; ++n) lanes_at(rows.ours[n] + x) = *found[n] == far ? Lanes{} - 1 : *found[n];
  }
}

// The best offsets of the right plane's pixels, in the row that was compared with the left one.
static void choose_right(const DenseRows &rows) {
  for (int x = 0; x < rows.width; x += LaneCount) {
    int from = -(x + LaneCount - 1) - rows.job.start, to = rows.width - x - rows.job.start;
    from = from < 0 ? 0 : from;
    to = to > rows.job.offsets ? rows.job.offsets : to;
    Lanes best = Lanes{} + Far, index = Lanes{} - 1, k = Lanes{} + (std::int16_t)from;
    std::int16_t *sums = rows.sums + (std::ptrdiff_t)from * (rows.stride + 1) + x + rows.job.start;
    for (int n = from; n < to; ++n, sums += rows.stride + 1, k += 1) {
      const Lanes now = lanes_at(sums), takes = now < best;
      index = takes ? k : index;
      best = now < best ? now : best;
    }
    lanes_at(rows.theirs + x) = index;
  }
}

// Which of a row's pixels have a winner, agree with the right plane's, and are valid: 1 or 0 each.
static void judge_row(const DenseRows &rows) {
  const DenseJob &job = rows.job;
  const std::int16_t *index = rows.ours[0];
  std::int16_t *found = rows.ours[5], *agrees = rows.ours[6], *valid = rows.ours[7];
  for (int x = 0; x < rows.width; ++x) {
    const int place = index[x] < 0 ? x : x - job.start - index[x];
    agrees[x] = (std::int16_t)(rows.theirs[place] - index[x]);
  }
  for (int x = 0; x < rows.width; x += LaneCount) {
    const Lanes apart = lanes_at(agrees + x), counts = lanes_at(rows.ours[0] + x) >= 0 ? Lanes{} + 1 : Lanes{};
    const Lanes near = (apart >= -1) & (apart <= 1) & counts;
    const Lanes most = Lanes{} + (std::int16_t)job.most, margin = Lanes{} + (std::int16_t)job.margin;
    const Lanes unchecked = job.check ? Lanes{} : Lanes{} + 1, other = lanes_at(rows.ours[4] + x), low = lanes_at(rows.ours[1] + x);
    const Lanes good = (low <= most) & ((other < 0) | (other - low >= margin)) & (near | unchecked);
    lanes_at(found + x) = counts, lanes_at(agrees + x) = near, lanes_at(valid + x) = good & counts;
  }
}

// Every step_x-th of a row's pixels into row `y` of the maps.
static void put_row(const DenseRows &rows, const DenseMaps &maps, int y) {
  const int step = rows.job.step_x, width = (rows.width + step - 1) / step;
  const std::size_t place = (std::size_t)y * width;
  for (int n = 0; n < 5; ++n) {
    std::int16_t *counts = maps.counts[n] + place;
    if (step == 1) std::memcpy(counts, rows.ours[n], sizeof(std::int16_t) * width);
    else for (int i = 0; i < width; ++i) counts[i] = rows.ours[n][i * step];
  }
  for (int n = 0; n < 3; ++n) {
    std::uint8_t *flags = maps.flags[n] + place;
    const std::int16_t *row = rows.ours[5 + n];
    if (step == 1) for (int i = 0; i < width; ++i) flags[i] = (std::uint8_t)row[i];
    else for (int i = 0; i < width; ++i) flags[i] = (std::uint8_t)row[i * step];
  }
}

// Lay the parts of a pass's memory behind one another.
static bool prepare(DenseRows &rows, Scratch &scratch) {
  const std::size_t stride = (std::size_t)rows.stride, plane = stride * (rows.height + 1);
  const std::size_t words = stride * (rows.job.offsets + 9);
  std::uint8_t *memory = (std::uint8_t *)scratch.take(2 * plane + 3 * stride + 2 * words);
  if (!memory) return false;
  std::memset(memory, 0, 2 * plane + 3 * stride);
  rows.left = memory + Margin;
  rows.right = rows.left + plane;
  rows.delta = rows.right + plane;
  rows.sums = (std::int16_t *)(memory + 2 * plane + 2 * stride) + Margin;
  for (std::size_t n = 0; n < words; ++n) rows.sums[(std::ptrdiff_t)n - Margin] = Far;
  for (int k = 0; k < rows.job.offsets; ++k)
    for (int x = rows.first(k); x < rows.last(k); ++x) rows.sums[k * stride + x] = 0;
  rows.theirs = rows.sums + rows.job.offsets * stride;
  for (int n = 0; n < 8; ++n) rows.ours[n] = rows.theirs + (n + 1) * stride;
  return true;
}

static int dense(const Word *left, const Word *right, int pitch, int width, int height, const DenseJob &job,
                 const DenseMaps &maps) {
  Scratch scratch;
  DenseRows rows{job, width, height, (width + 31) / 32 * 32 + 2 * Margin, job.window, false, {}, {}, {}, {}, {}, {}};
  if (!prepare(rows, scratch)) return 1;
  spread(left, pitch, width, height, rows.stride, rows.left);
  spread(right, pitch, width, height, rows.stride, rows.right);
#ifdef SLOG_NIBBLES
  rows.nibbles = job.window >= 4;
  if (rows.nibbles) {
    gather_nibbles(width, height, rows.stride, rows.left);
    gather_nibbles(width, height, rows.stride, rows.right);
  }
#endif
  const int top = job.down > 0 ? job.down : 0, bottom = job.down < 0 ? height + job.down : height;
  for (int y = 0; y < height; ++y) {
    if (y >= top && y < bottom)
      for (int k = 0; k < job.offsets; ++k) add_row(rows, y, top, k);
    if (y % job.step_y) continue;
    if (y >= top + job.window - 1 && y < bottom) {
      choose_left(rows);
      choose_right(rows);
    } else {
      for (int n = 0; n < 5; ++n) std::memset(rows.ours[n], 0xff, sizeof(std::int16_t) * width);
    }
    judge_row(rows);
    put_row(rows, maps, y / job.step_y);
  }
  return 0;
}
