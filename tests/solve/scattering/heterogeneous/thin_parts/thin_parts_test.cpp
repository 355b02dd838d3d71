// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/thin_parts/thin_parts.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/solve/scattering/heterogeneous/surface_transport.h"
#include "lamina/solve/scattering/heterogeneous/thin_parts/internal/facing_cells.h"
#include "lamina/solve/scattering/heterogeneous/thin_parts/internal/slab_profiles.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
const MappedStack skin{1.0, {{16.0, 0.77, 1.4, 0.25}, {8.0, 0.77, 1.38, infinite}}, 1.38};
const std::vector<double> usual = {0.3, 0.05};  // absorption of the layers

GaussianTableGrid small_grid() {
  GaussianTableGrid grid;
  grid.rows = 64;
  return grid;
}

/// Two sheets of squares one above the other; `depth(x)` is how far the lower one is below.
struct Plate {
  int size;
  float h;
  std::vector<GraphCell> cells;
  std::vector<CellLink> links;
  std::vector<Vec3f> positions, normals;
  CellGraph graph;

  [[nodiscard]] std::size_t sheet() const { return cells.size() / 2; }
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
           static_cast<std::size_t>(x);
  }
};

template <class Depth>
Plate make_plate(int size, float h, const Depth& depth) {
  Plate plate{
      .size = size, .h = h, .cells = {}, .links = {}, .positions = {}, .normals = {}, .graph = {}};
  for (const bool is_lower : {false, true}) {
    const auto first = static_cast<std::uint32_t>(plate.cells.size());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const Vec3f at{h * (static_cast<float>(x) + 0.5f), h * (static_cast<float>(y) + 0.5f),
                       is_lower ? -depth(x) : 0.0f};
        const auto i = static_cast<std::uint32_t>(plate.cells.size());
        plate.cells.push_back(
            {.position = at, .area = h * h, .chart = is_lower ? 1u : 0u, .x = x, .y = y});
        plate.positions.push_back(at);
        plate.normals.push_back({0.0f, 0.0f, is_lower ? -1.0f : 1.0f});
        if (x > 0) plate.links.push_back({i - 1, i, 1.0f});
        if (y > 0) plate.links.push_back({i - static_cast<std::uint32_t>(size), i, 1.0f});
      }
    EXPECT_EQ(plate.cells.size() - first, plate.at(0, size));
  }
  plate.graph = make_cell_graph(plate.cells, plate.links, 25.0);
  return plate;
}

/// Layers of a plate, all alike but for the absorption of the lower one.
SurfaceLayers<4> make_layers(const Plate& plate, const StackTables& tables,
                             const std::vector<float>& sigma_a,
                             const std::vector<double>& reference = usual,
                             bool has_transfer_totals = false) {
  SurfaceLayers<4> layers = make_surface_layers<4>(plate.graph);
  const auto absorbing = [](std::size_t layer, std::vector<float> values) {
    const MappedLayer& from = skin.layers[layer];
    LayerTexels texels = uniform_texels({0.0, from.sigma_s, from.g, from.thickness});
    texels.sigma_a = std::move(values);
    return texels;
  };
  layers.add_band(0, tables,
                  std::vector{absorbing(0, {static_cast<float>(usual[0])}), absorbing(1, sigma_a)},
                  std::vector<std::vector<float>>{{0.0f}});
  const std::array<ThinBand, 1> bands = {{{.stack = &skin,
                                           .tables = &tables,
                                           .reference = reference,
                                           .sigma_a = sigma_a,
                                           .has_transfer_totals = has_transfer_totals}}};
  layers.thin = make_thin_parts<4>(plate.graph, plate.positions, plate.normals, bands);
  return layers;
}

/// Light on the lower sheet.
template <class Irradiance>
CellField<4> light_below(const Plate& plate, const Irradiance& irradiance) {
  CellField<4> light(plate.cells.size());
  for (std::size_t i = 0; i < plate.sheet(); ++i) light[plate.sheet() + i][0] = irradiance(i);
  return light;
}

