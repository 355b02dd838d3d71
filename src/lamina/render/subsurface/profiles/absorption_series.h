// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/profile.h"

namespace lamina {

/// Layers with ever more absorption, and the factor on it at which a reflectance is met.
/// It reaches as far as reflectances are asked for.
///
/// Factors are half an octave apart. Between them ln(-ln R) follows a cubic in the logarithm of the
/// factor: -ln R of a thick layer grows as the root of little absorption and slower and slower, so
/// that its logarithm is close to a line, and R is met within 1e-4 (test).
class AbsorptionSeries {
 public:
  /// The reflectances that are asked for, [band].
  struct Wanted {
    std::vector<double> darkest, brightest;
  };
  /// The most and the least that thick layers are made to reflect; beyond, what reflects that is
  /// scaled.
  static constexpr double most = 0.995, least = 5e-4;

  /// @param stacks        [band]
  /// @param make_profile  from layers, [band]
  template <class MakeProfile>
  AbsorptionSeries(std::span<const LayerStack> stacks, const Wanted& wanted,
                   const MakeProfile& make_profile) {
    start(stacks);
    while (needs_brighter(wanted)) add_brighter(make_profile(next_brighter()));
    while (needs_darker(wanted)) add_darker(make_profile(next_darker()));
    finish();
  }

  [[nodiscard]] std::size_t size() const { return log_factors_.size(); }
  /// [node], from little absorption to much.
  [[nodiscard]] const std::vector<Profile>& profiles() const { return profiles_; }
  /// The layers of a node, [band].
  [[nodiscard]] std::vector<LayerStack> layers(std::size_t node) const;

  /// The factor on the absorption with which a band reflects as asked, see with_absorption. What no
  /// node reaches gets the factor of the last one.
  [[nodiscard]] double factor(double reflectance, std::size_t band) const;

 private:
  void start(std::span<const LayerStack> stacks);
  [[nodiscard]] bool needs_brighter(const Wanted& wanted) const;
  [[nodiscard]] bool needs_darker(const Wanted& wanted) const;
  [[nodiscard]] std::vector<LayerStack> next_brighter() const;
  [[nodiscard]] std::vector<LayerStack> next_darker() const;
  void add_brighter(Profile profile);
  void add_darker(Profile profile);
  [[nodiscard]] std::vector<LayerStack> with_log_factor(double log_factor) const;
  void finish();
  [[nodiscard]] double depth(std::size_t node, std::size_t band) const {
    return depths_[node * stacks_.size() + band];
  }

  std::vector<LayerStack> stacks_;   ///< [band]
  std::vector<double> log_factors_;  ///< [node]
  std::vector<Profile> profiles_;    ///< [node]
  std::vector<double> depths_;       ///< [node][band], ln(-ln R)
};

}  // namespace lamina
