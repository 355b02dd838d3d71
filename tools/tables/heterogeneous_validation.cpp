// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints the table of docs/heterogeneous_skin.md: heterogeneous transport, and uniform layers times
// an albedo texture, against photons in an epidermis whose melanin varies.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/materials/skin.h"
#include "lamina/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/scattering/monte_carlo/patch_photons.h"

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

/// Exitance of each texel, and the noise of all: root mean square over the mean.
struct Truth {
  std::vector<double> exitance;
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
  Truth truth{{}, 0.0};
  double sum = 0.0, variance = 0.0;
  for (const Estimate& e : result.exitance) {
    truth.exitance.push_back(e.value);
    sum += e.value;
    variance += e.standard_error * e.standard_error;
  }
  truth.noise = std::sqrt(variance * static_cast<double>(result.exitance.size())) / sum;
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
  const auto layers =
      make_heterogeneous_layers(model.tables, sigma_a, {make_plane(scene.columns, rows)}, texel,
                                profile);
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

std::string percent(double value) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * value);
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t photons = argc > 1 ? std::stoull(argv[1]) : 1'000'000;
  std::printf(
      "| melanin, light | band | profile at exit | profile of both ends | albedo texture | noise, "
      "taken out |\n");
  std::printf("|---|---|---|---|---|---|\n");
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
        std::printf("| %s | %.0f nm | %.1f %% | %.1f %% | %s | %.1f %% |\n", scene.name.c_str(),
                    wavelength, 100.0 * rms_error(ours, seen.exitance, seen.noise),
                    100.0 * rms_error(both, seen.exitance, seen.noise),
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