// A fold of skin lit from one side, all over and in one spot: the two sheets of its surface,
// against its three layers at once.
TEST(ThinParts, LetThroughWhatAFoldOfSkinDoes) {
  for (const double sigma_a : {0.05, 0.25}) {
    const Plate plate = make_plate(64, 0.5f, [](int) { return 2.5f; });
    const MappedStack fold{
        1.0, {{16.0, 0.77, 1.4, 0.25}, {8.0, 0.77, 1.38, 2.0}, {16.0, 0.77, 1.4, 0.25}}, 1.0};
    const StackTables three = make_stack_tables(fold, OperatorTotals::diffusion, {}, small_grid());
    const StackTables two = make_stack_tables(skin, OperatorTotals::diffusion, {}, small_grid());
    const SurfaceLayers<4> layers =
        make_layers(plate, two, std::vector<float>(plate.cells.size(), static_cast<float>(sigma_a)),
                    {usual[0], sigma_a});
    const auto of_fold = [&](int size, const Plane& light) {
      const auto plane = [&](double value) {
        return make_plane(size, size, static_cast<float>(value));
      };
      return transport(
          make_heterogeneous_layers(three, {plane(usual[0]), plane(sigma_a), plane(usual[0])},
                                    {plane(0.0), plane(0.0)}, 0.5),
          light, {.interlayer_bounces = 8});
    };
    const TransportResult wanted = of_fold(8, make_plane(8, 8, 1.0f));
    const CellField<4> left =
        transport(layers, light_below(plate, [](auto) { return 1.0f; })).reflected;
    const std::size_t middle = plate.at(32, 32);
    const float r = wanted.reflected.values[0], t = wanted.transmitted.values[0];
    EXPECT_GT(t, 0.005f);
    EXPECT_NEAR(left[plate.sheet() + middle][0], r, 0.02f * r) << sigma_a;
    EXPECT_NEAR(left[middle][0], t, 0.03f * t) << sigma_a;

    // How wide a spot is on the other side.
    Plane spot = make_plane(64, 64);
    spot.values[middle] = 1.0f;
    const TransportResult wanted_spot = of_fold(64, spot);
    const CellField<4> left_spot =
        transport(layers, light_below(plate, [&](auto i) { return spot.values[i]; })).reflected;
    const auto variance = [&](const auto& at) {
      double sum = 0.0, moment = 0.0;
      for (std::size_t i = 0; i < plate.sheet(); ++i) {
        const Vec3f from = plate.positions[i] - plate.positions[middle];
        const double share = static_cast<double>(at(i));
        sum += share;
        moment += share * static_cast<double>(from.x * from.x + from.y * from.y);
      }
      return 0.5 * moment / sum;
    };
    const double expected =
        variance([&](std::size_t i) { return wanted_spot.transmitted.values[i]; });
    EXPECT_NEAR(variance([&](std::size_t i) { return left_spot[i][0]; }), expected, 0.1 * expected)
        << sigma_a;
  }
}

