// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/internal/jensen2001.h"

#include <array>
#include <string>

namespace lamina {
namespace {

struct Row {
  const char* name;
  const char* label;
  std::array<double, 3> sigma_s_prime;  // [1/mm]
  std::array<double, 3> sigma_a;        // [1/mm]
  double ior;
};

// [Jensen2001] Figure 5, all digits of the print; the index is its 1.3 for all but marble.
constexpr Row rows[] = {
    {"apple", "Apple", {2.29, 2.39, 1.97}, {0.0030, 0.0034, 0.046}, 1.3},
    {"chicken1", "Chicken, first sample", {0.15, 0.21, 0.38}, {0.015, 0.077, 0.19}, 1.3},
    {"chicken2", "Chicken, second sample", {0.19, 0.25, 0.32}, {0.018, 0.088, 0.20}, 1.3},
    {"cream", "Cream", {7.38, 5.47, 3.15}, {0.0002, 0.0028, 0.0163}, 1.3},
    {"ketchup", "Ketchup", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}, 1.3},
    {"marble", "Marble", {2.19, 2.62, 3.00}, {0.0021, 0.0041, 0.0071}, 1.5},
    {"potato", "Potato", {0.68, 0.70, 0.55}, {0.0024, 0.0090, 0.12}, 1.3},
    {"skimmilk", "Skim milk", {0.70, 1.22, 1.90}, {0.0014, 0.0025, 0.0142}, 1.3},
    {"skin1", "Human skin, first sample", {0.74, 0.88, 1.01}, {0.032, 0.17, 0.48}, 1.3},
    {"skin2", "Human skin, second sample", {1.09, 1.59, 1.79}, {0.013, 0.070, 0.145}, 1.3},
    {"spectralon", "Spectralon", {11.6, 20.4, 14.9}, {0.0, 0.0, 0.0}, 1.3},
    {"wholemilk", "Whole milk", {2.55, 3.21, 3.77}, {0.0011, 0.0024, 0.014}, 1.3},
};

}  // namespace

std::vector<Material> jensen2001_materials() {
  std::vector<Material> materials;
  for (const Row& row : rows) {
    const std::vector<double> ior(3, row.ior);
    MaterialLayer layer{.name = row.name,
                        .sigma_a = {row.sigma_a.begin(), row.sigma_a.end()},
                        .sigma_s = {row.sigma_s_prime.begin(), row.sigma_s_prime.end()},
                        .g = {0.0, 0.0, 0.0},
                        .ior = ior};
    Material& material = materials.emplace_back();
    material.name = std::string("jensen_") + row.name;
    material.source =
        std::string(row.label) + ": Jensen et al. 2001, Fig. 5; sigma_s is reduced, g 0";
    material.ior_above = {1.0, 1.0, 1.0};
    material.ior_below = ior;
    material.layers.push_back(std::move(layer));
  }
  return materials;
}

}  // namespace lamina
