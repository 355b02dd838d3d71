// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <span>

#include "lamina/base/io/file_bytes.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/heterogeneous/internal/operator_powers.h"
#include "lamina/solve/scattering/heterogeneous/mapped_operator.h"
#include "lamina/solve/scattering/profile/layer_response.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

MappedStack skin(double sigma_s_prime, double g) {
  const double sigma_s = sigma_s_prime / (1.0 - g);
  return {.ior_above = 1.0,
          .layers = {{sigma_s, g, 1.4, 0.25}, {0.5 * sigma_s, g, 1.38, infinite}},
          .ior_below = 1.38};
}

double transform(const StackTables& tables, const std::vector<double>& weights, double k) {
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    sum += weights[i] * std::exp(-0.5 * k * k * tables.variances[i]);
  return sum;
}

double mean_reflectance(double inside, double outside) {
  return diffuse_reflectance_inside({}, inside, outside, DiffuseFresnel::exact);
}

// From blue to red: scattering as measured skin has it and as printed.
TEST(GaussianTables, FollowTheClosedFormOfTheMultipole) {
  for (const double sigma_s_prime : {12.5, 7.1, 4.0, 2.7}) {
    const MappedStack stack = skin(sigma_s_prime, 0.8);
    const StackTables tables = make_stack_tables(stack, OperatorTotals::diffusion);
    for (const double sigma_a : {0.01, 0.1, 0.7, 3.0, 30.0})
      for (std::size_t i = 0; i < 2; ++i) {
        const MappedLayer& layer = stack.layers[i];
        const Multipole multipole = make_multipole(
            {sigma_a, layer.sigma_s, layer.g, layer.ior}, layer.thickness,
            mean_reflectance(layer.ior, i == 0 ? 1.0 : 1.4), mean_reflectance(layer.ior, 1.38));
        const LayerResponse all = response(multipole, 0.0);
        for (const double k : {0.0, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0}) {
          const LayerResponse wanted = response(multipole, k);
          const auto at = [&](const GaussianTable& table) {
            return transform(tables, weights_at(tables, table, sigma_a), k);
          };
          const LayerTables& t = tables.layers[i];
          // Between rows transmittances of 1e-7 are off by 2e-3 of themselves.
          const auto allowed = [](double total) { return 5e-4 * total + 1e-9; };
          EXPECT_NEAR(at(t.reflection_above), wanted.reflection_above,
                      allowed(all.reflection_above));
          if (i == 1) continue;
          EXPECT_NEAR(at(t.transmission_down), wanted.transmission_down,
                      allowed(all.transmission_down));
          EXPECT_NEAR(at(t.reflection_below), wanted.reflection_below,
                      allowed(all.reflection_below));
          EXPECT_NEAR(at(t.transmission_up), wanted.transmission_up, allowed(all.transmission_up));
        }
      }
  }
}

// Transmittances are worst where the layer is about as thick as its source is deep: light from a
// source next to the far side leaves as a narrow peak.
TEST(GaussianTables, ReportErrorsBelowAThousandth) {
  for (const double sigma_s_prime : {12.5, 5.0, 3.9, 2.7, 2.0}) {
    const StackTables tables =
        make_stack_tables(skin(sigma_s_prime, 0.8), OperatorTotals::diffusion);
    const auto largest = [&](const GaussianTable& table) {
      double error = 0.0;
      for (std::size_t row = 0; row < tables.grid.rows; ++row) {
        const double sigma_a =
            tables.grid.lowest *
            std::pow(tables.grid.highest / tables.grid.lowest,
                     static_cast<double>(row) / static_cast<double>(tables.grid.rows - 1));
        if (0.01 <= sigma_a && sigma_a <= 30.0) error = std::max(error, table.error[row]);
      }
      return error;
    };
    const auto& [reflection_above, transmission_down, reflection_below, transmission_up] =
        tables.layers[0];
    EXPECT_LT(largest(reflection_above), 1e-4) << sigma_s_prime;
    EXPECT_GT(largest(reflection_above), 1e-6) << sigma_s_prime;
    EXPECT_LT(largest(transmission_down), 4e-4) << sigma_s_prime;
    EXPECT_LT(largest(reflection_below), 1e-4) << sigma_s_prime;
    EXPECT_LT(largest(transmission_up), 4e-4) << sigma_s_prime;
    EXPECT_LT(largest(tables.layers[1].reflection_above), 1e-4) << sigma_s_prime;
  }
}

