// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/steps/gauss_newton.h"

namespace lamina::detail {

void run_gauss_newton(PatchObjective& objective, const TexelMaps& level, InversionCourse& course,
                      int most_steps) {
  constexpr int most_inner_steps = 12;  // of conjugate gradients
  constexpr double tolerance = 0.03;
  constexpr float longest = 1.5f;  // of a step, in coordinates
  for (int taken = 0; taken < most_steps && !course.must_end(4.0); ++taken) {
    const PatchState& at = course.best;
    objective.linearize(at);
    TexelMaps downhill = objective.gradient(at);
    for (std::vector<float>& map : downhill)
      for (float& value : map) value = -value;
    const BandBlocks blocks(objective, at.coordinates, level);
    TexelMaps step =
        solve_by_conjugate_gradients(objective, blocks, std::move(downhill), most_inner_steps,
                                     tolerance, [&] { return course.must_end(3.0); });
    if (course.stop == InversionStop::interrupted) return;
    for (std::vector<float>& map : step)
      for (float& value : map) value = std::clamp(value, -longest, longest);
    bool is_better = false;
    for (double factor = 1.0; factor > 0.02 && !is_better; factor *= 0.4) {
      if (course.must_end()) return;
      PatchState next = objective.state(moved(objective.tables(), at.coordinates, factor, step));
      is_better = next.objective < at.objective;
      if (is_better && course.take(std::move(next))) return;
    }
    if (!is_better) {
      course.ends(InversionStop::converged);
      return;
    }
  }
}

}  // namespace lamina::detail
