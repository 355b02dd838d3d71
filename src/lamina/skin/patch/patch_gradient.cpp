// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/patch/patch_gradient.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/parallel_parts.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/heterogeneous/oblique_light.h"
#include "lamina/solve/scattering/heterogeneous/transport_gradient.h"

namespace lamina {
namespace {

constexpr std::array of_scattering = {
    &SkinParameters::scattering_scale, &SkinParameters::scattering_power,
    &SkinParameters::epidermis_thickness, &SkinParameters::dermis_thickness};

void check(const SkinPatch& patch) {
  if (patch.material)
    throw InvalidInput("gradient: the patch must be of skin, but is of a material");
  if (!patch.albedo.pixels.empty())
    throw InvalidInput("gradient: the patch must have no albedo, but has one");
  if (!patch.skin.others.empty())
    throw InvalidInput("gradient: maps must be of absorption, but one is of oil or roughness");
  for (const SkinMap& map : patch.skin.maps) {
    if (!map.parameter || std::ranges::count(of_scattering, map.parameter) != 0)
      throw InvalidInput("gradient: maps must be of what absorbs, but one is of " + map.name);
    if (map.values.channel_count() != 1 || map.values.width != patch.width ||
        map.values.height != patch.height)
      throw InvalidInput("gradient: maps must have the patch's size, but " + map.name + " has not");
  }
}

Plane full_plane(const std::vector<float>& values, int width, int height) {
  if (values.size() == 1) return make_plane(width, height, values[0]);
  return {width, height, values};
}

// Of ranges beyond the absorption of maps that are nearly even: without a range there is no
// derivative.
constexpr double margin = 1.05;

/// What absorbs in skin at a wavelength: epidermis, dermis, and the sheet between them.
std::array<double, 3> absorption(const SkinParameters& skin, const SkinSpectrum& spectrum,
                                 double wavelength) {
  return {epidermis_absorption(skin, spectrum), dermis_absorption(skin, spectrum),
          junction_absorbance(skin, wavelength)};
}

}  // namespace

struct DifferentiableSkinPatch::Model {
  struct Band {
    std::unique_ptr<DifferentiableTransport<float>> transport;
    std::vector<float> entering;  ///< [texel] or one
    /// [layer][texel] derivative of the logarithm of `entering` by absorption; empty: 0
    std::vector<std::vector<float>> log_entering_by_sigma_a;
    [[nodiscard]] float entering_at(std::size_t texel) const {
      return entering[entering.size() > 1 ? texel : 0];
    }
  };
  SkinPatch patch;
  std::vector<Band> bands;
  std::vector<Plane> light;
};

DifferentiableSkinPatch::DifferentiableSkinPatch(SkinPatch patch,
                                                 const std::optional<DiskCache>& cache,
                                                 const Progress& progress)
    : model_(std::make_unique<Model>()) {
  check(patch);
  model_->patch = std::move(patch);
  const SkinPatch& p = model_->patch;
  const PatchMaterial made_of = material_of(p);
  const std::size_t bands = p.bands.size();
  model_->bands.resize(bands);
  model_->light.resize(bands);
  parallel_parts(
      bands,
      [&](std::size_t b, const Progress& of_band) {
        const BandTexels texels =
            band_texels(made_of.material, made_of.maps, p.light.pixels.size(), b);
        const StackTables tables =
            cached_stack_tables(cache, mapped_stack(made_of.material, b, texels), p.totals,
                                reference_absorptions(texels), {}, part_of(of_band, 0.0, 0.5));
        Model::Band& band = model_->bands[b];
        const ObliqueLight oblique(mapped_stack(made_of.material, b, texels), texels.layers,
                                   typical_absorbances(texels), p.theta);
        const double entering =
            entry_transmittance(layer_stack(made_of.material, b), {.theta = p.theta});
        const std::size_t count = oblique.is_even() ? 1 : p.light.pixels.size();
        for (std::size_t t = 0; t < count; ++t)
          band.entering.push_back(static_cast<float>(entering * oblique.gain(t)));
        for (std::size_t l = 0; l < texels.layers.size() && !oblique.is_even(); ++l) {
          std::vector<float>& by = band.log_entering_by_sigma_a.emplace_back();
          for (std::size_t t = 0; t < count; ++t)
            by.push_back(static_cast<float>(oblique.log_gain_by_sigma_a(l, t)));
        }
        TransportMaps<float> maps;
        std::vector<AbsorptionRange> ranges;
        for (const LayerTexels& layer : texels.layers) {
          maps.sigma_a.push_back(full_plane(layer.sigma_a, p.width, p.height));
          AbsorptionRange range = absorption_range(maps.sigma_a.back(), tables.grid);
          if (range.highest < margin * range.lowest)
            range = {range.lowest / margin, range.highest * margin};
          ranges.push_back(range);
        }
        for (const std::vector<float>& sheet : texels.absorbance)
          maps.absorbance.push_back(full_plane(sheet, p.width, p.height));
        maps.irradiance = full_plane(p.light.pixels, p.width, p.height);
        for (std::size_t t = 0; t < maps.irradiance.values.size(); ++t)
          maps.irradiance.values[t] *= band.entering_at(t);
        band.transport = std::make_unique<DifferentiableTransport<float>>(
            tables, p.width, p.height, ranges, p.mm_per_texel,
            DifferentiableOptions{.transport = p.transport, .profile = p.profile});
        model_->light[b] = band.transport->light(maps).reflected;
      },
      progress);
}

DifferentiableSkinPatch::~DifferentiableSkinPatch() = default;
DifferentiableSkinPatch::DifferentiableSkinPatch(DifferentiableSkinPatch&&) noexcept = default;

const SkinPatch& DifferentiableSkinPatch::patch() const { return model_->patch; }
const std::vector<Plane>& DifferentiableSkinPatch::light() const { return model_->light; }

PatchGradient DifferentiableSkinPatch::gradient(std::span<const Plane> by_light,
                                                const Progress& progress) {
  const SkinPatch& p = model_->patch;
  const std::size_t texels = p.light.pixels.size();
  if (by_light.size() != model_->bands.size() ||
      std::ranges::any_of(by_light, [&](const Plane& plane) {
        return plane.width != p.width || plane.height != p.height;
      }))
    throw InvalidInput(
        "gradient: must have a plane of the patch's size for each band, but has not");
  PatchGradient sum{.light = make_plane(p.width, p.height)};
  for (const SkinMap& map : p.skin.maps)
    sum.maps.push_back({map.name, make_plane(p.width, p.height)});
  std::mutex mutex;
  parallel_for(
      model_->bands.size(),
      [&](std::size_t b) {
        Model::Band& band = model_->bands[b];
        TransportMaps<float> by_map = band.transport->gradient({.reflected = by_light[b]});
        for (std::size_t l = 0; l < band.log_entering_by_sigma_a.size(); ++l)
          for (std::size_t t = 0; t < texels; ++t)
            by_map.sigma_a[l].values[t] += by_map.irradiance.values[t] * p.light.pixels[t] *
                                           band.entering_at(t) * band.log_entering_by_sigma_a[l][t];
        const double wavelength = p.bands.wavelengths()[b];
        const SkinSpectrum spectrum = skin_spectrum(wavelength);
        std::vector<std::vector<float>> parts(p.skin.maps.size(), std::vector<float>(texels));
        SkinParameters skin = p.skin.skin;
        for (std::size_t t = 0; t < texels; ++t) {
          for (const SkinMap& map : p.skin.maps)
            skin.*map.parameter = static_cast<double>(map.values.pixels[t]);
          for (std::size_t m = 0; m < p.skin.maps.size(); ++m) {
            // Absorption is linear in each number by itself: differences are derivatives.
            double& number = skin.*p.skin.maps[m].parameter;
            const double here = number;
            constexpr double step = 1e-3;
            number = here + step;
            const auto above = absorption(skin, spectrum, wavelength);
            number = here - step;
            const auto below = absorption(skin, spectrum, wavelength);
            number = here;
            double derivative = 0.0;
            for (std::size_t i = 0; i < 3; ++i) {
              const Plane& by = i < 2 ? by_map.sigma_a[i] : by_map.absorbance[0];
              derivative += static_cast<double>(by.values[t]) * (above[i] - below[i]) / (2 * step);
            }
            parts[m][t] = static_cast<float>(derivative);
          }
        }
        const std::lock_guard lock(mutex);
        for (std::size_t m = 0; m < parts.size(); ++m)
          for (std::size_t t = 0; t < texels; ++t) sum.maps[m].values.values[t] += parts[m][t];
        for (std::size_t t = 0; t < texels; ++t)
          sum.light.values[t] += band.entering_at(t) * by_map.irradiance.values[t];
      },
      progress);
  return sum;
}

}  // namespace lamina
