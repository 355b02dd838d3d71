// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// A capture whose light is that of photons: the synthetic skin of the tests in six bands, 10 mm
// with a lit window of 7.5 mm, as OUT.exr (channels "400nm" .., and "se.400nm" .., their standard
// errors) and OUT_truth.exr (the numbers of the skin). docs/acquire_accuracy.md has
// what `lamina acquire` makes of it.
//
//   photon_capture SIZE PHOTONS OUT      e.g. 48 2e7 photons, an hour
//
// The band at 700 nm gets a quarter of the photons: each takes ten times as long.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "lamina/base/image/files/image_file.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"
#include "skin/acquire/inversion/synthetic_patch.h"

int main(int argc, char** argv) {
  using namespace lamina;
  if (argc != 4) return std::fprintf(stderr, "usage: photon_capture SIZE PHOTONS OUT\n"), 2;
  const int size = std::atoi(argv[1]);
  const double photons = std::atof(argv[2]);
  const std::string out = argv[3];
  if (size < 4 || size > 1024 || !(photons >= 1.0 && photons <= 1e12))
    return std::fprintf(stderr, "SIZE must be in [4, 1024], PHOTONS in [1, 1e12]\n"), 2;
  const SyntheticSkin skin;
  const double step = 10.0 / size;
  const std::vector<double> bands = {400.0, 420.0, 480.0, 520.0, 580.0, 700.0};
  SkinParameters base;
  base.junction_absorption = 0.0;

  Image truth = make_image(
      size, size,
      {"melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis", "carotene"});
  std::vector<double> irradiance;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double at_x = (x + 0.5) * step - 5.0, at_y = (y + 0.5) * step - 5.0;
      const auto numbers = skin.at(at_x, at_y);
      for (std::size_t n = 0; n < numbers.size(); ++n)
        truth.at(x, y)[n] = static_cast<float>(numbers[n]);
      irradiance.push_back(std::max(std::abs(at_x), std::abs(at_y)) < 3.75 ? 1.0 : 0.0);
    }
  save_exr(truth, out + "_truth.exr", ExrPrecision::single_float);

  std::vector<std::string> channels;
  for (const char* kind : {"", "se."})
    for (const double nm : bands) channels.push_back(kind + std::to_string(std::lround(nm)) + "nm");
  Image image = make_image(size, size, channels);
  const std::size_t texels = irradiance.size();
  for (std::size_t b = 0; b < bands.size(); ++b) {
    std::vector<double> epidermis(texels), dermis(texels);
    for (std::size_t i = 0; i < texels; ++i) {
      SkinParameters here = base;
      for (std::size_t n = 0; n < SyntheticSkin::numbers; ++n)
        here.*SyntheticSkin::members[n] =
            static_cast<double>(truth.pixels[SyntheticSkin::numbers * i + n]);
      epidermis[i] = epidermis_absorption(here, bands[b]);
      dermis[i] = dermis_absorption(here, bands[b]);
    }
    const double count = bands[b] > 600.0 ? photons / 4.0 : photons;
    const PatchPhotons light =
        trace_patch_photons({.stack = skin_layer_stack(base, bands[b]),
                             .columns = size,
                             .rows = size,
                             .texel = step,
                             .sigma_a = {epidermis, dermis},
                             .junction = {},
                             .irradiance = irradiance},
                            {.photons = static_cast<std::uint64_t>(count), .seed = b + 1});
    double mean = 0.0, error = 0.0, lit = 0.0;
    for (std::size_t i = 0; i < texels; ++i) {
      const Estimate& each = light.exitance[i];
      image.pixels[2 * bands.size() * i + b] = static_cast<float>(each.value);
      image.pixels[2 * bands.size() * i + bands.size() + b] =
          static_cast<float>(each.standard_error);
      mean += irradiance[i] * each.value;
      error += irradiance[i] * each.standard_error;
      lit += irradiance[i];
    }
    std::printf("%g nm: mean %.4f, noise %.2f %%\n", bands[b], mean / lit, 100.0 * error / mean);
    std::fflush(stdout);
    save_exr(image, out + ".exr", ExrPrecision::single_float);
  }
  return 0;
}
