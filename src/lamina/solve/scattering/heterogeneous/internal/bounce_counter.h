// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

namespace lamina::detail {

/// Says when the series of bounces ends.
class BounceCounter {
 public:
  explicit BounceCounter(const TransportOptions& options) : options_(options) {}

  /// @param down  the light that goes down through the first junction, summed over texels
  [[nodiscard]] bool is_last(double down) {
    constexpr int most_bounces = 100;
    ++bounces_;
    all_ += down;
    last_part_ = all_ > 0.0 ? down / all_ : 0.0;
    return options_.interlayer_bounces > 0
               ? bounces_ >= options_.interlayer_bounces
               : last_part_ < 1.0 - options_.energy_threshold || bounces_ >= most_bounces;
  }

  [[nodiscard]] int bounces() const { return bounces_; }
  [[nodiscard]] double last_part() const { return last_part_; }

 private:
  TransportOptions options_;
  int bounces_ = 0;
  double all_ = 0.0, last_part_ = 0.0;
};

}  // namespace lamina::detail
