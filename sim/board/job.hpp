// SPDX-License-Identifier: Apache-2.0
// A job and its result as they cross the C interface; `sim/board/structs.py` has the same two for NumPy.
#pragma once

#include <algorithm>
#include <cstdint>

// A correlation job, and the grid of jobs that it begins: `golden.correlate.Job` with counts and steps.
struct SlogJob {
  int32_t tag;
  int32_t surface;
  int32_t tpl_slot;
  int32_t tpl_x;
  int32_t tpl_y;
  int32_t width;
  int32_t height;
  int32_t search_slot;
  int32_t search_x;
  int32_t search_y;
  int32_t offsets_x;
  int32_t offsets_y;
  int32_t grid_across;
  int32_t grid_down;
  int32_t step_x;
  int32_t step_y;

  // Results that the board gives for it.
  int64_t count() const { return int64_t{std::max(grid_across, 1)} * std::max(grid_down, 1); }
};

// The answer to one job: `golden.correlate.Result`. Neighbours in raster order: NW N NE W E SW S SE.
struct SlogResult {
  int32_t tag;
  int32_t status;
  int32_t best_x;
  int32_t best_y;
  int32_t score;
  int32_t neighbours[8];
  int32_t runner_up;
};

static_assert(sizeof(SlogJob) == 64);
static_assert(sizeof(SlogResult) == 56);
