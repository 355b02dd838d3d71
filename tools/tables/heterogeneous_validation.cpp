// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints the table of docs/heterogeneous_skin.md: heterogeneous transport, and uniform layers times
// an albedo texture, against photons in an epidermis whose melanin varies.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "lamina/layers/materials/skin.h"
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"

namespace {

using namespace lamina;

constexpr double texel = 0.1;  // [mm]

/// Where the skin is dark and where light falls, over a patch that is its own mirror image, so that
/// it does not matter whether it repeats or is mirrored at its edges.
struct Scene {
  std::string name;
  int columns, rows;
  std::vector<bool> is_dark;
  std::vector<double> light;
};

bool in_middle_half(int i, int size) { return size / 4 <= i && i < size - size / 4; }

Scene scene_of(const std::string& pattern, bool is_striped) {
  Scene scene{pattern + (is_striped ? ", strips of light" : ", full light"), 96, 1, {}, {}};
  if (pattern == "disc") scene.columns = scene.rows = 48;
  for (int y = 0; y < scene.rows; ++y)
    for (int x = 0; x < scene.columns; ++x) {
      const int n = scene.columns;
      bool dark = in_middle_half(x, n);  // the half-plane: two edges far apart
      if (pattern == "stripes") dark = in_middle_half(x % 12, 12);
      if (pattern == "disc") dark = std::hypot(x + 0.5 - n / 2, y + 0.5 - n / 2) < 8.0;
      scene.is_dark.push_back(dark);
      scene.light.push_back(is_striped && !in_middle_half(x % 16, 16) ? 0.0 : 1.0);
    }
  return scene;
}

/// For each texel the first one that is like it: shifts and mirrors of a row, or mirrors of a disc,
/// under which the scene stays what it is.
std::vector<std::size_t> alike(const Scene& scene) {
  const int n = scene.columns, rows = scene.rows;
  std::vector<std::size_t> first(scene.light.size());
  std::iota(first.begin(), first.end(), std::size_t{0});
  const auto join = [&](const auto& moved) {
    const auto at = [&](std::size_t i) {
      return moved(static_cast<int>(i) % n, static_cast<int>(i) / n);
    };
    for (std::size_t i = 0; i < first.size(); ++i)
      if (scene.is_dark[i] != scene.is_dark[at(i)] || scene.light[i] != scene.light[at(i)]) return;
    for (std::size_t i = 0; i < first.size(); ++i) first[i] = std::min(first[i], first[at(i)]);
  };
  const auto number = [&](int x, int y) { return static_cast<std::size_t>(y * n + x); };
  for (int round = 0; round < 3; ++round) {
    for (int shift = 0; rows == 1 && shift < n; ++shift) {
      join([&](int x, int y) { return number((x + shift) % n, y); });
      join([&](int x, int y) { return number((n + shift - x) % n, y); });
    }
    join([&](int x, int y) { return number(n - 1 - x, y); });
    join([&](int x, int y) { return number(x, rows - 1 - y); });
    if (rows == n) join([&](int x, int y) { return number(y, x); });
  }
  return first;
}

LayerStack stack_of(SkinParameters skin, double wavelength) {
  skin.junction_absorption = 0.0;
  return skin_layer_stack(skin, wavelength);
}

struct Model {
  SkinParameters light_skin, dark_skin;
  double wavelength;
  double bright, dark, typical, dermis;  ///< absorption of the two epidermises, between them, below
  StackTables tables;
};

Model make_model(const SkinParameters& light_skin, const SkinParameters& dark_skin,
                 double wavelength) {
  const LayerStack solid = stack_of(light_skin, wavelength);
  MappedStack stack{1.0, {}, solid.ior_below()};
  for (const Layer& layer : solid.layers())
    stack.layers.push_back(
        {layer.medium.sigma_s, layer.medium.g, layer.medium.ior, layer.thickness});
  const double bright = epidermis_absorption(light_skin, wavelength);
  const double dark = epidermis_absorption(dark_skin, wavelength);
  const double typical = std::sqrt(dark * bright);
  const double dermis = dermis_absorption(light_skin, wavelength);
  return {light_skin,
          dark_skin,
          wavelength,
          bright,
          dark,
          typical,
          dermis,
          make_stack_tables(stack, OperatorTotals::radiative_transfer_profile,
                            std::vector<double>{typical, dermis})};
}

double entering(const LayerStack& stack) {
  const double r = (stack.layers()[0].medium.ior - 1.0) / (stack.layers()[0].medium.ior + 1.0);
  return 1.0 - r * r;
}

/// Exitance of each texel and its standard error, and the noise of all: root mean square over the
/// mean. Texels that are alike share their photons.
struct Truth {
  std::vector<double> exitance, error;
  double noise;
};

Truth by_photons(const Scene& scene, const Model& model, std::uint64_t photons) {
  std::vector<double> sigma_a;
  for (const bool is_dark : scene.is_dark) sigma_a.push_back(is_dark ? model.dark : model.bright);
  const PatchPhotons result =
      trace_patch_photons({.stack = stack_of(model.light_skin, model.wavelength),
                           .columns = scene.columns,
                           .rows = scene.rows,
                           .texel = texel,
                           .sigma_a = {sigma_a, {}},
                           .junction = {},
                           .irradiance = scene.light},
                          {.photons = photons, .seed = 1});
  const std::vector<std::size_t> first = alike(scene);
  const std::size_t size = first.size();
  std::vector<double> count(size), sums(size), variances(size);
  for (std::size_t i = 0; i < size; ++i) {
    count[first[i]] += 1.0;
    sums[first[i]] += result.exitance[i].value;
    variances[first[i]] += std::pow(result.exitance[i].standard_error, 2);
  }
  Truth truth{{}, {}, 0.0};
  double sum = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    truth.exitance.push_back(sums[first[i]] / count[first[i]]);
    truth.error.push_back(std::sqrt(variances[first[i]]) / count[first[i]]);
    sum += truth.exitance.back();
    variance += truth.error.back() * truth.error.back();
  }
  truth.noise = std::sqrt(variance * static_cast<double>(size)) / sum;
  return truth;
}