// With totals of radiative transfer: the fold by adding-doubling, thin and thick, in the two
// bounces that are usual.
TEST(ThinParts, TransmitWhatRadiativeTransferSays) {
  const StackTables tables =
      make_stack_tables(skin, OperatorTotals::radiative_transfer_diffuse, usual, small_grid());
  // Light that crosses the dermis twice more is left out: it counts in the thinnest.
  constexpr std::array<std::array<double, 3>, 3> cases = {
      {{1.5, 0.07, 0.03}, {3.0, 0.02, 0.015}, {6.0, 0.03, 0.02}}};
  for (const auto& [depth, of_transmittance, of_reflectance] : cases) {
    const auto thickness = static_cast<float>(depth);
    const Plate plate = make_plate(80, 0.5f, [&](int) { return thickness; });
    const SurfaceLayers<4> layers = make_layers(
        plate, tables, std::vector<float>(plate.cells.size(), static_cast<float>(usual[1])), usual,
        true);
    const auto layer = [&](std::size_t i, double d) {
      const MappedLayer& of = skin.layers[i];
      return Layer{.medium = {usual[i], of.sigma_s, of.g, of.ior}, .thickness = d};
    };
    const SlabTotals wanted =
        adding_doubling(LayerStack({layer(0, 0.25), layer(1, static_cast<double>(thickness) - 0.5),
                                    layer(0, 0.25)},
                                   1.0, 1.0),
                        {.theta = std::numbers::pi / 6.0})
            .totals;
    const double entered = 1.0 - wanted.specular_reflectance;
    const CellField<4> left =
        transport(layers, light_below(plate, [](auto) { return 1.0f; })).reflected;
    const std::size_t middle = plate.at(40, 40);
    EXPECT_NEAR(static_cast<double>(left[middle][0]), wanted.transmittance / entered,
                of_transmittance * wanted.transmittance / entered)
        << thickness;
    EXPECT_NEAR(static_cast<double>(left[plate.sheet() + middle][0]),
                wanted.diffuse_reflectance / entered,
                of_reflectance * wanted.diffuse_reflectance / entered)
        << thickness;
    EXPECT_NEAR(layers.thin.thickness[middle], thickness - 0.5f, 0.05f * thickness) << thickness;
  }
}

// Thin enough for one band to pass, and black for another that its map makes less black: a ratio of
// two numbers that are next to nothing.
TEST(ThinParts, BandsThatAreBlackStayBlackWhateverTheirMaps) {
  const Plate plate = make_plate(24, 0.7f, [](int) { return 8.0f; });
  const std::vector<double> clear = {0.3, 0.02}, black = {0.3, 10.0};
  const StackTables tables = make_stack_tables(skin, OperatorTotals::diffusion, {}, small_grid());
  const std::vector<float> clear_map(plate.cells.size(), 0.02f), map(plate.cells.size(), 2.0f);
  const std::array<ThinBand, 2> bands = {
      {{.stack = &skin, .tables = &tables, .reference = clear, .sigma_a = clear_map},
       {.stack = &skin, .tables = &tables, .reference = black, .sigma_a = map}}};
  const auto thin = make_thin_parts<4>(plate.graph, plate.positions, plate.normals, bands);
  const CellField<4> up = pass_through(
      plate.graph, thin, CellField<4>(plate.cells.size(), BandValues<4>::filled(1.0f)));
  const std::size_t middle = plate.at(12, 12);
  EXPECT_GT(up[middle][0], 1e-3f);
  EXPECT_LT(up[middle][1], 1e-6f);  // false for NaN, too
}

// Where the far side jumps from 2 to 5 mm, light and thickness follow over some millimetres: no
// faster than through a Gaussian of .9 mm, narrower than T of the thin half.
TEST(ThinParts, HaveNoEdgeWhereTheFarSideHasOne) {
  const Plate plate = make_plate(96, 0.25f, [](int x) { return x < 48 ? 2.0f : 5.0f; });
  const StackTables tables = make_stack_tables(skin, OperatorTotals::diffusion, {}, small_grid());
  const SurfaceLayers<4> layers = make_layers(
      plate, tables, std::vector<float>(plate.cells.size(), static_cast<float>(usual[1])));
  const CellField<4> left =
      transport(layers, light_below(plate, [](auto) { return 1.0f; })).reflected;
  const auto light = [&](int x) { return left[plate.at(x, 48)][0]; };
  const auto thickness = [&](int x) { return layers.thin.thickness[plate.at(x, 48)]; };
  EXPECT_GT(light(24), 3.0f * light(76));
  EXPECT_GT(thickness(76), thickness(24) + 2.0f);
  for (int x = 17; x < 80; ++x) {
    EXPECT_LT(std::abs(light(x) - light(x - 1)), 0.12f * light(24)) << x;
    EXPECT_LT(std::abs(light(x + 1) - 2.0f * light(x) + light(x - 1)), 0.02f * light(24)) << x;
    EXPECT_LT(std::abs(thickness(x) - thickness(x - 1)), 0.4f) << x;
  }
}

