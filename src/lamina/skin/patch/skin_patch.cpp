// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/patch/skin_patch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numeric>

#include "lamina/base/core/parallel_parts.h"
#include "lamina/base/image/resample.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/heterogeneous/oblique_light.h"

namespace lamina {
namespace {

/// One number as a plane, or that of each texel.
Plane plane_of(const std::vector<float>& values, int width, int height) {
  if (values.size() == 1) return make_plane(width, height, values[0]);
  return {width, height, values};
}

/// Fraction of the light arriving at an angle that enters, at each texel, or one. Where roughness
/// varies it is interpolated.
std::vector<float> entering_fractions(const Material& material, std::size_t band, double theta,
                                      const std::vector<float>& roughness) {
  const auto entering = [&](double alpha) {
    Material with = material;
    with.layers.front().top.roughness = alpha;
    return entry_transmittance(layer_stack(with, band), {.theta = theta});
  };
  if (roughness.size() == 1) return {static_cast<float>(entering(roughness[0]))};
  constexpr std::size_t steps = 16;
  const auto [low, high] = std::ranges::minmax(roughness);
  std::vector<double> table;
  for (std::size_t i = 0; i <= steps; ++i)
    table.push_back(entering(std::lerp(static_cast<double>(low), static_cast<double>(high),
                                       static_cast<double>(i) / steps)));
  std::vector<float> fractions;
  for (const float alpha : roughness) {
    const double place = static_cast<double>((alpha - low) / (high - low)) * steps;
    const auto i = std::min(static_cast<std::size_t>(place), steps - 1);
    fractions.push_back(
        static_cast<float>(std::lerp(table[i], table[i + 1], place - static_cast<double>(i))));
  }
  return fractions;
}

/// Fractions that enter times the gain of oblique light, at each texel, or one.
std::vector<float> with_gains(std::vector<float> entering, const ObliqueLight& oblique,
                              std::size_t texels) {
  if (!oblique.is_even() && entering.size() == 1) entering.resize(texels, entering[0]);
  for (std::size_t i = 0; i < entering.size(); ++i)
    entering[i] *= static_cast<float>(oblique.gain(oblique.is_even() ? 0 : i));
  return entering;
}

/// Largest error of the tables at the states that a patch has.
double largest_fit_error(const StackTables& tables, const std::vector<LayerTexels>& texels) {
  double largest = 0.0;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const auto [low, high] = std::ranges::minmax(texels[i].sigma_a);
    for (const GaussianTable* table : operator_tables(tables.layers[i]))
      for (std::size_t node = 0; node < table->error.size(); ++node) {
        const double at = node_state(tables.lattices[i], node).sigma_a;
        if (static_cast<double>(low) / 1.05 <= at && at <= static_cast<double>(high) * 1.05)
          largest = std::max(largest, table->error[node]);
      }
  }
  return largest;
}

void put_channel(Image& image, std::size_t channel, const Plane& plane) {
  for (std::size_t i = 0; i < plane.values.size(); ++i)
    image.pixels[i * image.channel_count() + channel] = plane.values[i];
}

/// Fills red, green and blue, the three channels from `first` on, from the bands in front of them.
void add_colors(Image& image, std::size_t first, const Material& material) {
  const BandSet& bands = material.bands;
  const BandWeights weights =
      material.skin ? make_skin_band_weights(bands, material.skin->skin) : make_band_weights(bands);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      float* pixel = image.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (std::size_t b = 0; b < bands.size(); ++b)
          sum += weights[b][c] * static_cast<double>(pixel[first - bands.size() + b]);
        pixel[first + c] = static_cast<float>(sum);
      }
    }
}

