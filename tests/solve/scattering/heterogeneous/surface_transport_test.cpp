// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/surface_transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
const MappedStack green_stack{1.0, {{16.0, 0.77, 1.4, 0.25}, {8.0, 0.77, 1.38, infinite}}, 1.38};

GaussianTableGrid small_grid() {
  GaussianTableGrid grid;
  grid.rows = 64;
  return grid;
}

/// A flat sheet of squares, cut in two charts along its middle, the right one turned upside down
/// in its own grid.
struct Sheet {
  std::vector<GraphCell> cells;
  std::vector<CellLink> links;
};
Sheet cut_sheet(int size, float h) {
  Sheet sheet;
  const auto index = [&](int x, int y) { return static_cast<std::uint32_t>(y * size + x); };
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const bool is_right = x >= size / 2;
      const Vec3f position{h * (static_cast<float>(x) + 0.5f), h * (static_cast<float>(y) + 0.5f),
                           0.0f};
      sheet.cells.push_back({.position = position,
                             .area = h * h,
                             .chart = is_right ? 1u : 0u,
                             .x = is_right ? 3 - x : x,
                             .y = is_right ? 5 - y : y});
      if (x + 1 < size) sheet.links.push_back({index(x, y), index(x + 1, y), 1.0f});
      if (y + 1 < size) sheet.links.push_back({index(x, y), index(x, y + 1), 1.0f});
    }
  return sheet;
}

// Blurs by way of a coarse level are their own adjoints but for what its squares cut unevenly.
TEST(CellBlurs, KeepTheLightAndExchangeItBothWaysAlike) {
  const Sheet sheet = cut_sheet(21, 0.2f);
  const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 4.0);
  ASSERT_GE(graph.levels.size(), 3u);
  const std::size_t scales = scale_count(graph), n = sheet.cells.size();
  const CellBasis<4> coordinate{CellField<4>(n)};
  for (std::size_t scale = 0; scale < scales; ++scale) {
    CellOperator<4> blur{.terms = 1, .weights = std::vector<BandValues<4>>(scales), .totals = {}};
    blur.weights[scale] = BandValues<4>::filled(1.0f);
    const std::array<const CellOperator<4>*, 1> blurs = {&blur};
    const auto spread = [&](std::size_t from) {
      CellField<4> light(n);
      light[from] = BandValues<4>::filled(1.0f);
      return apply_cell_operators<4>(graph, light, coordinate, blurs)[0];
    };
    const std::size_t a = 9 + 7 * 21, b = 12 + 9 * 21;  // on either side of the cut
    const CellField<4> of_a = spread(a), of_b = spread(b);
    EXPECT_NEAR(of_a[b][0], of_b[a][0], scale < 6 ? 1e-7f : 0.05f * of_a[b][0]) << scale;
    double sum = 0.0;
    for (const auto& value : of_a) sum += static_cast<double>(value[0]);
    EXPECT_NEAR(sum, 1.0, 1e-5) << scale;
  }
}

// The same stripes under the same maps on a grid of texels and on a cut sheet of cells.
TEST(SurfaceTransport, AgreesWithTransportOnAPlaneAcrossACut) {
  constexpr int size = 96;
  constexpr float h = 0.08f;
  const StackTables tables =
      make_stack_tables(green_stack, OperatorTotals::diffusion, {}, small_grid());
  const Sheet sheet = cut_sheet(size, h);
  const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 40.0);
  Plane upper = make_plane(size, size), lower = upper, absorbance = upper, light = upper;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto i = static_cast<std::size_t>(y * size + x);
      upper.values[i] = 0.6f * std::exp(static_cast<float>(std::sin(0.15 * x + 0.1 * y)));
      lower.values[i] = 0.25f * std::exp(0.7f * static_cast<float>(std::cos(0.1 * x - 0.2 * y)));
      absorbance.values[i] = x > 40 && x < 60 ? 0.3f : 0.0f;
      light.values[i] = 1.0f + std::cos(0.13f * static_cast<float>(x));
    }
  const TransportResult wanted = transport(
      make_heterogeneous_layers(tables, {upper, lower}, {absorbance}, static_cast<double>(h)),
      light, {.interlayer_bounces = 2});
  SurfaceLayers<4> layers = make_surface_layers<4>(graph);
  const auto absorbing = [](std::size_t layer, std::vector<float> sigma_a) {
    const MappedLayer& from = green_stack.layers[layer];
    LayerTexels texels = uniform_texels({0.0, from.sigma_s, from.g, from.thickness});
    texels.sigma_a = std::move(sigma_a);
    return texels;
  };
  layers.add_band(0, tables, std::vector{absorbing(0, upper.values), absorbing(1, lower.values)},
                  std::vector<std::vector<float>>{absorbance.values});
  layers.add_band(1, tables, std::vector{absorbing(0, {0.6f}), absorbing(1, {0.25f})},
                  std::vector<std::vector<float>>{{0.0f}});
  CellField<4> entering(light.values.size());
  for (std::size_t i = 0; i < entering.size(); ++i) {
    entering[i][0] = light.values[i];
    entering[i][1] = 1.0f;
  }
  const CellField<4> left = transport(layers, entering, 2).reflected;
  double worst = 0.0, mean = 0.0, square = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double error = static_cast<double>(left[i][0] - wanted.reflected.values[i]);
    worst = std::max(worst, std::abs(error));
    square += error * error / static_cast<double>(left.size());
    mean += static_cast<double>(wanted.reflected.values[i]) / static_cast<double>(left.size());
  }
  EXPECT_GT(mean, 0.1);
  EXPECT_LT(std::sqrt(square) / mean, 0.004);
  EXPECT_LT(worst / mean, 0.02);
  // Uniform skin in uniform light: the closed form, which the plane gives as well.
  const TransportResult uniform =
      transport(make_heterogeneous_layers(tables, {make_plane(8, 8, 0.6f), make_plane(8, 8, 0.25f)},
                                          {make_plane(8, 8)}, static_cast<double>(h)),
                make_plane(8, 8, 1.0f), {.interlayer_bounces = 2});
  for (const auto& value : left) ASSERT_NEAR(value[1], uniform.reflected.values[0], 2e-4);
}

