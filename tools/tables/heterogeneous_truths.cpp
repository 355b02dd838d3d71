// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints the section of docs/validation.md on layers that are not the same everywhere: waves, an
// edge and dots of melanin, a spot of blood, an array of vessels, and a public benchmark.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/layers/materials/skin.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/solve/scattering/monte_carlo/cylinder_photons.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"
#include "solve/scattering/monte_carlo/delta_tracking.h"

namespace {

using namespace lamina;

constexpr double bands[] = {470.0, 575.0, 645.0};

/// Skin of one band: layers, tables, and what enters.
struct Band {
  LayerStack stack;
  double dermis;  ///< absorption [1/mm]
  StackTables tables;
  double entering;
};

LayerStack stack_of(SkinParameters skin, double wavelength) {
  skin.junction_absorption = 0.0;
  return skin_layer_stack(skin, wavelength);
}

/// @param epidermis  the absorption for which tables are right [1/mm]
Band band_of(const LayerStack& stack, double epidermis) {
  MappedStack mapped{1.0, {}, stack.ior_below()};
  for (const Layer& layer : stack.layers())
    mapped.layers.push_back(
        {layer.medium.sigma_s, layer.medium.g, layer.medium.ior, layer.thickness});
  const double dermis = stack.layers()[1].medium.sigma_a, ior = stack.layers()[0].medium.ior;
  return {stack, dermis,
          make_stack_tables(mapped, OperatorTotals::radiative_transfer_profile,
                            std::vector<double>{epidermis, dermis}),
          1.0 - std::pow((ior - 1.0) / (ior + 1.0), 2)};
}

/// What leaves in even light, [column], over layers that vary along x and are their own mirror
/// image.
std::vector<double> by_transport(const Band& band, const std::vector<double>& epidermis,
                                 const std::vector<double>& dermis, double texel) {
  const int columns = static_cast<int>(std::max(epidermis.size(), dermis.size()));
  const int rows = 32;
  const auto plane_of = [&](const std::vector<double>& values) {
    Plane plane = make_plane(columns, rows);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
      plane.values[i] =
          static_cast<float>(values[values.size() > 1 ? i % static_cast<std::size_t>(columns) : 0]);
    return plane;
  };
  const auto layers = make_heterogeneous_layers(
      band.tables, {plane_of(epidermis), plane_of(dermis)}, {make_plane(columns, rows)}, texel);
  const Plane out =
      transport(layers, make_plane(columns, rows, static_cast<float>(band.entering))).reflected;
  return {out.values.begin(), out.values.begin() + columns};
}

std::vector<Estimate> by_photons(const Band& band, const std::vector<double>& epidermis,
                                 double texel, std::uint64_t photons) {
  return trace_patch_photons({.stack = band.stack,
                              .columns = static_cast<int>(epidermis.size()),
                              .rows = 1,
                              .texel = texel,
                              .sigma_a = {epidermis, {}},
                              .junction = {},
                              .irradiance = {}},
                             {.photons = photons, .seed = 11})
      .exitance;
}

/// Mean, and the first wave's amplitude over it.
template <class ValueAt>
Estimate contrast_of(std::size_t columns, const ValueAt& value_at) {
  double mean = 0.0, wave = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < columns; ++i) {
    const double cosine = std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                   static_cast<double>(columns));
    const Estimate e = value_at(i);
    mean += e.value;
    wave += 2.0 * cosine * e.value;
    variance += 4.0 * cosine * cosine * e.standard_error * e.standard_error;
  }
  return {wave / mean, std::sqrt(variance) / mean};
}