/// Multiplies what leaves by a texture's reflectance in a band over that in even light.
void texture(const SkinPatch& patch, std::size_t band, const HeterogeneousLayers& layers,
             const std::vector<float>& entering, Plane& leaving, const Progress& progress) {
  const Plane even =
      transport(layers, plane_of(entering, patch.width, patch.height), patch.transport, progress)
          .reflected;
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

PatchMaterial material_of(const SkinPatch& patch) {
  PatchMaterial result;
  const auto add = [&](const MappableNumber& number, const Image& values) {
    const bool fits = values.width == patch.width && values.height == patch.height;
    result.maps.push_back(
        {number, values.channel_count(),
         fits ? values.pixels : resampled(values, patch.width, patch.height).pixels});
  };
  if (patch.material) {
    result.material = patch.material->material;
    for (const MaterialMap& map : patch.material->maps) add(map.number, map.values);
    return result;
  }
  const SkinMaps& skin = patch.skin;
  result.material.bands = patch.bands;
  result.material.skin = SkinRecipe{skin.skin, skin.constants};
  result.material.layers = skin_layers(skin.skin, patch.bands.wavelengths());
  result.material.ior_above.assign(patch.bands.size(), 1.0);
  result.material.ior_below.assign(patch.bands.size(), 1.0);
  if (std::isinf(skin.skin.dermis_thickness))
    result.material.ior_below = result.material.layers.back().ior;
  for (const SkinMap& map : skin.maps) {
    const auto ranges = skin_parameter_ranges();
    const auto range = std::ranges::find(ranges, map.parameter, &SkinParameterRange::value);
    if (map.parameter)
      add({.of = MappableNumber::Of::skin,
           .part = static_cast<std::size_t>(range - ranges.begin())},
          map.values);
    else
      add({.of = MappableNumber::Of::ink, .part = map.ink}, map.values);
  }
  for (const MaterialMap& map : skin.others) add(map.number, map.values);
  return result;
}

SkinPatchResult render_skin_patch(const SkinPatch& patch, const std::optional<DiskCache>& cache,
                                  const Progress& progress) {
  const PatchMaterial made_of = material_of(patch);
  const Material& material = made_of.material;
  const std::size_t bands = material.bands.size();
  const bool is_rgb = material.bands.is_rgb();
  const bool lets_through = lets_light_through(material);
  SkinPatchResult result;
  result.bands.resize(bands);
  result.tables.resize(bands);
  std::vector<std::string> channels;
  for (std::size_t b = 0; b < bands; ++b)
    channels.push_back(band_name(material.bands, b) + (is_rgb ? "" : "nm"));
  for (const char* name : {"R", "G", "B"})
    if (!is_rgb) channels.emplace_back(name);
  const std::size_t first_transmitted = channels.size();
  for (std::size_t c = 0; lets_through && c < first_transmitted; ++c)
    channels.push_back("transmitted." + channels[c]);
  result.image = make_image(patch.width, patch.height, channels);

  const Plane arriving = plane_of(patch.light.pixels, patch.width, patch.height);
  const double all_light = std::accumulate(arriving.values.begin(), arriving.values.end(), 0.0);
  std::atomic<double> table_seconds = 0.0, transport_seconds = 0.0;
  // Tables take most of the time where the cache does not have them.
  constexpr double with_tables = 0.6, with_layers = 0.8;
  const auto light_band = [&](std::size_t b, const Progress& of_band) {
    const BandTexels texels = band_texels(material, made_of.maps, arriving.values.size(), b);
    result.tables[b] = [&] {
      const Stopwatch watch(table_seconds);
      return cached_stack_tables(cache, mapped_stack(material, b, texels), patch.totals,
                                 reference_absorptions(texels), {},
                                 part_of(of_band, 0.0, with_tables));
    }();
    const StackTables& tables = result.tables[b];
    const Stopwatch watch(transport_seconds);
    std::vector<Plane> absorbance;
    for (const std::vector<float>& sheet : texels.absorbance)
      absorbance.push_back(plane_of(sheet, patch.width, patch.height));
    const HeterogeneousLayers layers = make_heterogeneous_layers(
        tables, patch.width, patch.height, texels.layers, absorbance, patch.mm_per_texel,
        patch.profile, 5e-5, part_of(of_band, with_tables, with_layers));
    Plane light = arriving;
    const ObliqueLight oblique(mapped_stack(material, b, texels), texels.layers,
                               typical_absorbances(texels), patch.theta);
    const std::vector<float> entering =
        with_gains(entering_fractions(material, b, patch.theta, texels.layers[0].roughness),
                   oblique, light.values.size());
    for (std::size_t i = 0; i < light.values.size(); ++i)
      light.values[i] *= entering[entering.size() > 1 ? i : 0];
    const Progress going_on = part_of(of_band, with_layers, with_layers);
    TransportOptions options = patch.transport;
    if (!patch.interlayer_bounces.empty()) options.interlayer_bounces = patch.interlayer_bounces[b];
    TransportResult out = transport(layers, light, options, going_on);
    if (!patch.albedo.pixels.empty()) texture(patch, b, layers, entering, out.reflected, going_on);
    put_channel(result.image, b, out.reflected);
    for (float& value : out.transmitted.values)
      value *= static_cast<float>(oblique.transmission_over_reflection());
    if (lets_through) put_channel(result.image, first_transmitted + b, out.transmitted);
    const double leaving =
        std::accumulate(out.reflected.values.begin(), out.reflected.values.end(), 0.0);
    result.bands[b] = {.mean_reflectance = all_light > 0.0 ? leaving / all_light : 0.0,
                       .fit_error = largest_fit_error(tables, texels.layers),
                       .interlayer_bounces = out.interlayer_bounces,
                       .last_bounce = out.last_bounce};
  };
  parallel_parts(bands, light_band, progress);
  if (!is_rgb) add_colors(result.image, bands, material);
  if (!is_rgb && lets_through) add_colors(result.image, first_transmitted + bands, material);
  result.table_seconds = table_seconds;
  result.transport_seconds = transport_seconds;
  return result;
}

}  // namespace lamina