// A thread of blood on either side darkens what comes through: on the near one it is narrow, on
// the far one a wide shadow.
TEST(ThinParts, ShowThreadsNarrowOnTheNearSideAndWideOnTheFarOne) {
  const Plate plate = make_plate(96, 0.25f, [](int) { return 4.0f; });
  const StackTables tables = make_stack_tables(skin, OperatorTotals::diffusion, {}, small_grid());
  const auto lit = [&](std::size_t first) {
    std::vector<float> sigma_a(plate.cells.size(), static_cast<float>(usual[1]));
    for (int y = 0; y < plate.size; ++y)
      for (int x = 47; x < 49; ++x) sigma_a[first + plate.at(x, y)] = 3.0f;
    const SurfaceLayers<4> layers = make_layers(plate, tables, sigma_a);
    return transport(layers, light_below(plate, [](auto) { return 1.0f; })).reflected;
  };
  const CellField<4> near = lit(0), far = lit(plate.sheet());
  const auto lost = [&](const CellField<4>& light, int x) {
    const float clear = light[plate.at(24, 48)][0];
    return (clear - light[plate.at(x, 48)][0]) / clear;
  };
  EXPECT_GT(lost(near, 48), 0.15f);
  EXPECT_GT(lost(far, 48), 0.02f);
  EXPECT_LT(lost(far, 48), 0.6f * lost(near, 48));
  // 1.5 mm aside.
  EXPECT_LT(lost(near, 54), 0.45f * lost(near, 48));
  EXPECT_GT(lost(far, 54), 0.55f * lost(far, 48));
}

/// What a piece of one boundary sends to another of a body whose surface takes all light that gets
/// there, without absorption: the second derivative along both normals of 1 / (4 pi distance).
double sent(const Vec3& offset, const Vec3& to, const Vec3& from) {
  const double r2 = dot(offset, offset), r = std::sqrt(r2);
  return (dot(to, from) / (r2 * r) - 3.0 * dot(to, offset) * dot(from, offset) / (r2 * r2 * r)) /
         (4.0 * std::numbers::pi);
}

/// The same through a slab, by image sources.
double slab_sends(double lateral, double thickness) {
  double sum = 0.0;
  for (int k = -20; k <= 20; ++k)
    sum += 2.0 * sent({lateral, 0.0, (2.0 * k + 1.0) * thickness}, {0, 0, 1}, {0, 0, -1});
  return sum;
}

