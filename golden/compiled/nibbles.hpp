// SPDX-License-Identifier: Apache-2.0
// Mismatches by nibbles; see search.hpp, which includes this file where there is AVX2.

constexpr int Spare = 3;  // rows of zeros before and after the template's tables: up to Spare + 1 rows share a nibble

// bytes[b]: the bits of b as bytes 0 or 1, the lowest first.
struct Spread {
  Word bytes[256];
  constexpr Spread() : bytes() {
    for (int b = 0; b < 256; ++b)
      for (int i = 0; i < 8; ++i) bytes[b] |= (Word)(b >> i & 1) << (8 * i);
  }
};
alignas(64) static constexpr Spread Spreads;

// of[n - 1][t][s]: mismatches of the lowest n bits of t and s.
struct Tables {
  std::uint8_t of[4][16][16];
  constexpr Tables() : of() {
    for (int n = 1; n <= 4; ++n)
      for (int t = 0; t < 16; ++t)
        for (int s = 0; s < 16; ++s)
          for (int i = 0; i < n; ++i) of[n - 1][t][s] = (std::uint8_t)(of[n - 1][t][s] + ((t ^ s) >> i & 1));
  }
};
alignas(64) static constexpr Tables Lookup;

// Eight pixels, from bit `at` of `bits` on, each with the three to its right, as bytes.
static inline Word nibbles_at(Word bits, int at) {
  return Spreads.bytes[bits >> at & 255] | Spreads.bytes[bits >> (at + 1) & 255] << 1 |
         Spreads.bytes[bits >> (at + 2) & 255] << 2 | Spreads.bytes[bits >> (at + 3) & 255] << 3;
}

static void load_nibbles(const Task &task, int blocks) {
  const int bytes = 32 * blocks + task.width + 3, end = 64 * (task.pitch - 1) - task.search_x;
  for (int r = 0; r < task.searched(); ++r) {
    const Word *row = task.search + r * task.pitch;
    std::uint8_t *out = task.nibbles + r * task.span;
    for (int x = 0; x < bytes; x += 48) {  // 64 bits hold the nibbles of 61 pixels
      const Word bits = x < end ? bits_at(row, task.search_x + x) : 0;
      for (int i = 0; i < 48; i += 8) {
        const Word eight = nibbles_at(bits, i);
        std::memcpy(out + x + i, &eight, 8);
      }
    }
  }
}

static void load_tables(const Task &task) {
  const int pieces = task.pieces();
  std::memset(task.tables, 0, (std::size_t)(Spare * pieces * 16));
  std::memset(task.tables + (task.height + Spare) * pieces * 16, 0, (std::size_t)(Spare * pieces * 16));
  for (int t = 0; t < task.height; ++t)
    for (int c = 0; c < pieces; ++c) {
      const int n = task.width - 4 * c < 4 ? task.width - 4 * c : 4;
      const Word nibble = task.rows[(c / 16) * task.height + t] >> (4 * (c % 16)) & 15;
      std::memcpy(task.tables + ((t + Spare) * pieces + c) * 16, Lookup.of[n - 1][nibble], 16);
    }
}

// Mismatches of `Down` rows of offsets from y on, in `Across` times 32 columns from x on. Sums are bytes until they might
// overflow.
template <int Down, int Across>
static void sweep(const Task &task, int x, int y) {
  const int pieces = task.pieces(), most = 255 / task.width, last = task.height + Down - 2;
  std::uint16_t total[Down][32 * Across] = {};
  __m256i sum[Down][Across];
  SLOG_EACH(d, Down) SLOG_EACH(a, Across) sum[d][a] = _mm256_setzero_si256();
  for (int r = 0, rows = 1; r <= last; ++r, ++rows) {
    const std::uint8_t *nibbles = task.nibbles + (y + r) * task.span + x;
    const std::uint8_t *tables = task.tables + (r + Spare) * pieces * 16;
    for (int c = 0; c < pieces; ++c) {
      __m256i here[Across];
      SLOG_EACH(a, Across) here[a] = _mm256_loadu_si256((const __m256i *)(nibbles + 4 * c + 32 * a));
      SLOG_EACH(d, Down) {
        const __m128i mismatches = _mm_loadu_si128((const __m128i *)(tables + (c - d * pieces) * 16));
        const __m256i table = _mm256_broadcastsi128_si256(mismatches);
        SLOG_EACH(a, Across) sum[d][a] = _mm256_add_epi8(sum[d][a], _mm256_shuffle_epi8(table, here[a]));
      }
    }
    if (rows < most && r < last) continue;
    rows = 0;
    SLOG_EACH(d, Down) SLOG_EACH(a, Across) {
      alignas(32) std::uint8_t part[32];
      _mm256_store_si256((__m256i *)part, sum[d][a]);
      for (int i = 0; i < 32; ++i) total[d][32 * a + i] = (std::uint16_t)(total[d][32 * a + i] + part[i]);
      sum[d][a] = _mm256_setzero_si256();
    }
  }
  const int columns = task.nx - x < 32 * Across ? task.nx - x : 32 * Across;
  for (int d = 0; d < Down; ++d)
    std::memcpy(task.mismatch + (y + d) * task.nx + x, total[d], (std::size_t)columns * 2);
}

template <int Across>
static void sweep_down(const Task &task, int x) {
  int y = 0;
  for (; y + 4 <= task.ny; y += 4) sweep<4, Across>(task, x, y);
  switch (task.ny - y) {
    case 3: return sweep<3, Across>(task, x, y);
    case 2: return sweep<2, Across>(task, x, y);
    case 1: return sweep<1, Across>(task, x, y);
    default: return;
  }
}

// Count the columns of a task for which this is the faster way; returns how many these are, from the first on.
static int count_nibbles(const Task &task) {
#ifdef SLOG_VECTOR_COUNT
  if (task.ny >= 8) return 0;
#endif
  const int rest = task.nx % 32;
  const int blocks = task.nx / 32 + (16 * rest * task.words > 15 * task.pieces());  // measured
  if (!blocks) return 0;
  load_nibbles(task, blocks);
  load_tables(task);
  int b = 0;
  for (; b + 2 <= blocks; b += 2) sweep_down<2>(task, 32 * b);
  if (b < blocks) sweep_down<1>(task, 32 * b);
  return 32 * blocks < task.nx ? 32 * blocks : task.nx;
}
