// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The tables of docs/leaf_maps.md: what photographs of leaves in many bands tell, pixel by pixel.
//
//     leaf_maps [--bin N] [--bands N] [--from NM] [--light DEGREES] [--share S] [--shared]
//     [--write FOLDER] CUBE.hdr...
//
// CUBE.hdr is an ENVI image of reflectance factors. Means of N x N pixels (1 if not given) are
// fitted, in N bands of equal width (40) from NM (420) to 990 nm, under light so many degrees (19)
// from the normal; S of what absorbs (.7) is in the palisade; with --shared what pixels miss alike
// is taken off. FOLDER gets the maps with their deviations (EXR), and the photograph beside what
// the maps reflect, above the maps (PNG).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/envi_file.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/skin/acquire/leaf/leaf_pixels.h"

namespace {

using namespace lamina;

constexpr double first_nm = 420.0, last_nm = 990.0;

struct Settings {
  int bin = 1, bands = 40;
  double from = first_nm, light = 19.0, share = 0.7;
  bool is_shared = false;
  std::filesystem::path folder;
  std::vector<std::filesystem::path> cubes;
};

Settings read_settings(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (word == "--shared") {
      settings.is_shared = true;
      continue;
    }
    if (!word.starts_with("--")) {
      settings.cubes.emplace_back(word);
      continue;
    }
    if (word == "--bin") settings.bin = std::max(1, std::atoi(value));
    if (word == "--bands") settings.bands = std::max(9, std::atoi(value));
    if (word == "--from") settings.from = std::atof(value);
    if (word == "--light") settings.light = std::atof(value);
    if (word == "--share") settings.share = std::atof(value);
    if (word == "--write") settings.folder = value;
    ++i;
  }
  return settings;
}

Image binned(const Image& image, int side) {
  Image result = make_image(image.width / side, image.height / side, image.channels);
  const float share = 1.0f / static_cast<float>(side * side);
  for (int y = 0; y < result.height * side; ++y)
    for (int x = 0; x < result.width * side; ++x)
      for (std::size_t b = 0; b < image.channel_count(); ++b)
        result.at(x / side, y / side)[b] += share * image.at(x, y)[b];
  return result;
}

/// The number at a share of the sorted ones.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

std::vector<double> known(const Image& map) {
  std::vector<double> values;
  for (const float value : map.pixels)
    if (std::isfinite(value)) values.push_back(static_cast<double>(value));
  return values;
}

void print_maps(const LeafMaps& maps, const std::vector<double>& wavelengths) {
  const std::vector<double> misfit = known(maps.misfit);
  std::printf(
      "  residual RMS %.2f / %.2f %% of reflectance, median / 95 %% of pixels; residuals of "
      "neighbors correlate by %.2f\n",
      100.0 * quantile(misfit, 0.5), 100.0 * quantile(misfit, 0.95), maps.residual_correlation);
  std::printf("  | number | 5 %% | median | 95 %% | deviation | prior share |\n");
  for (const LeafMap& map : maps.maps) {
    const std::vector<double> values = known(map.values);
    std::printf("  | %s | %.4g | %.4g | %.4g | %.3f | %.2f |\n", map.parameter.name.c_str(),
                quantile(values, 0.05), quantile(values, 0.5), quantile(values, 0.95),
                quantile(known(map.deviations), 0.5), map.prior_share);
  }
  std::printf("  nm: residual RMS, mean, error used, background [%%]\n");
  for (std::size_t b = 0; b < wavelengths.size(); b += 3)
    std::printf("    %.0f: %.2f %+.2f %.2f %.1f\n", wavelengths[b], 100.0 * maps.residual[b],
                100.0 * maps.bias[b], 100.0 * maps.noise[b], 100.0 * maps.ground[b]);
  std::printf("  correlations beyond .7:");
  for (std::size_t n = 0; n < maps.maps.size(); ++n)
    for (std::size_t m = n + 1; m < maps.maps.size(); ++m)
      if (std::abs(maps.correlation(n, m)) > 0.7)
        std::printf(" %s-%s %+.2f", maps.maps[n].parameter.name.c_str(),
                    maps.maps[m].parameter.name.c_str(), maps.correlation(n, m));
  std::printf("\n");
}

