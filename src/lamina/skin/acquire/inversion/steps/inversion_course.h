// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>

#include "lamina/skin/acquire/inversion/objective/patch_objective.h"

namespace lamina::detail {

/// Where an inversion stands, and when it is to end.
class InversionCourse {
 public:
  InversionCourse(const InversionOptions& options, const PatchLight& light,
                  const Progress& progress, PatchState start)
      : options_(options), light_(light), progress_(progress), best(std::move(start)) {
    record();
  }

  /// Takes a better state. Returns whether all is done.
  bool take(PatchState better) {
    best = std::move(better);
    record();
    // What the last steps have gained, as many as one of Gauss and Newton costs.
    constexpr double spent = 10.0;  // forward equivalents
    std::size_t before = history.size() - 1;
    while (before > first_ &&
           history.back().forwards - history[before].forwards < spent * light_.cost())
      --before;
    if (history.back().forwards - history[before].forwards < spent * light_.cost())
      return must_end();
    const double decrease = 1.0 - best.objective / history[before].objective;
    if (decrease < options_.tolerance) return ends(InversionStop::converged);
    constexpr double hardly = 0.05;  // gains of as little fit the noise
    if (options_.stops_at_noise && best.in_deviations <= 1.0 && decrease < hardly)
      return ends(InversionStop::at_noise);
    return must_end();
  }

  /// Says that the objective has become another function: gains count from here.
  void begin_again() {
    record();
    first_ = history.size() - 1;
    stop = InversionStop::converged;
  }

  /// Whether more can be spent.
  [[nodiscard]] bool goes_on() const {
    return stop == InversionStop::converged || stop == InversionStop::at_noise;
  }

  /// Whether somebody asks to stop.
  bool is_interrupted() {
    constexpr double of_sample = 21.0;  // forward equivalents of one for standard deviations
    const double all = options_.most_forwards + of_sample * options_.deviation_samples;
    share_ = std::clamp(light_.forwards() / all, share_, 1.0);
    return !report_progress(progress_, share_) && ends(InversionStop::interrupted);
  }

  /// Whether somebody asks to stop, or nothing is left to spend on `next` forward equivalents.
  bool must_end(double next = 1.0) {
    next *= light_.cost();
    if (is_interrupted()) return true;
    if (light_.forwards() + next > options_.most_forwards)
      return ends(InversionStop::most_forwards);
    return false;
  }

  bool ends(InversionStop why) {
    stop = why;
    return true;
  }

 private:
  void record() {
    history.push_back({light_.forwards(), best.residual, best.in_deviations, best.objective});
  }

  const InversionOptions& options_;
  const PatchLight& light_;
  const Progress& progress_;
  double share_ = 0.0;     ///< of all that is to be spent, which may grow
  std::size_t first_ = 0;  ///< step of the history that has this objective

 public:
  PatchState best;
  std::vector<InversionStep> history;
  InversionStop stop = InversionStop::converged;
};

/// Moves coordinates by a step times a factor, no further than their ranges.
[[nodiscard]] inline TexelMaps moved(const InversionTables& tables, TexelMaps coordinates,
                                     double factor, const TexelMaps& step) {
  add_times(coordinates, factor, step);
  for (std::size_t n = 0; n < coordinates.size(); ++n) {
    const FitParameter& parameter = tables.numbers[n].parameter;
    const auto low = static_cast<float>(fit_coordinate(parameter, parameter.low));
    const auto high = static_cast<float>(fit_coordinate(parameter, parameter.high));
    for (float& value : coordinates[n]) value = std::clamp(value, low, high);
  }
  return coordinates;
}

}  // namespace lamina::detail
