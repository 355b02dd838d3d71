// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Colors of half-spaces by adding-doubling, as the table that lamina ships: prints
// src/lamina/solve/albedo_inversion/internal/color_table_data.cpp. Four CPU-minutes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/albedo_inversion/internal/color_table.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_on_grid.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace {

using namespace lamina;
using namespace lamina::detail;

constexpr int nodes = 48;             // of the grid of directions
constexpr std::size_t s_points = 16;  // more than the orders that are kept
constexpr double least_order = 1e-5;  // smaller ones are left out at the end of a row
constexpr std::size_t distributions = 2, lights = 2;

/// Where Chebyshev polynomials of `count` orders are extreme, from 1 to -1: with both ends.
double extreme_point(std::size_t i, std::size_t count) {
  return std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(count - 1));
}

double zero_point(std::size_t i, std::size_t count) {
  return std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(count));
}

/// Orders from values at the points, [order][point].
std::vector<double> transform(std::size_t count, bool at_extremes) {
  std::vector<double> matrix;
  const auto is_end = [&](std::size_t k) { return k == 0 || k == count - 1; };
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = std::numbers::pi * static_cast<double>(k);
      if (at_extremes)
        matrix.push_back(2.0 / static_cast<double>(count - 1) * (is_end(i) ? 0.5 : 1.0) *
                         (is_end(k) ? 0.5 : 1.0) *
                         std::cos(angle * static_cast<double>(i) / static_cast<double>(count - 1)));
      else
        matrix.push_back(
            (k == 0 ? 1.0 : 2.0) / static_cast<double>(count) *
            std::cos(angle * (static_cast<double>(i) + 0.5) / static_cast<double>(count)));
    }
  return matrix;
}

/// A matrix times each line of values along a dimension, whose elements lie `stride` apart.
void transform_along(std::vector<double>& values, std::size_t count, std::size_t stride,
                     bool at_extremes) {
  const std::vector<double> matrix = transform(count, at_extremes);
  std::vector<double> line(count);
  for (std::size_t block = 0; block < values.size(); block += count * stride)
    for (std::size_t offset = 0; offset < stride; ++offset) {
      double* const first = &values[block + offset];
      for (std::size_t i = 0; i < count; ++i) line[i] = first[i * stride];
      for (std::size_t k = 0; k < count; ++k) {
        double sum = 0.0;
        for (std::size_t i = 0; i < count; ++i) sum += matrix[k * count + i] * line[i];
        first[k * stride] = sum;
      }
    }
}

double s_at(std::size_t i) { return 0.5 + 0.5 * zero_point(i, s_points); }
double g_at(std::size_t i) { return 0.325 + 0.625 * extreme_point(i, g_orders); }
double roughness_at(std::size_t i) {
  const double x = 0.5 + 0.5 * extreme_point(i, roughness_orders);
  return i + 1 < roughness_orders ? x * std::sqrt(x) : 0.0;
}
double ior_at(std::size_t i) {
  if (i + 1 == ior_orders) return 1.0;
  const double highest = std::sqrt(1.0 - 1.0 / (1.6 * 1.6));
  const double cosine = highest * (0.5 + 0.5 * extreme_point(i, ior_orders));
  return 1.0 / std::sqrt(1.0 - cosine * cosine);
}

/// At the points of the table.
struct Samples {
  /// [distribution][light][roughness][ior][g][s]
  std::vector<double> q = std::vector<double>(distributions * lights * roughness_orders *
                                              ior_orders * g_orders * s_points);
  /// [distribution][light][roughness][ior]
  std::vector<double> reflection =
      std::vector<double>(distributions * lights * roughness_orders * ior_orders);

  [[nodiscard]] static std::size_t surface(std::size_t distribution, std::size_t light,
                                           std::size_t roughness, std::size_t ior) {
    return ((distribution * lights + light) * roughness_orders + roughness) * ior_orders + ior;
  }
  [[nodiscard]] double* q_of(std::size_t surface) { return &q[surface * g_orders * s_points]; }
};

LayerStack half_space(double ior, double g, double albedo, const Interface& top) {
  return LayerStack(
      {{.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = g, .ior = ior}, .top = top}},
      1.0, ior);
}

GridStack on_grid(const LayerStack& stack) {
  const Incidence beam;
  return make_grid_stack(stack, nodes, beams_of(stack, {&beam, 1}));
}

/// What scatters below the surface, [g][s]: the same for every surface of an index.
std::vector<LayerOperators> media_of(double ior) {
  std::vector<LayerOperators> media;
  for (std::size_t k = 0; k < g_orders; ++k)
    for (std::size_t j = 0; j < s_points; ++j) {
      const double s2 = s_at(j) * s_at(j), g = g_at(k);
      const double albedo = (1.0 - s2) / (1.0 - g * s2);
      media.push_back(layer_operators(on_grid(half_space(ior, g, albedo, {})).layers[0], 0));
    }
  return media;
}

