// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/profile/layer_response.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Epidermis over dermis of the colour of skin in green and in red.
struct Skin {
  MappedStack stack;
  std::vector<double> sigma_a;
};
const Skin green{{1.0, {{16.0, 0.77, 1.4, 0.25}, {8.0, 0.77, 1.38, infinite}}, 1.38}, {0.6, 0.25}};
const Skin red{{1.0, {{14.0, 0.8, 1.4, 0.25}, {7.0, 0.8, 1.38, infinite}}, 1.38}, {0.15, 0.02}};
// A fold of skin as in an ear, and one layer.
const Skin ear{{1.0, {{14.0, 0.8, 1.4, 0.25}, {7.0, 0.8, 1.38, 1.5}, {14.0, 0.8, 1.4, 0.25}}, 1.0},
               {0.15, 0.02, 0.2}};
const Skin slab{{1.0, {{14.0, 0.8, 1.4, 0.8}}, 1.2}, {0.1}};

GaussianTableGrid small_grid() {
  GaussianTableGrid grid;
  grid.rows = 64;
  return grid;
}

/// The layered multipole, sheets between the layers.
LayerResponse closed_form(const Skin& skin, double k, double absorbance = 0.0) {
  LayerResponse all;
  const auto& layers = skin.stack.layers;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const MappedLayer& at = layers[i];
    const double above = i == 0 ? skin.stack.ior_above : layers[i - 1].ior;
    const double below = i + 1 == layers.size() ? skin.stack.ior_below : layers[i + 1].ior;
    const auto inside = [&](double outside) {
      return diffuse_reflectance_inside({}, at.ior, outside, DiffuseFresnel::exact);
    };
    const Multipole layer = make_multipole({skin.sigma_a[i], at.sigma_s, at.g, at.ior},
                                           at.thickness, inside(above), inside(below));
    const double left = std::exp(-absorbance);
    if (i > 0) all = stacked(all, {0.0, left, 0.0, left});
    all = stacked(all, response(layer, k));
  }
  return all;
}

std::vector<Plane> planes(const Skin& skin, int size) {
  std::vector<Plane> maps;
  for (const double value : skin.sigma_a)
    maps.push_back(make_plane(size, size, static_cast<float>(value)));
  return maps;
}

std::vector<Plane> sheets(const Skin& skin, int size, double absorbance) {
  return std::vector<Plane>(skin.sigma_a.size() - 1,
                            make_plane(size, size, static_cast<float>(absorbance)));
}

/// Maps that vary smoothly and by factors of up to 4.
std::vector<Plane> varied_maps(const Skin& skin, int size) {
  std::vector<Plane> maps = planes(skin, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto i = static_cast<std::size_t>(y * size + x);
      maps[0].values[i] *= std::exp(static_cast<float>(std::sin(0.3 * x + 0.1 * y)));
      maps[1].values[i] *= std::exp(0.7f * static_cast<float>(std::cos(0.1 * x - 0.2 * y)));
    }
  return maps;
}

TEST(HeterogeneousTransport, UniformMapsGiveTheClosedFormOfTheLayers) {
  for (const Skin* skin : {&green, &red, &ear, &slab}) {
    const StackTables tables = make_stack_tables(skin->stack, OperatorTotals::diffusion);
    const double absorbance = 0.05;
    for (const int bounces : {1, 2, 4}) {
      const auto layers =
          make_heterogeneous_layers(tables, planes(*skin, 40), sheets(*skin, 40, absorbance), 0.05);
      const TransportResult result =
          transport(layers, make_plane(40, 40, 1.0f), {.interlayer_bounces = bounces});
      const LayerResponse wanted = closed_form(*skin, 0.0, absorbance);
      for (const float value : result.reflected.values)
        ASSERT_NEAR(value, wanted.reflection_above, 2e-4) << bounces << " bounces";
      for (const float value : result.transmitted.values)
        ASSERT_NEAR(value, wanted.transmission_down, 2e-4) << bounces << " bounces";
    }
  }
}

// Folds of skin so thick and dark that next to nothing comes back from their far side.
TEST(HeterogeneousTransport, FoldsTransmitWhatRadiativeTransferSays) {
  const Skin fold{
      {1.0, {{38.0, 0.8, 1.4, 0.25}, {19.0, 0.8, 1.38, 2.5}, {38.0, 0.8, 1.4, 0.25}}, 1.0},
      {0.6, 0.25, 0.6}};
  const StackTables tables =
      make_stack_tables(fold.stack, OperatorTotals::radiative_transfer, fold.sigma_a, small_grid());
  for (const double epidermis : {0.3, 0.6, 1.5}) {
    Skin at = fold;
    at.sigma_a = {epidermis, 0.25, epidermis};
    std::vector<Layer> layers;
    for (std::size_t i = 0; i < 3; ++i) {
      const MappedLayer& layer = at.stack.layers[i];
      layers.push_back({.medium = {at.sigma_a[i], layer.sigma_s, layer.g, layer.ior},
                        .thickness = layer.thickness});
    }
    const SlabTotals wanted = adding_doubling(LayerStack(layers)).totals;
    const float entering = static_cast<float>(1.0 - wanted.specular_reflectance);
    const TransportResult light =
        transport(make_heterogeneous_layers(tables, planes(at, 16), sheets(at, 16, 0.0), 0.1),
                  make_plane(16, 16, entering));
    EXPECT_NEAR(light.transmitted.values[0], wanted.transmittance, 0.03 * wanted.transmittance)
        << epidermis;
    EXPECT_NEAR(light.reflected.values[0], wanted.diffuse_reflectance,
                0.02 * wanted.diffuse_reflectance)
        << epidermis;
  }
}

