// SPDX-License-Identifier: Apache-2.0
// Signs of the LoG. Included by kernel.cpp once for each set of instructions, inside a namespace.
//
// Sums are floating point, which is exact here in whatever order they are added: every product and partial sum is an
// integer below 2**24 down the columns (float) and below 2**53 along the rows (double); see golden/log.py.

// One row down the columns: v and v2 of all its pixels, `radius` before and after them continued.
static void filter_down(const std::uint8_t *image, int width, int height, int y, const std::int32_t *taps, int radius,
                        int reach, double *v, double *v2) {
  constexpr int Block = 32;
  for (int x = 0; x < width; x += Block) {
    const int from = x + Block <= width ? x : width > Block ? width - Block : 0;
    const int n = width < Block ? width : Block;
    float sum[Block] = {}, sum2[Block] = {};
    for (int k = 0; k <= reach; ++k) {
      const std::uint8_t *above = image + (std::size_t)(y - k < 0 ? 0 : y - k) * width + from;
      const std::uint8_t *below = image + (std::size_t)(y + k >= height ? height - 1 : y + k) * width + from;
      const float g = (float)taps[k] * (k ? 1.0f : 0.5f), g2 = (float)taps[radius + 1 + k] * (k ? 1.0f : 0.5f);
      if (n == Block) {
        for (int i = 0; i < Block; ++i) {
          const float both = (float)(above[i] + below[i]);
          sum[i] += g * both;
          sum2[i] += g2 * both;
        }
      } else {
        for (int i = 0; i < n; ++i) {
          const float both = (float)(above[i] + below[i]);
          sum[i] += g * both;
          sum2[i] += g2 * both;
        }
      }
    }
    for (int i = 0; i < n; ++i) {
      v[radius + from + i] = (double)(((std::int32_t)sum[i] + 64) >> 7);
      v2[radius + from + i] = (double)(((std::int32_t)sum2[i] + 64) >> 7);
    }
  }
  for (int i = 0; i < radius; ++i) {
    v[i] = v[radius], v2[i] = v2[radius];
    v[radius + width + i] = v[radius + width - 1], v2[radius + width + i] = v2[radius + width - 1];
  }
}

// The response of `Block` pixels of a row; `v` and `v2` begin at the first.
constexpr int Block = 16;
static void filter_along(const double *v, const double *v2, const std::int32_t *taps, int radius, int reach,
                         double *response) {
  double sum[Block];
  for (int i = 0; i < Block; ++i) sum[i] = (double)taps[radius + 1] * v[i] + (double)taps[0] * v2[i];
  for (int k = 1; k <= reach; ++k) {
    const double g = (double)taps[k], g2 = (double)taps[radius + 1 + k];
    for (int i = 0; i < Block; ++i) sum[i] += g2 * (v[i - k] + v[i + k]) + g * (v2[i - k] + v2[i + k]);
  }
  for (int i = 0; i < Block; ++i) response[i] = sum[i];
}

static int filter(const std::uint8_t *image, int width, int height, const std::int32_t *taps, int radius, Word *signs,
                  int pitch, std::int64_t *response) {
  int reach = radius;  // taps that are zero in both kernels add nothing
  while (reach && !taps[reach] && !taps[radius + 1 + reach]) --reach;
  const std::size_t length = (std::size_t)width + 2 * (std::size_t)radius + Block;
  Scratch scratch;
  double *v = (double *)scratch.take((2 * length + (std::size_t)width + 64) * sizeof(double));
  if (!v) return 1;
  double *v2 = v + length, *row = v2 + length;
  std::memset(v, 0, 2 * length * sizeof(double));
  for (int y = 0; y < height; ++y) {
    filter_down(image, width, height, y, taps, radius, reach, v, v2);
    for (int x = 0; x < width; x += Block)
      filter_along(v + radius + x, v2 + radius + x, taps, radius, reach, row + x);
    for (int k = 0; k < pitch; ++k) {
      Word word = 0;
      for (int i = 0; i < 64 && 64 * k + i < width; ++i) word |= (Word)(row[64 * k + i] > 0) << i;
      signs[(std::size_t)y * pitch + k] = word;
    }
    if (response)
      for (int x = 0; x < width; ++x) response[(std::size_t)y * width + x] = (std::int64_t)row[x];
  }
  return 0;
}