// Faces of wedges, whose exchange is known by image sources, through facing_pair's share of the
// slab and what goes over the edge.
TEST(ThinParts, FacesOfAWedgeExchangeWhatImageSourcesSay) {
  for (const int images : {2, 3, 4, 6}) {
    const double angle = std::numbers::pi / images;
    for (const double along : {0.7, 1.0, 1.5}) {
      const Vec3 x{1.0, 0.0, 0.0}, nx{0.0, -1.0, 0.0};
      const Vec3 y{along * std::cos(angle), along * std::sin(angle), 0.0};
      const Vec3 ny{-std::sin(angle), std::cos(angle), 0.0};
      double wanted = 0.0;
      for (int k = 0; k < images; ++k) {
        const double c = std::cos(2.0 * k * angle), s = std::sin(2.0 * k * angle);
        const auto turned = [&](const Vec3& p) {
          return Vec3{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
        };
        const auto mirrored = [](const Vec3& p) { return Vec3{p.x, -p.y, p.z}; };
        wanted += sent(x - turned(y), nx, turned(ny));
        wanted -= sent(x - turned(mirrored(y)), nx, turned(mirrored(ny)));
      }
      const auto cell = [](const Vec3& p, const Vec3& n) {
        const Vec3f normal{static_cast<float>(n.x), static_cast<float>(n.y), 0.0f};
        return detail::FacingCell{.position = {static_cast<float>(p.x), static_cast<float>(p.y), 0},
                                  .normal = normal,
                                  .area = 1.0f};
      };
      const detail::FacingPair pair = detail::facing_pair(cell(x, nx), cell(y, ny));
      const double r = std::sqrt(static_cast<double>(pair.lateral2));
      const double of_slab = slab_sends(r, static_cast<double>(pair.thickness));
      const double over_the_edge = 1.0 + along;
      const double found = static_cast<double>(pair.of_slab) * of_slab +
                           1.0 / (2.0 * std::numbers::pi * std::pow(over_the_edge, 3));
      EXPECT_NEAR(found, wanted, 0.06 * wanted) << images << ' ' << along;
      EXPECT_NEAR(pair.of_distance, 0.0f, 1e-6f);
    }
  }
}

/// One layer of isotropic scattering, and what ThinBand points to.
struct PlainBand {
  MappedStack stack{1.0, {{1.01, 0.0, 1.3, infinite}}, 1.3};
  std::vector<double> reference;  ///< absorption [1/mm]
  StackTables tables;

  explicit PlainBand(double sigma_a)
      : reference{sigma_a},
        tables(make_stack_tables(stack, OperatorTotals::radiative_transfer_diffuse, reference,
                                 small_grid())) {}
};

// Light that comes from one face of an edge of 90° to a place on the other, near the edge: image
// sources, along a line into the body from where light enters, over four planes where the fluence
// vanishes.
TEST(ThinParts, NearAnEdgeLightComesThroughAsImageSourcesSay) {
  for (const double sigma_a : {0.03, 0.48}) {
    const PlainBand band(sigma_a);
    const std::array<ThinBand, 1> bands = {{{.stack = &band.stack,
                                             .tables = &band.tables,
                                             .reference = band.reference,
                                             .sigma_a = {},
                                             .has_transfer_totals = false}}};
    const detail::SlabProfiles<4> profiles(bands, {detail::transfer_factors(bands[0])}, 0.0,
                                           detail::SlabLight::scattered);
    const Medium medium{sigma_a, 1.01, 0.0, 1.3};
    const double l = mfp_prime(medium), s = sigma_tr(medium);
    const double beyond =
        make_multipole(medium, infinite, detail::last_layer(band.stack).inside, 0.0).z_b_top;
    const auto cell = [](const Vec3f& position, const Vec3f& normal) {
      return detail::FacingCell{.position = position, .normal = normal};
    };
    for (const double t : {0.3 * l, 0.7 * l, 1.5 * l}) {
      const detail::FacingCell to = cell({0, static_cast<float>(t), 0}, {-1, 0, 0});
      double wanted = 0.0, found = 0.0;
      constexpr int steps = 40;
      for (int i = 0; i < steps; ++i)
        for (int k = 0; k < steps; ++k) {  // finer where both are near
          const auto at = [&](int j) { return 8.0 * l * std::pow((j + 0.5) / steps, 2); };
          const auto width = [&](int j) { return 16.0 * l * (j + 0.5) / (steps * steps); };
          const double a = at(i), y = at(k), area = 2.0 * width(i) * width(k);
          constexpr int depths = 8;
          for (int n = 0; n < depths; ++n) {
            const double depth = -l * std::log1p(-(n + 0.5) / depths);
            for (const auto& [x, sign_x] : {std::pair(a, 1.0), {-2.0 * beyond - a, -1.0}})
              for (const auto& [z, sign_z] :
                   {std::pair(depth, 1.0), {-2.0 * beyond - depth, -1.0}}) {
                const double r = std::sqrt(x * x + (t - z) * (t - z) + y * y);
                wanted += albedo_prime(medium) / depths * area * sign_x * sign_z * x *
                          (1.0 + s * r) * std::exp(-s * r) / (4.0 * std::numbers::pi * r * r * r);
              }
          }
          const auto pair = detail::facing_pair(
              to, cell({static_cast<float>(a), 0, static_cast<float>(y)}, {0, -1, 0}));
          const auto over_the_edge = static_cast<float>((a + t) * (a + t) + y * y);
          found += area * static_cast<double>(
                              (pair.of_slab * profiles.transmittance(pair.thickness, pair.lateral2,
                                                                     pair.opening) +
                               profiles.reflectance(over_the_edge))[0]);
        }
      EXPECT_NEAR(found, wanted, 0.3 * wanted) << sigma_a << ' ' << t / l;
    }
  }
}

// A sheet so thin that much light crosses it in a straight line: that is no light from below.
TEST(ThinParts, LightThatGoesStraightThroughIsLeftOut) {
  const PlainBand band(0.1);
  const Plate plate = make_plate(64, 0.5f, [](int) { return 1.5f; });
  const std::vector<float> sigma_a(plate.cells.size(), 0.1f);
  const std::array<ThinBand, 1> bands = {{{.stack = &band.stack,
                                           .tables = &band.tables,
                                           .reference = band.reference,
                                           .sigma_a = sigma_a}}};
  const ThinParts<4> thin = make_thin_parts<4>(plate.graph, plate.positions, plate.normals, bands);
  const CellField<4> up =
      pass_through(plate.graph, thin, light_below(plate, [](auto) { return 1.0f; }));
  const AddingDoublingTotals slab =
      adding_doubling(LayerStack({{.medium = {0.1, 1.01, 0.0, 1.3}, .thickness = 1.5}}, 1.0, 1.0),
                      {.theta = std::numbers::pi / 6.0});
  const double entered = 1.0 - slab.totals.specular_reflectance;
  const double wanted = (slab.totals.transmittance - slab.unscattered_transmittance) / entered;
  EXPECT_GT(slab.unscattered_transmittance, 0.3 * wanted);
  EXPECT_NEAR(up[plate.at(32, 32)][0], wanted, 0.04 * wanted);
}

// Concentric spheres, between which light falls as 1 / r: R / r times what a flat slab lets through
// inward, r / R times outward.
TEST(ThinParts, ShellsLetThroughMoreThanTheirPairsAsSlabs) {
  for (const auto& [inner, outer] : {std::pair(20.0, 26.0), {12.0, 18.0}, {9.0, 14.0}}) {
    const double thickness = outer - inner;
    const auto cell = [&](double angle, double radius, double out) {
      const Vec3 n{std::sin(angle), 0.0, std::cos(angle)};
      const auto single = [](const Vec3& v) {
        return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
      };
      detail::FacingCell result{.position = single(radius * n), .normal = single(out * n)};
      // The mean normal over a Gaussian on a sphere is exp(-variance / radius²) long.
      for (std::size_t w = 0; w < result.bend.size(); ++w) {
        const double width = detail::bend_width * std::exp2(w);
        result.bend[w] = static_cast<float>(out * width * width / (radius * radius));
      }
      return result;
    };
    for (const bool is_inward : {true, false}) {
      const double near = is_inward ? inner : outer, far = is_inward ? outer : inner;
      const detail::FacingCell to = cell(0.0, near, is_inward ? -1.0 : 1.0);
      double sum = 0.0;
      constexpr int rings = 600;
      for (int i = 0; i < rings; ++i) {
        const double step = std::numbers::pi / rings, angle = (i + 0.5) * step;
        const detail::FacingPair pair =
            detail::facing_pair(to, cell(angle, far, is_inward ? 1.0 : -1.0));
        if (!(pair.of_slab > 0.0f)) continue;
        const double area = 2.0 * std::numbers::pi * far * far * std::sin(angle) * step;
        sum += area * static_cast<double>(pair.of_slab) *
               slab_sends(std::sqrt(static_cast<double>(pair.lateral2)),
                          static_cast<double>(pair.thickness));
      }
      EXPECT_NEAR(sum * thickness, far / near, 0.1 * far / near) << inner << ' ' << is_inward;
    }
  }
}

}  // namespace
}  // namespace lamina