/// The photograph, beside it what the maps reflect, and below five maps, from black to white over 2
/// to 98 % of their pixels.
void write(const LeafMaps& maps, const Image& photograph, const std::vector<double>& wavelengths,
           const std::filesystem::path& folder, const std::string& name) {
  std::filesystem::create_directories(folder);
  Image all = make_image(maps.width, maps.height, {});
  std::vector<const Image*> planes;
  for (const LeafMap& map : maps.maps) {
    all.channels.push_back(map.parameter.name);
    planes.push_back(&map.values);
    all.channels.push_back(map.parameter.name + ".deviation");
    planes.push_back(&map.deviations);
  }
  all.channels.emplace_back("misfit");
  planes.push_back(&maps.misfit);
  for (std::size_t i = 0; i < maps.misfit.pixels.size(); ++i)
    for (const Image* plane : planes) all.pixels.push_back(plane->pixels[i]);
  save_exr(all, folder / (name + "_maps.exr"), ExrPrecision::single_float);

  std::vector<double> visible;
  for (const double nm : wavelengths)
    if (nm < 740.0) visible.push_back(nm);
  const BandWeights weights = visible.empty() ? BandWeights() : make_band_weights(BandSet(visible));
  constexpr float exposure = 2.0f;
  const int rows = 1 + static_cast<int>(maps.maps.size() + 1) / 2;
  Image sheet = make_image(2 * maps.width, rows * maps.height, {"R", "G", "B"});
  for (int y = 0; y < maps.height; ++y)
    for (int x = 0; x < maps.width; ++x)
      for (const bool is_model : {false, true}) {
        const float* from = (is_model ? maps.predicted : photograph).at(x, y);
        float* to = sheet.at(x + (is_model ? maps.width : 0), y);
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t b = 0; b < visible.size(); ++b)
            to[c] += exposure * static_cast<float>(weights[b][c]) * from[b];
      }
  for (std::size_t n = 0; n < maps.maps.size(); ++n) {
    const Image& map = maps.maps[n].values;
    const std::vector<double> values = known(map);
    const double low = quantile(values, 0.02), high = quantile(values, 0.98);
    for (int y = 0; y < maps.height; ++y)
      for (int x = 0; x < maps.width; ++x) {
        const auto value = static_cast<double>(*map.at(x, y));
        float* to = sheet.at(x + static_cast<int>(n % 2) * maps.width,
                             y + (1 + static_cast<int>(n / 2)) * maps.height);
        for (std::size_t c = 0; c < 3; ++c)
          to[c] = std::isfinite(value)
                      ? static_cast<float>(
                            std::pow(std::clamp((value - low) / (high - low), 0.0, 1.0), 2.2))
                      : 0.0f;
      }
  }
  save_png(sheet, folder / (name + ".png"));
}

struct Cube {
  std::vector<double> wavelengths;
  Image image;
};

Cube load(const std::filesystem::path& file, double from, const Settings& settings) {
  Cube cube;
  EnviSelection selection;
  const double width = (last_nm - from) / settings.bands;
  for (int b = 0; b < settings.bands; ++b) {
    cube.wavelengths.push_back(from + width * (b + 0.5));
    selection.bands.push_back(
        {.wavelength = cube.wavelengths.back(), .shape = EnviBandShape::box, .width = width});
  }
  MemoryBudget memory;
  cube.image = binned(load_envi(file, selection, memory), settings.bin);
  return cube;
}

void fit_cube(const std::filesystem::path& file, const Settings& settings) {
  const Cube cube = load(file, settings.from, settings);
  LeafPixelOptions options;
  options.incidence.theta = settings.light * std::numbers::pi / 180.0;
  options.leaf.palisade_share = settings.share;
  if (settings.from > first_nm) {  // all bands say where the leaf is, and what lies behind it
    const Cube whole = load(file, first_nm, settings);
    const LeafMaps found = fit_leaf_pixels(whole.image, whole.wavelengths, options);
    options.has_background = false;
    options.mask = make_pixel_mask(found.width, found.height);
    for (std::size_t i = 0; i < found.kinds.size(); ++i)
      if (found.kinds[i] != LeafPixelKind::leaf) options.mask->mark(i, PixelFault::excluded);
    options.ground.assign(cube.wavelengths.size(), found.ground.back());
  }
  const auto start = std::chrono::steady_clock::now();
  options.shares_misfit = settings.is_shared;
  const LeafMaps maps = fit_leaf_pixels(cube.image, cube.wavelengths, options);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "%s, bins of %d, %d bands: %zu pixels of leaf, %zu of its edge, %zu of background; %.2f s\n",
      file.stem().c_str(), settings.bin, settings.bands, maps.counts[0], maps.counts[3],
      maps.counts[2], seconds);
  print_maps(maps, cube.wavelengths);
  if (!settings.folder.empty())
    write(maps, cube.image, cube.wavelengths, settings.folder, file.stem().string());
}

}  // namespace

int main(int argc, char** argv) {
  const Settings settings = read_settings(argc, argv);
  if (settings.cubes.empty()) {
    std::fprintf(stderr,
                 "usage: leaf_maps [--bin N] [--bands N] [--from NM] [--light DEGREES] [--share S] "
                 "[--shared] [--write FOLDER] CUBE.hdr...\n");
    return 2;
  }
  try {
    for (const std::filesystem::path& cube : settings.cubes) fit_cube(cube, settings);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