TEST(GaussianTables, ExactTotalsAreThoseOfAddingDoubling) {
  const MappedStack stack = skin(5.0, 0.77);
  const std::vector<double> reference = {0.5, 0.2};
  const StackTables tables =
      make_stack_tables(stack, OperatorTotals::radiative_transfer, reference);
  for (const double sigma_a : {0.01, 0.3, 2.0, 10.0}) {
    const MappedLayer& layer = stack.layers[0];
    const Layer solid{.medium = {sigma_a, layer.sigma_s, layer.g, layer.ior},
                      .thickness = layer.thickness};
    const SlabTotals above = adding_doubling(LayerStack({solid}, 1.0, 1.38)).totals;
    const SlabTotals below =
        adding_doubling(LayerStack({solid}, 1.38, 1.0), {.is_diffuse = true}).totals;
    const auto total = [&](const GaussianTable& table) {
      const std::vector<double> weights = weights_at(tables, table, sigma_a);
      return std::accumulate(weights.begin(), weights.end(), 0.0);
    };
    const double entered = 1.0 - above.specular_reflectance;
    const LayerTables& t = tables.layers[0];
    EXPECT_NEAR(total(t.reflection_above), above.diffuse_reflectance / entered, 1e-4);
    EXPECT_NEAR(total(t.transmission_down), above.transmittance / entered, 1e-4);
    EXPECT_NEAR(total(t.reflection_below), below.diffuse_reflectance + below.specular_reflectance,
                1e-4);
    EXPECT_NEAR(total(t.transmission_up), below.transmittance, 1e-4);
  }
}

// Radiative transfer of the whole stack, solved anew, at absorptions and frequencies in between.
TEST(GaussianTables, TransferProfilesAreThoseOfTheWholeStack) {
  const MappedStack stack = skin(4.7, 0.75);
  const double dermis = 0.1;
  GaussianTableGrid grid;
  grid.rows = 128;
  const StackTables tables = make_stack_tables(stack, OperatorTotals::radiative_transfer_profile,
                                               std::vector<double>{0.7, dermis}, grid);
  for (const double sigma_a : {0.3, 2.2}) {
    const auto solid = [](const MappedLayer& layer, double absorption) {
      return Layer{.medium = {absorption, layer.sigma_s, layer.g, layer.ior},
                   .thickness = layer.thickness};
    };
    const std::vector<LayerStack> stacks = {
        LayerStack({solid(stack.layers[0], sigma_a), solid(stack.layers[1], dermis)}, 1.0, 1.38)};
    const std::vector<double> k = {0.0, 0.3, 1.3, 5.0, 13.0, 32.0, 90.0};
    const auto exact = spatial_frequency_response(stacks, k, {.accuracy = 0.02}).reflectance;
    for (std::size_t j = 0; j < k.size(); ++j) {
      const auto at = [&](const GaussianTable& table, double absorption) {
        return transform(tables, weights_at(tables, table, absorption), k[j]);
      };
      const LayerTables& top = tables.layers[0];
      const LayerResponse upper{
          at(top.reflection_above, sigma_a), at(top.transmission_down, sigma_a),
          at(top.reflection_below, sigma_a), at(top.transmission_up, sigma_a)};
      const LayerResponse lower{at(tables.layers[1].reflection_above, dermis), 0.0, 0.0, 0.0};
      const double entered = 1.0 - fresnel(1.0, 1.4);
      const double ours = entered * stacked(upper, lower).reflection_above;
      EXPECT_NEAR(ours, exact[j], 0.015 * exact[0]) << "k " << k[j] << ", sigma_a " << sigma_a;
      if (k[j] > 24.0) {
        EXPECT_NEAR(ours, exact[j], 0.04 * exact[j]) << "k " << k[j];
      }
    }
  }
}