// Three layers of which thickness and scattering vary, one band by powers and one by modes, on a
// grid of texels and on cells: what leaves above and, unless the last is infinite, below.
TEST(SurfaceTransport, LayersOfVaryingStatesDoAsOnAPlane) {
  constexpr int size = 48;
  constexpr float h = 0.1f;
  const std::size_t n = size * size;
  const Sheet sheet = cut_sheet(size, h);
  const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 40.0);
  SurfaceLayers<4> layers = make_surface_layers<4>(graph);
  Plane light = make_plane(size, size);
  for (std::size_t i = 0; i < n; ++i)
    light.values[i] = 1.0f + std::cos(0.2f * static_cast<float>(i % size));
  CellField<4> entering(n);
  std::vector<TransportResult> wanted;
  for (const int band : {0, 1}) {
    std::vector<LayerTexels> texels = {
        uniform_texels({.sigma_a = 0.2, .sigma_s = 20.0, .g = 0.5, .thickness = 0.1}),
        uniform_texels({.sigma_a = 0.1, .sigma_s = 6.0, .g = 0.2, .thickness = 0.5}),
        uniform_texels({.sigma_a = 0.05, .sigma_s = 2.0, .thickness = 0.7})};
    texels[0].thickness.clear();
    for (std::size_t i = 0; i < n; ++i)
      texels[0].thickness.push_back(0.1f *
                                    std::exp(0.8f * std::sin(0.2f * static_cast<float>(i % size))));
    if (band == 1) texels[1].sigma_s.clear(), texels[1].sigma_a.clear();
    for (std::size_t i = 0; band == 1 && i < n; ++i) {
      const auto y = static_cast<float>(i / size), x = static_cast<float>(i % size);
      texels[1].sigma_s.push_back(6.0f * std::exp(0.6f * std::cos(0.15f * y)));
      texels[1].sigma_a.push_back(0.1f * std::exp(0.9f * std::sin(0.1f * (x + y))));
    }
    MappedStack stack{1.0, {}, 1.5};
    for (const LayerTexels& layer : texels) {
      const LayerState first = state_of(layer, 0);
      stack.layers.push_back({first.sigma_s, first.g, 1.5, first.thickness, fit_lattice(layer)});
    }
    const StackTables tables =
        make_stack_tables(stack, OperatorTotals::diffusion, {}, small_grid());
    const std::vector<float> sheets(n, 0.02f);
    layers.add_band(band, tables, texels, std::vector{sheets, sheets});
    const Plane absorbance = make_plane(size, size, 0.02f);
    wanted.push_back(transport(
        make_heterogeneous_layers(tables, size, size, texels, {absorbance, absorbance}, h), light,
        {.interlayer_bounces = 3}));
    for (std::size_t i = 0; i < n; ++i) entering[i][band] = light.values[i];
  }
  EXPECT_FALSE(layers.layers[1].basis.modes.empty());
  const SurfaceTransportResult<4> left = transport(layers, entering, 3);
  for (const int band : {0, 1}) {
    const auto expect_alike = [&](const CellField<4>& found, const Plane& on_plane, double error) {
      double mean = 0.0, square = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        const auto value = static_cast<double>(on_plane.values[i]);
        square += std::pow(static_cast<double>(found[i][band]) - value, 2) / static_cast<double>(n);
        mean += value / static_cast<double>(n);
      }
      EXPECT_GT(mean, 0.1);
      EXPECT_LT(std::sqrt(square) / mean, error) << band;
    };
    expect_alike(left.reflected, wanted[static_cast<std::size_t>(band)].reflected, 0.002);
    // By wider blurs, which run on coarse cells.
    expect_alike(left.transmitted, wanted[static_cast<std::size_t>(band)].transmitted, 0.007);
  }
}

// What leaves below uniform layers under uniform light, in closed form and by all bounces.
TEST(SurfaceTransport, UniformLayersTransmitAsTheirTotalsSay) {
  const Sheet sheet = cut_sheet(8, 0.2f);
  const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 4.0);
  const MappedStack stack{
      1.0, {{16.0, 0.7, 1.4, 0.1}, {8.0, 0.7, 1.4, 0.3}, {4.0, 0.2, 1.4, 0.2}}, 1.2};
  SurfaceLayers<4> layers = make_surface_layers<4>(graph);
  std::vector<LayerTexels> texels;
  for (const MappedLayer& layer : stack.layers)
    texels.push_back(uniform_texels({0.3, layer.sigma_s, layer.g, layer.thickness}));
  const StackTables tables = make_stack_tables(stack, OperatorTotals::diffusion, {}, small_grid());
  layers.add_band(0, tables, texels, std::vector<std::vector<float>>{{0.1f}, {0.2f}});
  const CellField<4> even(sheet.cells.size(), BandValues<4>::filled(1.0f));
  const SurfaceTransportResult<4> left = transport(layers, even, 2);
  EXPECT_GT(left.transmitted[20][0], 0.1f);
  EXPECT_NEAR(uniform_reflectance(layers)[20][0], left.reflected[20][0], 2e-4f);
  EXPECT_NEAR(uniform_transmittance(layers)[20][0], left.transmitted[20][0], 2e-4f);
}

}  // namespace
}  // namespace lamina
