// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/surface_transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "lamina/scattering/heterogeneous/heterogeneous_transport.h"

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
  const CellField<4> coordinate(n);
  for (std::size_t scale = 0; scale < scales; ++scale) {
    CellOperator<4> blur{.powers = 1, .weights = std::vector<BandValues<4>>(scales), .totals = {}};
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
  layers.add_band(0, tables, {upper.values, lower.values, absorbance.values});
  layers.add_band(1, tables,
                  {std::vector<float>(upper.values.size(), 0.6f),
                   std::vector<float>(upper.values.size(), 0.25f),
                   std::vector<float>(upper.values.size(), 0.0f)});
  CellField<4> entering(light.values.size());
  for (std::size_t i = 0; i < entering.size(); ++i) {
    entering[i][0] = light.values[i];
    entering[i][1] = 1.0f;
  }
  const CellField<4> left = transport(layers, entering, 2);
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

// Narrow and wide blurs, mixed cell by cell, against each by itself; cells that take none stay
// dark.
TEST(CellBlurs, AMixtureGivesEachCellWhatLiesBetweenTwoBlurs) {
  const Sheet sheet = cut_sheet(32, 0.3f);
  const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 4.0);
  ASSERT_GE(graph.levels.size(), 3u);
  const std::vector<double> variances = {0.1, 1.0, 3.0};
  const std::vector<double> scales = cell_scales_of_gaussians(graph, variances);
  const std::size_t n = sheet.cells.size(), count = scale_count(graph);
  CellField<4> light(n);
  for (std::size_t i = 0; i < n; ++i)
    light[i] = BandValues<4>::filled(sheet.cells[i].position.x < 4.0f ? 1.0f : 0.0f);
  std::vector<CellField<4>> alone;
  for (std::size_t v = 0; v < variances.size(); ++v) {
    CellOperator<4> blur{.powers = 1, .weights = {}, .totals = {}};
    for (std::size_t j = 0; j < count; ++j)
      blur.weights.push_back(BandValues<4>::filled(static_cast<float>(scales[v * count + j])));
    const std::array<const CellOperator<4>*, 1> blurs = {&blur};
    alone.push_back(apply_cell_operators<4>(graph, light, CellField<4>(n), blurs)[0]);
  }
  std::vector<std::uint32_t> cells;
  CellField<4> place;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (sheet.cells[i].position.y < 3.0f) continue;
    cells.push_back(i);
    place.push_back(BandValues<4>::filled(0.2f * sheet.cells[i].position.y));  // up to 1.9
    place.back()[1] = 1.0f;
  }
  const CellMixture<4> mixture = make_cell_mixture<4>(graph, cells, place, scales);
  const auto both = apply_cell_operators<4>(graph, light, CellField<4>(n), {}, &mixture);
  ASSERT_EQ(both.size(), 1u);
  double change = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::uint32_t i = cells[k];
    const auto v = static_cast<std::size_t>(place[k][0]);
    const float share = place[k][0] - static_cast<float>(v);
    const float wanted = (1.0f - share) * alone[v][i][0] + share * alone[v + 1][i][0];
    ASSERT_NEAR(both[0][i][0], wanted, 1e-5f) << i;
    ASSERT_NEAR(both[0][i][1], alone[1][i][1], 1e-5f) << i;
    change = std::max(change, static_cast<double>(std::abs(wanted - alone[1][i][0])));
  }
  EXPECT_GT(change, 0.05);
  for (std::uint32_t i = 0; i < cells.front(); ++i) ASSERT_EQ(both[0][i][0], 0.0f);
}

