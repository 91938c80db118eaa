// SPDX-License-Identifier: Apache-2.0
// Correlation jobs on packed planes. Included by kernel.cpp once for each set of instructions, inside a namespace.
//
// A job's mismatches (width * height less its scores) are counted in one of two ways.
//
// By columns: for one column of offsets, the 64 bits to the right of it of each search row are compared with the rows
// of the template by XOR and population count; eight rows of offsets at once where ny is not small.
//
// By nibbles (AVX2): of each search row, every pixel is a byte that holds it and the three pixels to its right. A
// template row is cut in pieces of four pixels, and for each of the 16 values of a piece there is a table of 16 bytes:
// the mismatches with each of the 16 values of a nibble. One byte shuffle thus looks up the mismatches of four pixels
// at 32 offsets. It is the faster way where there are many offsets side by side.

// A vector of eight words, wherever it lies.
typedef Word Octet __attribute__((vector_size(64), aligned(8), may_alias));

// The parts of a job that every step needs. Rows of the template and of the search begin at the job's first row.
struct Task {
  const Word *tpl, *search;
  int pitch, tpl_x, search_x, width, height, nx, ny, words;
  Word *rows, *column;      // words x height of the template; words x (rows() + 8) of the search
  std::uint8_t *nibbles;    // rows() of `span` bytes
  std::uint8_t *tables;     // (height + 2 * Spare) rows of pieces() tables of 16 bytes
  std::uint16_t *mismatch;  // ny rows of nx
  std::uint16_t *least;     // of each row of offsets
  int span;
  int searched() const { return height + ny - 1; }
  int pieces() const { return (width + 3) / 4; }
  Word mask(int k) const { return low_bits(width - 64 * k < 64 ? width - 64 * k : 64); }
};

static inline __attribute__((always_inline)) void add_counts(Octet &sum, const Octet &word, Word other) {
#ifdef SLOG_VECTOR_COUNT
  sum += (Octet)_mm512_popcnt_epi64((__m512i)(word ^ other));
#else
  const Octet differ = word ^ other;
  for (int i = 0; i < 8; ++i) sum[i] += (Word)__builtin_popcountll(differ[i]);
#endif
}

// `Blocks` times eight rows of offsets from row y on, in the column of `task.column`.
template <int Blocks>
static void count_rows(const Task &task, int x, int y) {
  Octet sum[Blocks] = {};
  for (int k = 0; k < task.words; ++k) {
    const Word *column = task.column + k * (task.searched() + 8) + y, *rows = task.rows + k * task.height;
    for (int t = 0; t < task.height; ++t)
      SLOG_EACH(b, Blocks) add_counts(sum[b], *(const Octet *)(column + t + 8 * b), rows[t]);
  }
  Word counts[8 * Blocks];
  SLOG_EACH(b, Blocks) *(Octet *)(counts + 8 * b) = sum[b];
  for (int i = 0; i < 8 * Blocks && y + i < task.ny; ++i)
    task.mismatch[(y + i) * task.nx + x] = (std::uint16_t)counts[i];
}

static void count_column_by_rows(const Task &task, int x) {
  for (int y = 0; y < task.ny; ++y) {
    Word sum = 0;
    for (int k = 0; k < task.words; ++k) {
      const Word *column = task.column + k * (task.searched() + 8) + y, *rows = task.rows + k * task.height;
      for (int t = 0; t < task.height; ++t) sum += (Word)__builtin_popcountll(column[t] ^ rows[t]);
    }
    task.mismatch[y * task.nx + x] = (std::uint16_t)sum;
  }
}

static void count_column(const Task &task, int x) {
  const int stride = task.searched() + 8;
  for (int k = 0; k < task.words; ++k) {
    const Word mask = task.mask(k);
    for (int r = 0; r < task.searched(); ++r)
      task.column[k * stride + r] = bits_at(task.search + r * task.pitch, task.search_x + x + 64 * k) & mask;
  }
#if defined(SLOG_SCALAR_COLUMNS) && !defined(SLOG_VECTOR_COUNT)
  count_column_by_rows(task, x);
#else
  int y = 0;
  if (task.ny < 4) return count_column_by_rows(task, x);
  for (; task.ny - y > 24; y += 32) count_rows<4>(task, x, y);
  for (; y < task.ny; y += 8) count_rows<1>(task, x, y);
#endif
}

