// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin_patch/skin_patch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "lamina/core/parallel.h"
#include "lamina/image/resample.h"
#include "lamina/optics/layer_stack.h"
#include "lamina/reflectance/skin_colors.h"
#include "lamina/scattering/diffusion/diffuse_boundary.h"

namespace lamina {
namespace {

Plane plane_of(const Image& image) { return {image.width, image.height, image.pixels}; }

/// Fraction of the light arriving at an angle that enters.
double entering_fraction(const SkinParameters& skin, double wavelength, double theta) {
  return entry_transmittance(skin_layer_stack(skin, wavelength), {.theta = theta});
}

double largest_fit_error(const StackTables& tables, const std::vector<Plane>& sigma_a) {
  double largest = 0.0;
  for (std::size_t i = 0; i < sigma_a.size(); ++i) {
    const AbsorptionRange range = absorption_range(sigma_a[i], tables.grid);
    const LayerTables& layer = tables.layers[i];
    for (const GaussianTable* table : operator_tables(layer))
      for (std::size_t row = 0; row < table->error.size(); ++row) {
        const double at = row_absorption(tables.grid, static_cast<double>(row));
        if (range.lowest / 1.05 <= at && at <= range.highest * 1.05)
          largest = std::max(largest, table->error[row]);
      }
  }
  return largest;
}

void put_channel(Image& image, std::size_t channel, const Plane& plane) {
  for (std::size_t i = 0; i < plane.values.size(); ++i)
    image.pixels[i * image.channel_count() + channel] = plane.values[i];
}

/// Fills "R", "G", "B", the three channels from `first` on, from the bands in front.
void add_colors(Image& image, std::size_t first, const BandSet& bands, const SkinParameters& skin) {
  const BandWeights weights = make_skin_band_weights(bands, skin);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      float* pixel = image.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (std::size_t b = 0; b < bands.size(); ++b)
          sum += weights[b][c] * static_cast<double>(pixel[b]);
        pixel[first + c] = static_cast<float>(sum);
      }
    }
}

/// Multiplies what leaves by a texture's reflectance in a band over that in even light.
void texture(const SkinPatch& patch, std::size_t band, const HeterogeneousLayers& layers,
             float entering, Plane& leaving) {
  const Plane even =
      transport(layers, make_plane(patch.width, patch.height, entering), patch.transport).reflected;
  for (std::size_t i = 0; i < even.values.size(); ++i)
    if (even.values[i] > 0.0f)
      leaving.values[i] *=
          patch.albedo.pixels[i * patch.albedo.channel_count() + band] / even.values[i];
}

