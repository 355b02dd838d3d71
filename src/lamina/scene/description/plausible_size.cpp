// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/plausible_size.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

// Translucent things of another size are rare: an eyelash, a house.
constexpr double smallest_plausible = 3.0, largest_plausible = 3000.0;  // [mm]

double longest_side(const Mesh& mesh) {
  if (mesh.positions.empty()) return 0.0;
  Vec3f low = mesh.positions.front(), high = low;
  for (const Vec3f& p : mesh.positions)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  const Vec3f d = high - low;
  return static_cast<double>(std::max({d.x, d.y, d.z}));
}

}  // namespace

std::string length_text(double mm) {
  return mm >= 1e4 ? printf_text("%.3g m", mm / 1e3) : printf_text("%.4g mm", mm);
}

std::optional<std::string> implausible_size(const std::string& name, double longest_mm,
                                            double mm_per_unit) {
  if (!(longest_mm > 0.0) || (longest_mm >= smallest_plausible && longest_mm <= largest_plausible))
    return std::nullopt;
  // The power of ten that makes it about as large as a head.
  const double factor = std::pow(10.0, std::round(std::log10(200.0 / longest_mm)));
  const std::string unit = mm_per_unit > 0.0 ? printf_text("%g", mm_per_unit * factor)
                                             : printf_text("%g times as large", factor);
  return name + " is " + length_text(longest_mm) +
         " long, and light spreads some mm in most materials; with mm_per_unit " + unit +
         " it would be " + length_text(longest_mm * factor);
}

std::vector<std::string> implausible_sizes(const Scene& scene) {
  std::vector<std::string> warnings;
  for (const Mesh& mesh : scene.meshes) {
    const bool is_translucent = std::ranges::any_of(mesh.material, [&](std::uint32_t m) {
      return std::holds_alternative<SubsurfaceSurface>(scene.materials[m].surface);
    });
    if (!is_translucent) continue;
    if (auto warning = implausible_size(mesh.name, longest_side(mesh), scene.mm_per_unit))
      warnings.push_back(std::move(*warning));
  }
  return warnings;
}

}  // namespace lamina