// What leaves is the part that is lit times what leaves in full light, on either side of the middle
// alike: mirrors at the ends take nothing, whatever the number of texels.
TEST(HeterogeneousTransport, NoLightIsLostAtTheEndsOfPlanesOfAnySize) {
  const StackTables tables =
      make_stack_tables(red.stack, OperatorTotals::diffusion, {}, small_grid());
  for (int size = 31; size <= 65; ++size) {
    const auto layers =
        make_heterogeneous_layers(tables, planes(red, size), sheets(red, size, 0.0), 6.0 / size);
    Plane light = make_plane(size, size);
    const int begin = size * 3 / 8, end = size - begin;
    for (int y = begin; y < end; ++y)
      for (int x = begin; x < end; ++x) light.values[static_cast<std::size_t>(y * size + x)] = 1.0f;
    const Plane seen = transport(layers, light).reflected;
    const Plane full = transport(layers, make_plane(size, size, 1.0f)).reflected;
    double all = 0.0, left = 0.0, right = 0.0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double value = seen.values[static_cast<std::size_t>(y * size + x)];
        all += value;
        if (2 * x + 1 < size) left += value;
        if (2 * x + 1 > size) right += value;
      }
    const double lit = (end - begin) * (end - begin);
    EXPECT_NEAR(all, lit * static_cast<double>(full.values[0]), 1e-4 * all) << size;
    EXPECT_NEAR(left, right, 1e-5 * all) << size;
  }
}

// Stripes of light keep their shape; their contrast falls as the closed form says.
TEST(HeterogeneousTransport, StripesComeOutWithTheContrastOfTheClosedForm) {
  constexpr int size = 128;
  constexpr double h = 0.04;
  for (const Skin* skin : {&green, &red, &ear}) {
    const StackTables tables =
        make_stack_tables(skin->stack, OperatorTotals::diffusion, {}, small_grid());
    const auto layers =
        make_heterogeneous_layers(tables, planes(*skin, size), sheets(*skin, size, 0.0), h);
    for (const int waves : {1, 2, 4, 8, 16, 32}) {
      const double phase = std::numbers::pi * waves / size;  // cosines fit into the mirrors
      Plane light = make_plane(size, size);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
          light.values[static_cast<std::size_t>(y * size + x)] =
              static_cast<float>(std::cos(phase * (x + 0.5)));
      const TransportResult result = transport(layers, light, {.interlayer_bounces = 12});
      const double k = phase / h;
      const LayerResponse wanted = closed_form(*skin, k), whole = closed_form(*skin, 0.0);
      double along = 0.0, across = 0.0;
      for (std::size_t i = 0; i < light.values.size(); ++i) {
        along += light.values[i] * result.reflected.values[i];
        across += light.values[i] * result.transmitted.values[i];
      }
      const double norm = 0.5 * size * size;
      EXPECT_NEAR(along / norm, wanted.reflection_above, 3e-3 * whole.reflection_above)
          << waves << " half waves";
      EXPECT_NEAR(across / norm, wanted.transmission_down, 3e-3) << waves << " half waves";
    }
  }
}