class Stopwatch {
 public:
  explicit Stopwatch(std::atomic<double>& sum) : sum_(sum) {}
  ~Stopwatch() {
    sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  std::atomic<double>& sum_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

double typical_absorption(std::span<const float> sigma_a) {
  double sum = 0.0;
  for (const float value : sigma_a) sum += std::log(static_cast<double>(value));
  const double mean = sum / static_cast<double>(sigma_a.size());
  const auto [low, high] = std::ranges::minmax(sigma_a);
  return std::exp(low == high ? mean : std::round(4.0 * mean) / 4.0);
}

MappedStack mapped_skin_stack(const SkinParameters& skin, double wavelength) {
  SkinParameters without_sheet = skin;  // the sheet between the layers is none of them
  without_sheet.junction_absorption = 0.0;
  const LayerStack solid = skin_layer_stack(without_sheet, wavelength);
  MappedStack stack{.ior_above = solid.ior_above(), .layers = {}, .ior_below = solid.ior_below()};
  for (const Layer& layer : solid.layers())
    stack.layers.push_back(
        {layer.medium.sigma_s, layer.medium.g, layer.medium.ior, layer.thickness});
  return stack;
}

SkinPlanes skin_planes(const SkinMaps& maps, int width, int height, double wavelength) {
  const SkinSpectrum spectrum = skin_spectrum(wavelength);
  std::vector<Image> fitting;  // maps of another size, resampled
  fitting.reserve(maps.maps.size());
  std::vector<const float*> values;
  for (const SkinMap& map : maps.maps) {
    const bool fits = map.values.width == width && map.values.height == height;
    values.push_back(
        (fits ? map.values : fitting.emplace_back(resampled(map.values, width, height)))
            .pixels.data());
  }
  Plane epidermis = make_plane(width, height), dermis = epidermis, sheet = epidermis;
  SkinParameters skin = maps.skin;
  const double junction = junction_factor(skin, wavelength);
  for (std::size_t i = 0; i < epidermis.values.size(); ++i) {
    for (std::size_t m = 0; m < values.size(); ++m)
      skin.*maps.maps[m].parameter = static_cast<double>(values[m][i]);
    constexpr double least = 1e-6;  // [1/mm] so that a logarithm exists
    epidermis.values[i] = static_cast<float>(std::max(least, epidermis_absorption(skin, spectrum)));
    dermis.values[i] = static_cast<float>(std::max(least, dermis_absorption(skin, spectrum)));
    sheet.values[i] = static_cast<float>(junction * skin.junction_absorption);
  }
  if (std::isinf(maps.skin.dermis_thickness))
    return {{std::move(epidermis), std::move(dermis)}, {std::move(sheet)}};
  return {{epidermis, std::move(dermis), epidermis}, {sheet, sheet}};
}

SkinPatchResult render_skin_patch(const SkinPatch& patch, const std::optional<DiskCache>& cache,
                                  const Progress& progress) {
  const std::size_t bands = patch.bands.size();
  const bool is_fold = std::isfinite(patch.skin.skin.dermis_thickness);
  SkinPatchResult result;
  result.bands.resize(bands);
  result.tables.resize(bands);
  std::vector<std::string> channels;
  for (std::size_t b = 0; b < bands; ++b) channels.push_back(band_name(patch.bands, b) + "nm");
  for (const char* name : {"R", "G", "B"}) channels.emplace_back(name);
  for (std::size_t b = 0; is_fold && b < bands; ++b)
    channels.push_back("transmitted." + channels[b]);
  result.image = make_image(patch.width, patch.height, channels);

  const Plane arriving = plane_of(patch.light);
  const double all_light = std::accumulate(arriving.values.begin(), arriving.values.end(), 0.0);
  std::atomic<double> table_seconds = 0.0, transport_seconds = 0.0;
  const auto light_band = [&](std::size_t b) {
    const double wavelength = patch.bands.wavelengths()[b];
    const SkinPlanes planes = skin_planes(patch.skin, patch.width, patch.height, wavelength);
    std::vector<double> reference;
    for (const Plane& sigma_a : planes.sigma_a)
      reference.push_back(typical_absorption(sigma_a.values));
    result.tables[b] = [&] {
      const Stopwatch watch(table_seconds);
      return cached_stack_tables(cache, mapped_skin_stack(patch.skin.skin, wavelength),
                                 patch.totals, reference);
    }();
    const StackTables& tables = result.tables[b];
    const Stopwatch watch(transport_seconds);
    const HeterogeneousLayers layers =
        make_heterogeneous_layers(tables, planes.sigma_a, planes.absorbance, patch.mm_per_texel);
    Plane light = arriving;
    const auto entering =
        static_cast<float>(entering_fraction(patch.skin.skin, wavelength, patch.theta));
    for (float& value : light.values) value *= entering;
    TransportResult out = transport(layers, light, patch.transport);
    if (!patch.albedo.pixels.empty()) texture(patch, b, layers, entering, out.reflected);
    put_channel(result.image, b, out.reflected);
    if (is_fold) put_channel(result.image, bands + 3 + b, out.transmitted);
    const double leaving =
        std::accumulate(out.reflected.values.begin(), out.reflected.values.end(), 0.0);
    result.bands[b] = {.mean_reflectance = all_light > 0.0 ? leaving / all_light : 0.0,
                       .fit_error = largest_fit_error(tables, planes.sigma_a),
                       .interlayer_bounces = out.interlayer_bounces,
                       .last_bounce = out.last_bounce};
  };
  parallel_for(bands, light_band, progress);
  add_colors(result.image, bands, patch.bands, patch.skin.skin);
  result.table_seconds = table_seconds;
  result.transport_seconds = transport_seconds;
  return result;
}

}  // namespace lamina
