// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/material_maps.h"

#include <algorithm>

namespace lamina {

std::vector<double> means_of(const MaterialMap& map) {
  const std::size_t channels = map.values.channel_count();
  std::vector<double> means(channels, 0.0);
  for (std::size_t i = 0; i < map.values.pixels.size(); ++i)
    means[i % channels] += static_cast<double>(map.values.pixels[i]);
  for (double& mean : means)
    mean = std::clamp(
        mean * static_cast<double>(channels) / static_cast<double>(map.values.pixels.size()),
        map.number.low, map.number.high);  // for sums are rounded, too
  return means;
}

}  // namespace lamina