TEST(HeterogeneousTransport, ClosesTheSeriesLocally) {
  constexpr int size = 64;
  const Plane light = make_plane(size, size, 1.0f);
  for (const Skin* skin : {&red, &ear}) {
    const StackTables tables =
        make_stack_tables(skin->stack, OperatorTotals::diffusion, {}, small_grid());
    const auto layers =
        make_heterogeneous_layers(tables, varied_maps(*skin, size), sheets(*skin, size, 0.02), 0.1);
    const TransportResult far = transport(layers, light, {.interlayer_bounces = 12});
    const auto difference = [](const Plane& near, const Plane& wanted) {
      double sum = 0.0, all = 0.0;
      for (std::size_t i = 0; i < wanted.values.size(); ++i) {
        sum += std::pow(near.values[i] - wanted.values[i], 2);
        all += std::pow(wanted.values[i], 2);
      }
      return all > 0.0 ? std::sqrt(sum / all) : 0.0;
    };
    const auto check = [&](int bounces, double reflected, double transmitted) {
      const TransportResult near = transport(layers, light, {.interlayer_bounces = bounces});
      EXPECT_LT(difference(near.reflected, far.reflected), reflected) << bounces << " bounces";
      EXPECT_LT(difference(near.transmitted, far.transmitted), transmitted)
          << bounces << " bounces";
    };
    check(1, 0.01, 0.05);
    check(2, 0.005, 0.015);
    check(4, 0.0005, 0.0015);
    const auto open =
        transport(layers, light, {.interlayer_bounces = 2, .has_local_closure = false});
    EXPECT_GT(difference(open.reflected, far.reflected), 0.02);
    const TransportResult kept =
        transport(layers, light,
                  {.interlayer_bounces = 0, .has_local_closure = false, .energy_threshold = 0.99});
    EXPECT_LT(kept.last_bounce, 0.01);
    EXPECT_GT(kept.interlayer_bounces, 2);
  }
}

TEST(HeterogeneousTransport, IsLinearInTheLight) {
  constexpr int size = 48;
  const StackTables tables =
      make_stack_tables(green.stack, OperatorTotals::diffusion, {}, small_grid());
  const auto layers =
      make_heterogeneous_layers(tables, varied_maps(green, size), sheets(green, size, 0.1), 0.1);
  std::mt19937 random(1);
  Plane a = make_plane(size, size), b = a, sum = a;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    a.values[i] = std::uniform_real_distribution<float>()(random);
    b.values[i] = std::uniform_real_distribution<float>()(random);
    sum.values[i] = a.values[i] + 2.0f * b.values[i];
  }
  const auto of_a = transport(layers, a).reflected, of_b = transport(layers, b).reflected;
  const auto of_sum = transport(layers, sum).reflected;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    ASSERT_NEAR(of_sum.values[i], of_a.values[i] + 2.0f * of_b.values[i], 2e-6);
}

// The profile is that of the exit point: where the epidermis is alike, a blot elsewhere does not
// change R1+, and light that goes deeper feels it within millimetres.
TEST(HeterogeneousTransport, DarkSpotDarkensItsSurroundings) {
  constexpr int size = 64;
  const StackTables tables =
      make_stack_tables(red.stack, OperatorTotals::diffusion, {}, small_grid());
  std::vector<Plane> maps = planes(red, size);
  for (int y = 28; y < 36; ++y)
    for (int x = 28; x < 36; ++x) maps[0].values[static_cast<std::size_t>(y * size + x)] = 4.0f;
  const auto layers = make_heterogeneous_layers(tables, maps, sheets(red, size, 0.0), 0.1);
  const Plane seen = transport(layers, make_plane(size, size, 1.0f)).reflected;
  const auto at = [&](int x) { return seen.values[static_cast<std::size_t>(32 * size + x)]; };
  EXPECT_LT(at(32), 0.4f * at(2));
  EXPECT_LT(at(26), 0.97f * at(2));
  EXPECT_GT(at(26), at(32));
  EXPECT_GT(at(20), at(26));
}

// Adding-doubling of the whole stack knows nothing of operators.
TEST(HeterogeneousTransport, TransferTotalsMakeUniformSkinExact) {
  const std::vector<double> reference = {0.6, 0.25};
  const StackTables tables =
      make_stack_tables(green.stack, OperatorTotals::radiative_transfer, reference, small_grid());
  const auto exact = [&](double epidermis, double dermis) {
    const auto layer = [](const MappedLayer& from, double sigma_a) {
      return Layer{
          .medium = {.sigma_a = sigma_a, .sigma_s = from.sigma_s, .g = from.g, .ior = from.ior},
          .thickness = from.thickness};
    };
    const LayerStack stack(
        {layer(green.stack.layers[0], epidermis), layer(green.stack.layers[1], dermis)}, 1.0, 1.38);
    const SlabTotals totals = adding_doubling(stack).totals;
    return totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
  };
  const auto ours = [&](double epidermis, double dermis) {
    const std::vector<Plane> maps = {make_plane(8, 8, static_cast<float>(epidermis)),
                                     make_plane(8, 8, static_cast<float>(dermis))};
    const auto layers = make_heterogeneous_layers(tables, maps, sheets(green, 8, 0.0), 0.1);
    return static_cast<double>(transport(layers, make_plane(8, 8, 1.0f)).reflected.values[0]);
  };
  for (const double dermis : {0.05, 0.25, 1.0})
    EXPECT_NEAR(ours(0.6, dermis), exact(0.6, dermis), 1e-4);
  for (const double epidermis : {0.2, 2.0, 8.0})  // away from the reference
    EXPECT_NEAR(ours(epidermis, 0.25) / exact(epidermis, 0.25), 1.0, 0.015) << epidermis;
}

}  // namespace
}  // namespace lamina
