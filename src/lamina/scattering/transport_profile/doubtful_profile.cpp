// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/transport_profile/doubtful_profile.h"

#include <fmt/core.h>

#include <cstddef>

#include "lamina/core/error.h"

namespace lamina {

void refuse_doubtful(std::span<const double> mean_errors, const std::string& way_out) {
  for (std::size_t band = 0; band < mean_errors.size(); ++band)
    if (!(mean_errors[band] <= 0.2))
      throw InvalidInput(
          fmt::format("band {}: the profile is wrong by {} on average, by its own estimate, and "
                      "must be by less than 20 %; {} takes such layers",
                      band,
                      mean_errors[band] < 100.0 ? fmt::format("{:.0f} %", 100.0 * mean_errors[band])
                                                : "many times",
                      way_out));
}

}  // namespace lamina
