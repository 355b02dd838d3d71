// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/doubtful_profile.h"

#include <cmath>
#include <cstddef>

#include "lamina/base/core/error.h"

namespace lamina {

void refuse_doubtful(std::span<const double> mean_errors, const std::string& way_out) {
  for (std::size_t band = 0; band < mean_errors.size(); ++band) {
    const double error = mean_errors[band];
    if (error <= 0.2) continue;
    const std::string how_wrong =
        error < 100.0 ? std::to_string(std::lround(100.0 * error)) + " %" : "many times";
    throw InvalidInput("band " + std::to_string(band) + ": the profile is wrong by " + how_wrong +
                       " on average, by its own estimate, and must be by less than 20 %; " +
                       way_out + " takes such layers");
  }
}

}  // namespace lamina
