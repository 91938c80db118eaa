// SPDX-License-Identifier: Apache-2.0
// Counts the toggles of signals wider than 64 bits. Verilator 5.48's own function runs past the 32 bits of each word, and so
// counts the changes of a low bit for bits 32, 64, ... above it too: a bit that never changes seems to be hit.
#pragma once

#include "verilated_cov.h"

static inline void slog_toggle_wide(int width, uint32_t* counts, WDataInP now, WDataInP before) {
  for (int bit = 0; bit < width; ++bit) {
    const EData value = now[bit / VL_EDATASIZE] >> bit % VL_EDATASIZE & 1;
    const EData old = before[bit / VL_EDATASIZE] >> bit % VL_EDATASIZE & 1;
    counts[2 * bit + value] += value ^ old;
  }
}

#define VL_COV_TOGGLE_CHG_ST_W slog_toggle_wide