void sample_surface(const std::vector<LayerOperators>& media, std::size_t distribution,
                    std::size_t roughness, std::size_t ior, Samples& samples) {
  const Interface top{roughness_at(roughness), distribution == 0 ? MicrofacetDistribution::beckmann
                                                                 : MicrofacetDistribution::ggx};
  const GridStack stack = on_grid(half_space(ior_at(ior), 0.0, 0.5, top));
  const RoughBoundaries rough = rough_boundaries(stack, 0, 1).front();
  for (std::size_t m = 0; m < media.size(); ++m) {
    const StackOperators operators = stack_operators(stack, 0, rough, {&media[m], 1});
    for (std::size_t light = 0; light < lights; ++light) {
      const SlabTotals totals =
          totals_of(stack, operators,
                    light == 0 ? incident_state(stack, 0) : incident_state(stack, std::nullopt))
              .totals;
      const std::size_t surface = Samples::surface(distribution, light, roughness, ior);
      const double share = totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
      const double s = s_at(m % s_points);
      samples.q_of(surface)[m] = std::log(share / (1.0 - s)) / s;
      samples.reflection[surface] = totals.specular_reflectance;
    }
  }
}

/// Near matched indices grids of directions do not resolve how little facets refract, and the
/// more the rougher they are. There the difference that roughness makes is in proportion to
/// ior - 1: it is taken from the point before.
void bridge_to_matched(std::size_t distribution, std::size_t ior, double least_roughness,
                       Samples& samples) {
  const double share = (ior_at(ior) - 1.0) / (ior_at(ior - 1) - 1.0);
  const std::size_t smooth = roughness_orders - 1;
  for (std::size_t light = 0; light < lights; ++light)
    for (std::size_t r = 0; r < roughness_orders; ++r) {
      if (roughness_at(r) <= least_roughness) continue;
      const auto place = [&](std::size_t roughness, std::size_t at) {
        return Samples::surface(distribution, light, roughness, at);
      };
      const auto bridge = [&](double smooth_here, double rough_before, double smooth_before) {
        return smooth_here + share * (rough_before - smooth_before);
      };
      for (std::size_t m = 0; m < g_orders * s_points; ++m)
        samples.q_of(place(r, ior))[m] =
            bridge(samples.q_of(place(smooth, ior))[m], samples.q_of(place(r, ior - 1))[m],
                   samples.q_of(place(smooth, ior - 1))[m]);
      samples.reflection[place(r, ior)] =
          bridge(samples.reflection[place(smooth, ior)], samples.reflection[place(r, ior - 1)],
                 samples.reflection[place(smooth, ior - 1)]);
    }
}

Samples sample_all() {
  Samples samples;
  const auto sample_ior = [&](std::size_t ior) {
    const std::vector<LayerOperators> media = media_of(ior_at(ior));
    for (std::size_t d = 0; d < distributions; ++d)
      for (std::size_t r = 0; r < roughness_orders; ++r) sample_surface(media, d, r, ior, samples);
  };
  parallel_for(ior_orders, sample_ior);
  for (std::size_t d = 0; d < distributions; ++d) {
    bridge_to_matched(d, ior_orders - 3, 0.17, samples);
    bridge_to_matched(d, ior_orders - 2, 0.0, samples);
  }
  return samples;
}

int whole(double value, double unit) { return static_cast<int>(std::lround(value / unit)); }

void print_numbers(const char* name, const std::vector<int>& numbers) {
  std::printf("constexpr std::int32_t %s[] = {\n", name);
  std::string line = " ";
  for (const int number : numbers) {
    const std::string text = " " + std::to_string(number) + ",";
    if (line.size() + text.size() > 100) {
      std::printf("%s\n", line.c_str());
      line = " ";
    }
    line += text;
  }
  std::printf("%s};\n", line.c_str());
}

}  // namespace

int main() {
  Samples samples = sample_all();
  std::size_t stride = 1;
  transform_along(samples.q, s_points, stride, false);
  transform_along(samples.q, g_orders, stride *= s_points, true);
  transform_along(samples.q, ior_orders, stride *= g_orders, true);
  transform_along(samples.q, roughness_orders, stride * ior_orders, true);
  transform_along(samples.reflection, ior_orders, 1, true);
  transform_along(samples.reflection, roughness_orders, ior_orders, true);

  std::vector<int> rows, reflection;
  for (std::size_t row = 0; row < samples.q.size(); row += s_points) {
    std::size_t size = s_orders;
    while (size > 0 &&
           std::abs(whole(samples.q[row + size - 1], color_table_unit)) * color_table_unit <
               least_order)
      --size;
    rows.push_back(static_cast<int>(size));
    for (std::size_t k = 0; k < size; ++k)
      rows.push_back(whole(samples.q[row + k], color_table_unit));
  }
  for (const double value : samples.reflection)
    reflection.push_back(whole(value, first_reflection_unit));

  std::printf(
      "// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0\n"
      "// Written by tools/fit/half_space_colors.\n"
      "#include \"lamina/solve/albedo_inversion/internal/color_table.h\"\n\n"
      "namespace lamina::detail {\nnamespace {\n\n// clang-format off\n");
  print_numbers("color_rows", rows);
  std::printf("\n");
  print_numbers("reflection_rows", reflection);
  std::printf(
      "// clang-format on\n\n}  // namespace\n\n"
      "const std::span<const std::int32_t> color_table_rows = color_rows;\n"
      "const std::span<const std::int32_t> first_reflection_rows = reflection_rows;\n\n"
      "}  // namespace lamina::detail\n");
}