// A fold of skin lit from one side, all over and in one spot: the two sheets of its surface,
// against its three layers at once.
TEST(SurfaceTransport, ThinPartsLetThroughWhatAFoldOfSkinDoes) {
  constexpr int size = 32;
  constexpr float h = 0.5f;
  for (const double sigma_a : {0.05, 0.25}) {
    const double dermis = 2.0;
    const MappedStack fold{
        1.0, {{16.0, 0.77, 1.4, 0.25}, {8.0, 0.77, 1.38, dermis}, {16.0, 0.77, 1.4, 0.25}}, 1.0};
    const StackTables three = make_stack_tables(fold, OperatorTotals::diffusion, {}, small_grid());
    const auto plane = [&](double value) { return make_plane(8, 8, static_cast<float>(value)); };
    const TransportResult wanted =
        transport(make_heterogeneous_layers(three, {plane(0.3), plane(sigma_a), plane(0.3)},
                                            {plane(0.05), plane(0.05)}, 0.5),
                  plane(1.0), {.interlayer_bounces = 6});
    Sheet sheet = cut_sheet(size, h);
    const auto count = static_cast<std::uint32_t>(sheet.cells.size());
    Sheet back = cut_sheet(size, h);
    for (GraphCell cell : back.cells) {
      cell.chart += 2;
      cell.position.z = -2.5f;
      sheet.cells.push_back(cell);
    }
    for (const CellLink& link : back.links)
      sheet.links.push_back({link.from + count, link.to + count, link.conductance});
    const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 25.0);
    const StackTables two =
        make_stack_tables(green_stack, OperatorTotals::diffusion, {}, small_grid());
    std::vector<FarSide> far(sheet.cells.size());
    for (std::uint32_t i = 0; i < far.size(); ++i)
      far[i] = {
          .thickness = 2.5f, .cell = {(i + count) % (2 * count)}, .weight = {1.0f}, .count = 1};
    SurfaceLayers<4> layers = make_surface_layers<4>(graph);
    layers.thin = make_thin_parts<4>(graph, far, 0.25);
    const std::vector<float> lower(far.size(), static_cast<float>(sigma_a));
    layers.add_band(
        0, two,
        {std::vector<float>(far.size(), 0.3f), lower, std::vector<float>(far.size(), 0.05f)});
    add_band<4>(0, green_stack.layers[1], lower, 0.25, 1.4, layers.thin);
    CellField<4> light(far.size());
    for (std::size_t i = 0; i < count; ++i) light[i][0] = 1.0f;
    const CellField<4> left = transport(layers, light, 6);
    const std::size_t middle = size / 2 * size + size / 2;
    const float r = wanted.reflected.values[0], t = wanted.transmitted.values[0];
    EXPECT_GT(t, 0.005f);
    EXPECT_NEAR(left[middle][0], r, 0.05f * r) << sigma_a;
    EXPECT_NEAR(left[middle + count][0], t, 0.1f * t) << sigma_a;

    // How wide a spot is on the other side.
    const auto wide = [&](double value) {
      return make_plane(size, size, static_cast<float>(value));
    };
    Plane spot = wide(0.0);
    CellField<4> spot_on_sheet(far.size());
    spot.values[middle] = spot_on_sheet[middle][0] = 1.0f;
    const TransportResult wanted_spot =
        transport(make_heterogeneous_layers(three, {wide(0.3), wide(sigma_a), wide(0.3)},
                                            {wide(0.05), wide(0.05)}, static_cast<double>(h)),
                  spot, {.interlayer_bounces = 6});
    const CellField<4> left_spot = transport(layers, spot_on_sheet, 6);
    const auto variance = [&](const auto& at) {
      double sum = 0.0, moment = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f from = sheet.cells[i].position - sheet.cells[middle].position;
        const double share = static_cast<double>(at(i));
        sum += share;
        moment += share * static_cast<double>(from.x * from.x + from.y * from.y);
      }
      return 0.5 * moment / sum;
    };
    const double expected =
        variance([&](std::size_t i) { return wanted_spot.transmitted.values[i]; });
    EXPECT_NEAR(variance([&](std::size_t i) { return left_spot[i + count][0]; }), expected,
                0.15 * expected)
        << sigma_a;
  }
}

// Where a thin part ends the light from behind goes on under the thick one: nothing is lost, and
// there is no edge.
TEST(SurfaceTransport, LightThroughThinPartsHasNoEdgeWhereTheyEnd) {
  constexpr int size = 32;
  const Sheet sheet = cut_sheet(size, 0.5f);
  const CellGraph graph = make_cell_graph(sheet.cells, sheet.links, 25.0);
  const std::size_t n = sheet.cells.size();
  std::vector<FarSide> far(n);
  for (std::uint32_t i = 0; i < n; ++i)
    if (i % size < size / 2)  // looks at the thick half, the other way round
      far[i] = {.thickness = 4.5f,
                .cell = {i / size * size + size - 1 - i % size},
                .weight = {1.0f},
                .count = 1};
  ThinParts<4> thin = make_thin_parts<4>(graph, far, 0.25);
  add_band<4>(0, green_stack.layers[1], std::vector<float>(n, 0.05f), 0.25, 1.4, thin);
  const CellMixture<4> halves = spread_through(graph, thin);
  const auto spread = [&](const CellField<4>& light) {
    return apply_cell_operators<4>(graph, light, CellField<4>(n), {}, &halves)[0];
  };
  CellField<4> down(n);
  for (auto& value : down) value[0] = 1.0f;
  const CellField<4> crossed = pass_through(thin, spread(down)), through = spread(crossed);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    before += static_cast<double>(crossed[i][0]);
    after += static_cast<double>(through[i][0]);
  }
  EXPECT_NEAR(after, before, 0.02 * before);
  const std::size_t row = size / 2 * size;
  const float most = through[row][0];
  EXPECT_NEAR(most, thin.transmittance[row][0], 0.02f * most);
  EXPECT_NEAR(through[row + size / 2 - 1][0] + through[row + size / 2][0], most, 0.1f * most);
  for (std::size_t x = 1; x < size; ++x)
    EXPECT_LT(std::abs(through[row + x][0] - through[row + x - 1][0]), 0.3f * most) << x;
}

}  // namespace
}  // namespace lamina