/// Melanin of .025 (1 + .9 cos kx): how much of what places alone would show is seen.
void print_modulation(std::uint64_t photons) {
  constexpr std::size_t columns = 48;
  std::printf(
      "\n| band | k [1/mm] | contrast by photons | by the model | error | transfer by photons |\n"
      "|---|---|---|---|---|---|\n");
  for (const double wavelength : bands) {
    const LayerStack stack = stack_of({.melanin = 0.025}, wavelength);
    const double mean = stack.layers()[0].medium.sigma_a;
    std::vector<double> wave;
    for (std::size_t i = 0; i < columns; ++i)
      wave.push_back(mean * (1.0 + 0.9 * std::cos(2.0 * std::numbers::pi *
                                                  (static_cast<double>(i) + 0.5) / columns)));
    const Band band = band_of(stack, mean);
    const auto model = [&](double texel) {
      const std::vector<double> seen = by_transport(band, wave, {band.dermis}, texel);
      return contrast_of(columns, [&](std::size_t i) { return Estimate{seen[i], 0.0}; }).value;
    };
    const double alone = model(100.0);  // no light goes from texel to texel
    for (const double k : {0.2, 1.0, 5.0, 20.0}) {
      const double texel = 2.0 * std::numbers::pi / k / columns;
      const auto seen = by_photons(band, wave, texel, photons);
      const Estimate truth = contrast_of(columns, [&](std::size_t i) { return seen[i]; });
      const double ours = model(texel);
      std::printf("| %.0f nm | %g | %.4f ± %.4f | %.4f | %+.1f ± %.1f %% | %.2f |\n", wavelength, k,
                  -truth.value, truth.standard_error, -ours, 100.0 * (ours / truth.value - 1.0),
                  100.0 * std::abs(truth.standard_error / truth.value), truth.value / alone);
      std::fflush(stdout);
    }
  }
}