/// @param is_uniform  takes the mean absorption everywhere.
std::vector<double> by_transport(const Scene& scene, const Model& model, bool is_uniform,
                                 ProfileAt profile = ProfileAt::exit) {
  const LayerStack solid = stack_of(model.light_skin, model.wavelength);
  // A row of texels goes on for ever downward: 16 rows do, being mirrored.
  const int rows = std::max(scene.rows, 16);
  std::vector<Plane> sigma_a = {make_plane(scene.columns, rows),
                                make_plane(scene.columns, rows, static_cast<float>(model.dermis))};
  Plane light = make_plane(scene.columns, rows);
  for (std::size_t i = 0; i < light.values.size(); ++i) {
    const std::size_t from = i % scene.light.size();
    const double value = is_uniform            ? model.typical
                         : scene.is_dark[from] ? model.dark
                                               : model.bright;
    sigma_a[0].values[i] = static_cast<float>(value);
    light.values[i] = static_cast<float>(scene.light[from] * entering(solid));
  }
  const auto layers = make_heterogeneous_layers(model.tables, sigma_a,
                                                {make_plane(scene.columns, rows)}, texel, profile);
  const Plane out = transport(layers, light).reflected;
  return {out.values.begin(), out.values.begin() + static_cast<std::ptrdiff_t>(scene.light.size())};
}

/// Root mean square over the mean, without what the photons' noise adds to it.
double rms_error(const std::vector<double>& values, const std::vector<double>& truth,
                 double noise) {
  double error = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    error += (values[i] - truth[i]) * (values[i] - truth[i]);
    sum += truth[i];
  }
  const double size = static_cast<double>(truth.size());
  const double relative = error / size / (sum / size * sum / size);
  return std::sqrt(std::max(0.0, relative - noise * noise));
}

/// The largest error at one place, of the light there; of those that photons show, the one that
/// exceeds twice its noise by most.
Estimate largest_local_error(const std::vector<double>& values, const Truth& truth) {
  Estimate largest{0.0, 1.0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (truth.exitance[i] == 0.0) continue;
    const Estimate here{std::abs(values[i] / truth.exitance[i] - 1.0),
                        truth.error[i] / truth.exitance[i]};
    if (here.value - 2.0 * here.standard_error > largest.value - 2.0 * largest.standard_error)
      largest = here;
  }
  return largest;
}

std::string percent(double value) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * value);
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t photons = argc > 1 ? std::stoull(argv[1]) : 1'000'000;
  std::printf(
      "| melanin, light | band | profile at exit | profile of both ends | largest local error | "
      "albedo texture | noise, taken out |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  for (const double wavelength : {470.0, 575.0, 645.0}) {
    const Model model = make_model({.melanin = 0.01}, {.melanin = 0.06}, wavelength);
    for (const std::string pattern : {"half-plane", "stripes", "disc"}) {
      const Scene full = scene_of(pattern, false), strips = scene_of(pattern, true);
      const std::uint64_t count = photons * (pattern == "disc" ? 6 : 1);
      const auto truth = by_photons(full, model, count);
      const auto uniform = by_transport(full, model, true);
      const auto other = by_transport(full, model, false);
      for (const bool is_striped : {false, true}) {
        const Scene& scene = is_striped ? strips : full;
        const auto seen = is_striped ? by_photons(scene, model, count) : truth;
        const auto ours = is_striped ? by_transport(scene, model, false) : other;
        const auto both = by_transport(scene, model, false, ProfileAt::both);
        // The texture makes the fully lit picture exact; under other light it stays as it is.
        auto textured = by_transport(scene, model, true);
        for (std::size_t i = 0; i < textured.size(); ++i)
          textured[i] *= truth.exitance[i] / uniform[i];
        const Estimate local = largest_local_error(both, seen);
        std::printf("| %s | %.0f nm | %.1f %% | %.1f %% | %.1f ± %.1f %% | %s | %.1f %% |\n",
                    scene.name.c_str(), wavelength,
                    100.0 * rms_error(ours, seen.exitance, seen.noise),
                    100.0 * rms_error(both, seen.exitance, seen.noise), 100.0 * local.value,
                    100.0 * local.standard_error,
                    is_striped ? percent(rms_error(textured, seen.exitance, seen.noise)).c_str()
                               : "0 by construction",
                    100.0 * seen.noise);
        std::fflush(stdout);
        if (argc > 2)
          for (std::size_t i = 0; i < std::min<std::size_t>(96, ours.size()); ++i)
            std::fprintf(stderr, "%s %g %zu %.5f %.5f %.5f %.5f\n", scene.name.c_str(), wavelength,
                         i, seen.exitance[i], ours[i], both[i], textured[i]);
      }
    }
  }
}