static void load_template(const Task &task) {
  for (int k = 0; k < task.words; ++k)
    for (int t = 0; t < task.height; ++t)
      task.rows[k * task.height + t] = bits_at(task.tpl + t * task.pitch, task.tpl_x + 64 * k) & task.mask(k);
}

#ifdef SLOG_NIBBLES
#include "nibbles.hpp"
#endif

// The best of the mismatches, its neighbours and the runner-up, as golden.correlate.peak.
static void find_peak(const Task &task, Result &result) {
  const int nx = task.nx, ny = task.ny, area = task.width * task.height;
  int best = area + 1, y = 0, x = 0;
  for (int r = 0; r < ny; ++r) {
    const std::uint16_t *row = task.mismatch + r * nx;
    std::uint16_t least = 65535;
    for (int i = 0; i < nx; ++i) least = row[i] < least ? row[i] : least;
    task.least[r] = least;
    if (least < best) best = least, y = r;
  }
  while (task.mismatch[y * nx + x] != best) ++x;
  int other = area + 1;
  for (int r = 0; r < ny; ++r) {
    if (r < y - 1 || r > y + 1) {
      other = task.least[r] < other ? task.least[r] : other;
      continue;
    }
    const std::uint16_t *row = task.mismatch + r * nx;
    for (int i = 0; i < x - 1; ++i) other = row[i] < other ? row[i] : other;
    for (int i = x + 2; i < nx; ++i) other = row[i] < other ? row[i] : other;
  }
  result.best_x = x, result.best_y = y, result.score = area - best;
  result.runner_up = other > area ? NoScore : area - other;
  for (int i = 0, n = 0; i < 9; ++i) {
    if (i == 4) continue;
    const int v = y + i / 3 - 1, u = x + i % 3 - 1;
    result.neighbours[n++] =
        v < 0 || v >= ny || u < 0 || u >= nx ? NoScore : area - task.mismatch[v * nx + u];
  }
}

// Lay the parts of a task's memory behind one another.
static bool prepare(Task &task, Scratch &scratch) {
  const std::size_t words = (std::size_t)task.words, height = (std::size_t)task.height;
  const std::size_t searched = (std::size_t)task.searched(), offsets = (std::size_t)task.nx * task.ny;
  const std::size_t column = words * (searched + 8) * sizeof(Word), rows = words * height * sizeof(Word);
  std::size_t tables = 0, nibbles = 0;
#ifdef SLOG_NIBBLES
  tables = (height + 2 * Spare) * task.pieces() * 16;
  task.span = ((task.nx + 31) / 32 * 32 + task.width + 3 + 47) / 48 * 48;
  nibbles = searched * task.span + 64;
#endif
  std::uint8_t *at = (std::uint8_t *)scratch.take(column + rows + tables + nibbles + 2 * (offsets + task.ny));
  if (!at) return false;
  std::memset(at, 0, column);
  task.column = (Word *)at;
  task.rows = (Word *)(at += column);
  task.tables = at += rows;
  task.nibbles = at += tables;
  task.mismatch = (std::uint16_t *)(at += nibbles);
  task.least = task.mismatch + offsets;
  return true;
}

static int search(const Word *const *planes, int pitch, const Job *jobs, Result *results, long count,
                  std::int32_t *surface) {
  Scratch scratch;
  for (long n = 0; n < count; ++n) {
    const Job &job = jobs[n];
    Task task{};
    task.tpl = planes[job.tpl_slot] + job.tpl_y * pitch, task.search = planes[job.search_slot] + job.search_y * pitch;
    task.pitch = pitch, task.tpl_x = job.tpl_x, task.search_x = job.search_x;
    task.width = job.width, task.height = job.height, task.nx = job.offsets_x, task.ny = job.offsets_y;
    task.words = (task.width + 63) / 64;
    if (!prepare(task, scratch)) return 1;
    load_template(task);
    int x = 0;
#ifdef SLOG_NIBBLES
    x = count_nibbles(task);
#endif
    for (; x < task.nx; ++x) count_column(task, x);
    find_peak(task, results[n]);
    if (surface)
      for (int i = 0; i < task.nx * task.ny; ++i) surface[i] = task.width * task.height - task.mismatch[i];
  }
  return 0;
}