/// Melanin .01 on one side and .06 on the other: places at equal distances from either edge.
void print_edge(std::uint64_t photons) {
  constexpr double texel = 0.05;
  constexpr std::size_t half = 80;  // texels of a half-plane of 4 mm
  const std::vector<std::size_t> borders = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 40};
  std::printf("\n| band | side |");
  for (std::size_t b = 0; b + 1 < borders.size(); ++b)
    std::printf(" %.2f .. %.2f |", texel * double(borders[b]), texel * double(borders[b + 1]));
  std::printf("\n|---|---|");
  for (std::size_t b = 0; b + 1 < borders.size(); ++b) std::printf("---|");
  std::printf("\n");
  for (const double wavelength : bands) {
    const double bright = epidermis_absorption({.melanin = 0.01}, wavelength);
    const double dark = epidermis_absorption({.melanin = 0.06}, wavelength);
    const Band band = band_of(stack_of({.melanin = 0.01}, wavelength), std::sqrt(bright * dark));
    std::vector<double> epidermis;  // dark in the middle
    for (std::size_t i = 0; i < 2 * half; ++i)
      epidermis.push_back(half / 2 <= i && i < 2 * half - half / 2 ? dark : bright);
    const auto truth = by_photons(band, epidermis, texel, photons);
    const auto ours = by_transport(band, epidermis, {band.dermis}, texel);
    for (const bool is_dark : {false, true}) {
      std::printf("| %.0f nm | %s |", wavelength, is_dark ? "dark" : "bright");
      for (std::size_t b = 0; b + 1 < borders.size(); ++b) {
        double seen = 0.0, variance = 0.0, model = 0.0;
        for (std::size_t d = borders[b]; d < borders[b + 1]; ++d)
          for (const bool is_left : {true, false}) {
            const std::size_t from_left = is_dark ? half / 2 + d : half / 2 - 1 - d;
            const std::size_t i = is_left ? from_left : 2 * half - 1 - from_left;
            seen += truth[i].value;
            variance += std::pow(truth[i].standard_error, 2);
            model += ours[i];
          }
        std::printf(" %+.1f ± %.1f %% |", 100.0 * (model / seen - 1.0),
                    100.0 * std::sqrt(variance) / seen);
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

/// A square of texels that goes on as its own mirror image: what leaves by photons and by the
/// model, [row, column].
struct SquareLight {
  std::vector<Estimate> truth;
  std::vector<double> ours;
};

/// @param epidermis  [row, column] absorption [1/mm]; or one number
/// @param dermis     likewise
SquareLight square_light(const Band& band, int side, const std::vector<double>& epidermis,
                         const std::vector<double>& dermis, double texel, std::uint64_t photons) {
  const auto size = static_cast<std::size_t>(side);
  const auto full = [&](const std::vector<double>& values) {
    return values.size() == 1 ? std::vector<double>(size * size, values[0]) : values;
  };
  const std::vector<double> above = full(epidermis), below = full(dermis);
  SquareLight light;
  light.truth = trace_patch_photons({.stack = band.stack,
                                     .columns = side,
                                     .rows = side,
                                     .texel = texel,
                                     .sigma_a = {above, below},
                                     .junction = {},
                                     .irradiance = {}},
                                    {.photons = photons, .seed = 16})
                    .exitance;
  const auto plane_of = [&](const std::vector<double>& values) {
    Plane plane = make_plane(side, side);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
      plane.values[i] = static_cast<float>(values[i]);
    return plane;
  };
  const auto layers = make_heterogeneous_layers(band.tables, {plane_of(above), plane_of(below)},
                                                {make_plane(side, side)}, texel);
  const Plane out =
      transport(layers, make_plane(side, side, static_cast<float>(band.entering))).reflected;
  light.ours.assign(out.values.begin(), out.values.end());
  return light;
}

/// Prints the model's error in rings around the middle of a square.
void print_rings(const SquareLight& light, int side, double texel,
                 const std::vector<double>& borders) {
  const auto distance = [&](std::size_t i) {
    const auto columns = static_cast<std::size_t>(side);
    const double x = (static_cast<double>(i % columns) + 0.5 - 0.5 * side) * texel;
    const double y = (static_cast<double>(i / columns) + 0.5 - 0.5 * side) * texel;
    return std::hypot(x, y);
  };
  for (std::size_t b = 0; b + 1 < borders.size(); ++b) {
    double seen = 0.0, variance = 0.0, model = 0.0;
    for (std::size_t i = 0; i < light.ours.size(); ++i)
      if (borders[b] <= distance(i) && distance(i) < borders[b + 1]) {
        seen += light.truth[i].value;
        variance += std::pow(light.truth[i].standard_error, 2);
        model += light.ours[i];
      }
    std::printf(" %+.1f ± %.1f %% |", 100.0 * (model / seen - 1.0),
                100.0 * std::sqrt(variance) / seen);
  }
}

/// The root mean square of the model's error over all texels, the photons' noise taken out.
double rms_error(const SquareLight& light) {
  double square = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < light.ours.size(); ++i) {
    square += std::pow(light.ours[i] / light.truth[i].value - 1.0, 2);
    noise += std::pow(light.truth[i].standard_error / light.truth[i].value, 2);
  }
  return std::sqrt(std::max(square - noise, 0.0) / static_cast<double>(light.ours.size()));
}

/// Dots of .3 mm in diameter every .6 mm.
void print_dots(std::uint64_t photons) {
  constexpr int side = 12;
  constexpr double texel = 0.05;
  std::printf(
      "\n| band | melanin of dots, between | 0 .. 0.05 | 0.05 .. 0.10 | 0.10 .. 0.15 | "
      "0.15 .. 0.20 | 0.20 .. 0.30 | 0.30 .. 0.43 | rms "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  for (const double wavelength : bands)
    for (const double melanin : {0.06, 0.12}) {
      const double bright = epidermis_absorption({.melanin = 0.01}, wavelength);
      const double dark = epidermis_absorption({.melanin = melanin}, wavelength);
      const Band band = band_of(stack_of({.melanin = 0.01}, wavelength), std::sqrt(bright * dark));
      std::vector<double> epidermis;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          epidermis.push_back(std::hypot(x + 0.5 - 0.5 * side, y + 0.5 - 0.5 * side) * texel < 0.15
                                  ? dark
                                  : bright);
      const SquareLight light = square_light(band, side, epidermis, {band.dermis}, texel, photons);
      std::printf("| %.0f nm | %g, 0.01 |", wavelength, melanin);
      print_rings(light, side, texel, {0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.43});
      std::printf(" %.1f %% |\n", 100.0 * rms_error(light));
      std::fflush(stdout);
    }
}

/// A spot of blood, of .03 in its middle and a Gaussian of .5 mm around it, in a dermis of .002.
void print_spot(std::uint64_t photons) {
  constexpr int side = 48;
  constexpr double texel = 0.1, deviation = 0.5;
  std::printf(
      "\n| band | 0 .. 0.2 | 0.2 .. 0.4 | 0.4 .. 0.6 | 0.6 .. 0.9 | 0.9 .. 1.2 | 1.2 .. 1.8 | "
      "1.8 .. 2.4 |\n|---|---|---|---|---|---|---|---|\n");
  for (const double wavelength : bands) {
    const Band band = band_of(stack_of({.melanin = 0.01, .hemoglobin_dermis = 0.01}, wavelength),
                              epidermis_absorption({.melanin = 0.01}, wavelength));
    std::vector<double> dermis;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double r = std::hypot(x + 0.5 - 0.5 * side, y + 0.5 - 0.5 * side) * texel;
        const double blood = 0.002 + 0.03 * std::exp(-0.5 * std::pow(r / deviation, 2));
        dermis.push_back(dermis_absorption({.hemoglobin_dermis = blood}, wavelength));
      }
    const SquareLight light =
        square_light(band, side, {band.stack.layers()[0].medium.sigma_a}, dermis, texel, photons);
    std::printf("| %.0f nm |", wavelength);
    print_rings(light, side, texel, {0.0, 0.2, 0.4, 0.6, 0.9, 1.2, 1.8, 2.4});
    std::printf("\n");
    std::fflush(stdout);
  }
}

/// Vessels of .1 mm in diameter every millimetre, .35 mm below the surface, in a dermis with little
/// blood; and what a map of the mean blood in each column makes of them.
void print_vessels(std::uint64_t photons) {
  constexpr int columns = 40;
  constexpr double pitch = 1.0, depth = 0.35, radius = 0.05, texel = pitch / columns;
  // The map tells of blood as if it filled the dermis down to here.
  constexpr double mapped_depth = 0.7;
  std::printf(
      "\n| band | reflected | by the vessel | by the epidermis | by the dermis | contrast | "
      "map: reflected | map: contrast |\n|---|---|---|---|---|---|---|---|\n");
  for (const double wavelength : bands) {
    const LayerStack stack = stack_of({.melanin = 0.02, .hemoglobin_dermis = 0.002}, wavelength);
    // Whole blood: what a dermis would absorb whose blood were all of it.
    const double blood = (dermis_absorption({.hemoglobin_dermis = 0.1}, wavelength) -
                          dermis_absorption({.hemoglobin_dermis = 0.0}, wavelength)) /
                         0.1;
    const Medium& around = stack.layers()[1].medium;
    const CylinderPhotons truth = trace_cylinder_photons(
        {.stack = stack,
         .cylinders = {{0.5 * pitch, depth, radius, blood, around.sigma_s, around.g}},
         .width = pitch,
         .length = 1.0,
         .columns = columns},
        {.photons = photons, .seed = 12});
    const Estimate seen =
        contrast_of(columns, [&](std::size_t i) { return truth.reflected_by_column[i]; });
    const Band band = band_of(stack, stack.layers()[0].medium.sigma_a);
    std::vector<double> dermis;
    for (int repeat = 0; repeat < 4; ++repeat)
      for (int i = 0; i < columns; ++i) {
        const double x = (i + 0.5) * texel - 0.5 * pitch;
        const double chord = std::abs(x) < radius ? 2.0 * std::sqrt(radius * radius - x * x) : 0.0;
        dermis.push_back(around.sigma_a + (blood - around.sigma_a) * chord / mapped_depth);
      }
    const auto ours = by_transport(band, {stack.layers()[0].medium.sigma_a}, dermis, texel);
    double mean = 0.0;
    for (const double value : ours) mean += value / static_cast<double>(ours.size());
    const Estimate mapped = contrast_of(columns, [&](std::size_t i) {
      return Estimate{ours[i], 0.0};
    });
    std::printf(
        "| %.0f nm | %.4f ± %.4f | %.4f ± %.4f | %.4f | %.4f | %.4f ± %.4f | %.4f | %.4f |\n",
        wavelength, truth.reflected.value, truth.reflected.standard_error,
        truth.absorbed_by_cylinders[0].value, truth.absorbed_by_cylinders[0].standard_error,
        truth.absorbed_by_layers[0].value, truth.absorbed_by_layers[1].value, seen.value,
        seen.standard_error, mean, mapped.value);
    std::fflush(stdout);
  }
}

struct FoldLight {
  double reflected, transmitted;
};

/// A fold of two epidermises and the dermis between, by the model. @param epidermis  [column]
FoldLight fold_by_transport(const LayerStack& stack, const std::vector<double>& near,
                            const std::vector<double>& far, double texel,
                            const StackTables& tables) {
  const int columns = static_cast<int>(near.size());
  const auto plane_of = [&](const std::vector<double>& values) {
    Plane plane = make_plane(columns, 32);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
      plane.values[i] = static_cast<float>(values[i % values.size()]);
    return plane;
  };
  const Plane sheet = make_plane(columns, 32);
  const double ior = stack.layers()[0].medium.ior;
  const auto layers = make_heterogeneous_layers(
      tables, {plane_of(near), plane_of({stack.layers()[1].medium.sigma_a}), plane_of(far)},
      {sheet, sheet}, texel);
  const TransportResult light = transport(
      layers,
      make_plane(columns, 32, static_cast<float>(1.0 - std::pow((ior - 1.0) / (ior + 1.0), 2))));
  FoldLight mean{0.0, 0.0};
  for (std::size_t i = 0; i < light.reflected.values.size(); ++i) {
    mean.reflected += static_cast<double>(light.reflected.values[i]);
    mean.transmitted += static_cast<double>(light.transmitted.values[i]);
  }
  const auto size = static_cast<double>(light.reflected.values.size());
  return {mean.reflected / size, mean.transmitted / size};
}

StackTables fold_tables(const LayerStack& stack, double epidermis) {
  MappedStack mapped{1.0, {}, stack.ior_below()};
  for (const Layer& layer : stack.layers())
    mapped.layers.push_back(
        {layer.medium.sigma_s, layer.medium.g, layer.medium.ior, layer.thickness});
  return make_stack_tables(
      mapped, OperatorTotals::radiative_transfer,
      std::vector<double>{epidermis, stack.layers()[1].medium.sigma_a, epidermis});
}

/// Folds of skin 2 to 4 mm thick: uniform ones against adding-doubling, and such whose epidermises
/// have stripes of melanin .01 and .06, .6 mm wide, against photons.
void print_fold(std::uint64_t photons) {
  constexpr double texel = 0.1;
  std::printf(
      "\n| band | thickness | melanin | transmitted | by the model | error of T | error of R "
      "|\n|---|---|---|---|---|---|---|\n");
  const double pale = 0.01, dark = 0.06;
  for (const double wavelength : {470.0, 540.0, 575.0, 610.0, 645.0, 680.0})
    for (const double thickness : {2.0, 3.0, 4.0}) {
      const auto stack_with = [&](double melanin) {
        return stack_of({.melanin = melanin, .dermis_thickness = thickness - 0.5}, wavelength);
      };
      const auto absorption = [&](double melanin) {
        return stack_with(melanin).layers()[0].medium.sigma_a;
      };
      const double typical = std::sqrt(absorption(pale) * absorption(dark));
      const StackTables tables = fold_tables(stack_with(pale), typical);
      for (const double melanin : {pale, 0.025, dark}) {
        const LayerStack stack = stack_with(melanin);
        const SlabTotals truth = adding_doubling(stack).totals;
        const std::vector<double> sigma_a(32, absorption(melanin));
        const FoldLight ours = fold_by_transport(stack, sigma_a, sigma_a, texel, tables);
        std::printf("| %.0f nm | %g mm | %g | %.3g | %.3g | %+.1f %% | %+.1f %% |\n", wavelength,
                    thickness, melanin, truth.transmittance, ours.transmitted,
                    100.0 * (ours.transmitted / truth.transmittance - 1.0),
                    100.0 * (ours.reflected / truth.diffuse_reflectance - 1.0));
      }
      if (photons <= 1 || thickness != 3.0 || wavelength < 600.0) continue;
      std::vector<double> stripes;
      for (std::size_t i = 0; i < 24; ++i)
        stripes.push_back(absorption((i + 3) % 12 < 6 ? pale : dark));
      const PatchPhotons truth = trace_patch_photons({.stack = stack_with(pale),
                                                      .columns = 24,
                                                      .rows = 1,
                                                      .texel = texel,
                                                      .sigma_a = {stripes, {}, stripes},
                                                      .junction = {},
                                                      .irradiance = {}},
                                                     {.photons = photons, .seed = 15});
      double transmitted = 0.0, variance = 0.0, reflected = 0.0;
      for (std::size_t i = 0; i < stripes.size(); ++i) {
        transmitted += truth.transmitted[i].value / 24.0;
        variance += std::pow(truth.transmitted[i].standard_error / 24.0, 2);
        reflected += truth.exitance[i].value / 24.0;
      }
      const FoldLight ours = fold_by_transport(stack_with(pale), stripes, stripes, texel, tables);
      std::printf("| %.0f nm | %g mm | stripes | %.3g ± %.1f %% | %.3g | %+.1f %% | %+.1f %% |\n",
                  wavelength, thickness, transmitted, 100.0 * std::sqrt(variance) / transmitted,
                  ours.transmitted, 100.0 * (ours.transmitted / transmitted - 1.0),
                  100.0 * (ours.reflected / reflected - 1.0));
      std::fflush(stdout);
    }
}

/// The benchmark `skinvessel` of mcxyz.
void print_skinvessel(std::uint64_t photons) {
  const Medium water{3.564e-5, 0.0, 0.0, 1.0}, epidermis{1.657237447, 37.59398496, 0.9, 1.0},
      dermis{0.04584957865, 35.65405549, 0.9, 1.0}, blood{23.05426549, 9.398496241, 0.9, 1.0};
  const CylinderLayers scene{.stack = LayerStack({{.medium = water, .thickness = 0.1},
                                                  {.medium = epidermis, .thickness = 0.06},
                                                  {.medium = dermis, .thickness = 0.84}}),
                             .cylinders = {{0.5, 0.5, 0.1, blood.sigma_a, blood.sigma_s, blood.g}},
                             .sides = BoxSides::open,
                             .beam_radius = 0.3};
  const auto row = [](const char* name, double total, double e, double w, double ep, double d,
                      double b) {
    std::printf("| %s | %.3f ± %.3f %% | %.4f %% | %.2f %% | %.2f %% | %.2f %% |\n", name,
                100.0 * total, 100.0 * e, 100.0 * w, 100.0 * ep, 100.0 * d, 100.0 * b);
    std::fflush(stdout);
  };
  std::printf("\n| | absorbed | water | epidermis | dermis | blood |\n|---|---|---|---|---|---|\n");
  const CylinderPhotons all = trace_cylinder_photons(scene, {.photons = photons, .seed = 13});
  const auto& layers = all.absorbed_by_layers;
  const double vessel = all.absorbed_by_cylinders[0].value;
  // What is not absorbed leaves.
  const double error = std::hypot(all.reflected.standard_error, all.transmitted.standard_error,
                                  all.through_sides.standard_error);
  row("cylinder", layers[0].value + layers[1].value + layers[2].value + vessel, error,
      layers[0].value, layers[1].value, layers[2].value, vessel);
  // 200³ voxels of 5 µm, each of the tissue at its middle.
  const auto voxel = [](double at) { return (std::floor(at / 0.005) + 0.5) * 0.005; };
  const auto fractions = absorbed_by_tissues(
      {1.0, 1.0, 1.0}, 4, 39.3,
      [&](const Vec3& at) {
        const double x = voxel(at.x), z = voxel(at.z);
        if (std::hypot(x - 0.5, z - 0.5) < 0.1) return Tissue{3, blood};
        if (z < 0.1) return Tissue{0, water};
        return z < 0.16 ? Tissue{1, epidermis} : Tissue{2, dermis};
      },
      [](Random& random) {
        const double r = 0.3 * std::sqrt(random.uniform());
        const double phi = 2.0 * std::numbers::pi * random.uniform();
        return Vec3{0.5 + r * std::cos(phi), 0.5 + r * std::sin(phi), 0.0};
      },
      photons, 14);
  const double total = 1.0 - fractions[4];
  row("200³ voxels, delta tracking", total,
      std::sqrt(total * fractions[4] / static_cast<double>(photons)), fractions[0], fractions[1],
      fractions[2], fractions[3]);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  const std::uint64_t photons = argc > 2 ? std::stoull(argv[2]) : 1'000'000;
  std::printf("%llu photons for each row.\n", static_cast<unsigned long long>(photons));
  if (what == "all" || what == "modulation") print_modulation(photons);
  if (what == "all" || what == "edge") print_edge(photons);
  if (what == "all" || what == "dots") print_dots(photons);
  if (what == "all" || what == "spot") print_spot(photons);
  if (what == "all" || what == "vessels") print_vessels(photons);
  if (what == "all" || what == "fold") print_fold(photons);
  if (what == "all" || what == "skinvessel") print_skinvessel(photons);
}