TEST(GaussianTables, AreKeptInACacheAndTheSameFromIt) {
  namespace fs = std::filesystem;
  const auto folder = fs::temp_directory_path() / "lamina_gaussian_tables_test";
  fs::remove_all(folder);
  const DiskCache cache{.folder = folder};
  GaussianTableGrid grid;
  grid.rows = 16;
  const MappedStack stack = skin(5.0, 0.77);
  const StackTables made = make_stack_tables(stack, OperatorTotals::diffusion, {}, grid);
  for (int time = 0; time < 2; ++time) {
    const StackTables kept = cached_stack_tables(cache, stack, OperatorTotals::diffusion, {}, grid);
    EXPECT_EQ(kept.variances, made.variances);
    ASSERT_EQ(kept.layers.size(), made.layers.size());
    EXPECT_EQ(kept.layers[0].transmission_up.weights, made.layers[0].transmission_up.weights);
    EXPECT_EQ(kept.layers[1].reflection_above.error, made.layers[1].reflection_above.error);
  }
  // Damage anywhere is seen, and the tables are worked out again.
  const fs::path file = fs::directory_iterator(folder)->path();
  const std::string whole = read_file_bytes(file);
  for (std::size_t at = 3; at < whole.size(); at += whole.size() / 12) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
    write_file_bytes(file, std::as_bytes(std::span(damaged)));
    const StackTables kept = cached_stack_tables(cache, stack, OperatorTotals::diffusion, {}, grid);
    EXPECT_EQ(kept.layers[0].transmission_up.weights, made.layers[0].transmission_up.weights) << at;
    EXPECT_TRUE(read_file_bytes(file) == whole) << at;
  }
  grid.rows = 17;  // another key
  EXPECT_EQ(cached_stack_tables(cache, stack, OperatorTotals::diffusion, {}, grid)
                .layers[0]
                .reflection_above.error.size(),
            17u);
  fs::remove_all(folder);
}

/// A table's operator over a range of absorptions, its weights as polynomials of the coordinate.
MappedOperator operator_over(const StackTables& tables, const GaussianTable& table,
                             const AbsorptionRange& range, std::span<const double> scales) {
  const double low = std::sqrt(range.lowest), high = std::sqrt(range.highest);
  const auto weights_of = [&](double x) {
    const double root = 0.5 * (low + high) + 0.5 * (high - low) * x;
    return weights_at(tables, table, root * root);
  };
  return detail::fit_powers(weights_of, tables.variances, scales, 5e-5);
}

TEST(MappedOperator, PolynomialsFollowTheTable) {
  const StackTables tables = make_stack_tables(skin(5.0, 0.77), OperatorTotals::diffusion);
  const BlurPyramid pyramid = make_blur_pyramid(128, 128, 1000.0);
  std::vector<double> in_texels = tables.variances;
  for (double& v : in_texels) v /= 0.05 * 0.05;
  const std::vector<double> scales = scales_of_gaussians(pyramid, in_texels);
  const GaussianTable& table = tables.layers[0].transmission_down;
  std::size_t powers = 0;
  for (const double ratio : {1.0, 3.0, 100.0, 3000.0}) {
    const AbsorptionRange range{0.02, 0.02 * ratio};
    const MappedOperator mapped = operator_over(tables, table, range, scales);
    EXPECT_GT(mapped.terms, powers);  // the wider the range, the more powers
    powers = mapped.terms;
    Plane sigma_a = make_plane(9, 1);
    for (int i = 0; i < 9; ++i)
      sigma_a.values[static_cast<std::size_t>(i)] =
          static_cast<float>(0.02 * std::pow(ratio, i / 8.0));
    const Plane coordinate = absorption_coordinate(sigma_a, range);
    for (std::size_t i = 0; i < 9; ++i) {
      double total = 0.0;
      for (std::size_t p = mapped.terms; p-- > 0;)
        total = total * coordinate.values[i] + mapped.totals[p];
      const std::vector<double> weights = weights_at(tables, table, sigma_a.values[i]);
      EXPECT_NEAR(total, std::accumulate(weights.begin(), weights.end(), 0.0), 1e-4);
    }
  }
}

}  // namespace
}  // namespace lamina
