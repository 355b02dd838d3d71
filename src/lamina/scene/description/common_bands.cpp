// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/common_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <ranges>
#include <utility>
#include <variant>
#include <vector>

#include "lamina/layers/optics/symmetric_slab.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

namespace lamina {
namespace {

/// The layers of a translucent surface; null of others.
template <class Surface>
auto* layers_of(Surface& surface) {
  if (auto* subsurface = std::get_if<SubsurfaceSurface>(&surface)) return &subsurface->material;
  auto* thin = std::get_if<ThinSurface>(&surface);
  return thin ? &thin->material : nullptr;
}

/// What each band takes of those given, [band][given]; a row sums to 1.
using Shares = std::vector<std::vector<double>>;

/// Red, green and blue as they make up smooth spectra.
Shares shares_of_rgb(const BandSet& bands, const BandWeights& weights) {
  Shares shares;
  for (const auto& of_band : make_band_basis(bands, weights)) {
    std::vector<double>& share = shares.emplace_back();
    for (const double value : of_band) share.push_back(std::max(value, 0.0));
    const double sum = share[0] + share[1] + share[2];
    for (double& value : share) value /= sum;
  }
  return shares;
}

/// The two wavelengths around each, or the nearest one.
Shares shares_of_neighbors(const BandSet& bands, std::span<const double> given) {
  Shares shares;
  for (const double wavelength : bands.wavelengths()) {
    std::vector<double>& share = shares.emplace_back(given.size(), 0.0);
    const auto above = std::ranges::lower_bound(given, wavelength);
    const auto i = static_cast<std::size_t>(above - given.begin());
    if (i == 0 || i == given.size()) {
      share[i == 0 ? 0 : i - 1] = 1.0;
      continue;
    }
    share[i] = (wavelength - given[i - 1]) / (given[i] - given[i - 1]);
    share[i - 1] = 1.0 - share[i];
  }
  return shares;
}

std::vector<double> mean(const std::vector<double>& values, const Shares& shares) {
  std::vector<double> result;
  if (values.empty()) return result;
  for (const std::vector<double>& share : shares) {
    double sum = 0.0;
    for (std::size_t i = 0; i < share.size(); ++i) sum += share[i] * values[i];
    result.push_back(sum);
  }
  return result;
}

/// The geometric mean, for what differs by orders of magnitude; what is 0 counts as little.
std::vector<double> geometric_mean(const std::vector<double>& values, const Shares& shares) {
  std::vector<double> logs;
  if (values.empty()) return logs;
  const double largest = *std::ranges::max_element(values);
  if (largest == 0.0) return std::vector<double>(shares.size(), 0.0);
  for (const double value : values) logs.push_back(std::log(std::max(value, 1e-6 * largest)));
  std::vector<double> result = mean(logs, shares);
  for (double& value : result) value = std::exp(value);
  return result;
}

Material interpolated(Material material, const BandSet& bands, const Shares& shares) {
  const auto take = [&](auto& part) {
    part.sigma_a = geometric_mean(part.sigma_a, shares);
    part.sigma_s = geometric_mean(part.sigma_s, shares);
    part.g = mean(part.g, shares);
  };
  material.ior_above = mean(material.ior_above, shares);
  material.ior_below = mean(material.ior_below, shares);
  for (MaterialLayer& layer : material.layers) {
    take(layer);
    layer.ior = mean(layer.ior, shares);
    for (MixturePart& part : layer.mixture) take(part);
  }
  material.bands = bands;
  return material;
}

/// Skin at other wavelengths, under the boundaries that it has.
Material recomputed_skin(const Material& skin, const BandSet& bands) {
  Material result = interpolated(skin, bands, shares_of_neighbors(bands, skin.bands.wavelengths()));
  const std::vector<MaterialLayer> layers = skin_layers(skin.skin->skin, bands.wavelengths());
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Interface top = result.layers[i].top;
    result.layers[i] = layers[i];
    result.layers[i].top = top;
  }
  return result;
}

bool is_in_tables_of_skin(const BandSet& bands) {
  return bands.wavelengths().front() >= 350.0 && bands.wavelengths().back() <= 1000.0;
}

bool is_thick(const Material& material) { return !std::isfinite(material.layers.back().thickness); }

std::vector<double> reflectance_of(const Material& material) {
  std::vector<double> reflectance;
  for (const EnteredTotals& totals : material_totals(layer_stacks(material)))
    reflectance.push_back(totals.reflectance);
  return reflectance;
}

Material from_rgb(const Material& rgb, const BandSet& bands, const BandWeights& weights) {
  const Shares shares = shares_of_rgb(bands, weights);
  const std::vector<double> color = reflectance_of(rgb);
  std::vector<double> wanted =
      band_spectrum(make_band_basis(bands, weights), {color[0], color[1], color[2]});
  for (double& value : wanted) value = std::clamp(value, 0.0, 1.0);
  return with_reflectance(interpolated(rgb, bands, shares), wanted);
}

Material with_bands(const Material& material, const BandSet& bands, const BandWeights& weights) {
  if (material.bands.is_rgb()) return from_rgb(material, bands, weights);
  if (material.skin && is_in_tables_of_skin(bands)) return recomputed_skin(material, bands);
  return interpolated(material, bands, shares_of_neighbors(bands, material.bands.wavelengths()));
}

/// Colors of layers, [band], as solvers see them: what they reflect and let through, by radiative
/// transfer and by diffusion.
std::vector<LinearSrgb> colors_of(const std::vector<LayerStack>& layers,
                                  const BandWeights& weights) {
  const std::vector<EnteredTotals> transfer = material_totals(layers);
  std::array<std::vector<double>, 4> spectra;
  for (std::size_t b = 0; b < transfer.size(); ++b) {
    const LayerStack stack = with_smooth_ends(layers[b]);
    const bool diffuses = std::ranges::all_of(
        stack.layers(), [](const Layer& layer) { return layer.medium.sigma_s > 0.0; });
    const SlabTotals totals =
        diffuses ? diffusion_totals(stack, {.is_diffuse = true}) : SlabTotals{};
    const double entered = 1.0 - totals.specular_reflectance;
    spectra[0].push_back(transfer[b].reflectance);
    spectra[1].push_back(is_semi_infinite(stack) ? 0.0 : transfer[b].transmittance);
    spectra[2].push_back(totals.diffuse_reflectance / entered);
    spectra[3].push_back(is_semi_infinite(stack) ? 0.0 : totals.transmittance / entered);
  }
  std::vector<LinearSrgb> colors;
  for (const std::vector<double>& spectrum : spectra)
    colors.push_back(linear_srgb(weights, spectrum));
  return colors;
}

/// Thicknesses [mm] of plates that let light through: one and four times what light in green
/// diffuses in the last layer.
std::vector<double> thicknesses_to_compare(const Material& material) {
  const LayerStack stack = layer_stack(material, material.bands.size() / 2);
  const Medium& medium = stack.layers().back().medium;
  const double reduced = sigma_s_prime(medium);
  const double diffuses =
      std::sqrt(3.0 * std::max(medium.sigma_a, 1e-3 * reduced) * (medium.sigma_a + reduced));
  if (!(diffuses > 0.0)) return {};
  return {1.0 / diffuses, 4.0 / diffuses};
}

double color_error(const Material& before, const BandWeights& weights_before, const Material& after,
                   const BandWeights& weights) {
  double worst = 0.0;
  using Layers = std::vector<LayerStack>;  // [band]
  const auto compare = [&](const Layers& first, const Layers& second) {
    const std::vector<LinearSrgb> wanted = colors_of(first, weights_before);
    const std::vector<LinearSrgb> got = colors_of(second, weights);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(got[i][c] - wanted[i][c]));
  };
  const Layers layers_before = layer_stacks(before), layers_after = layer_stacks(after);
  compare(layers_before, layers_after);
  const auto slabs = [](Layers layers, double thickness) {
    for (LayerStack& stack : layers) stack = make_slab(stack, thickness);
    return layers;
  };
  if (is_thick(before))
    for (const double thickness : thicknesses_to_compare(before))
      compare(slabs(layers_before, thickness), slabs(layers_after, thickness));
  return worst;
}

BandWeights own_weights(const Material& material) {
  return material.skin ? make_skin_band_weights(material.bands, material.skin->skin)
                       : make_band_weights(material.bands);
}

}  // namespace

std::vector<SceneLayers> layers_of(const Scene& scene) {
  std::vector<SceneLayers> all, over;
  const std::vector<bool> is_used = materials_in_use(scene);
  for (std::size_t m = 0; m < is_used.size(); ++m) {
    if (!is_used[m]) continue;
    const SurfaceMaterial& material = scene.materials[m];
    if (const Material* layers = layers_of(material.surface)) all.push_back({&material, layers});
    for (const Covering& covering : coverings_of(material))
      over.push_back({&material, &covering.material});
  }
  all.insert(all.end(), over.begin(), over.end());
  return all;
}

BandSet bands_of(const Scene& scene) {
  const std::vector<SceneLayers> all = layers_of(scene);
  const auto is_rgb = [](const SceneLayers& layers) { return layers.material->bands.is_rgb(); };
  if (all.empty() || std::ranges::all_of(all, is_rgb)) return BandSet::rgb();
  return std::ranges::find_if_not(all, is_rgb)->material->bands;
}

BandWeights weights_of_bands(const Scene& scene, const BandSet& bands) {
  const SkinRecipe* skin = nullptr;
  const std::vector<bool> is_used = materials_in_use(scene);
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    if (!is_used[i]) continue;
    const Material* layers = layers_of(scene.materials[i].surface);
    const bool was_rgb = std::ranges::any_of(scene.band_changes, [&](const BandChange& change) {
      return change.material == i && change.covering.empty() && change.from.is_rgb();
    });
    if (!layers || was_rgb || layers->bands.is_rgb()) continue;
    if (!layers->skin || !std::holds_alternative<SubsurfaceSurface>(scene.materials[i].surface))
      return make_band_weights(bands);
    skin = &*layers->skin;
  }
  return skin ? make_skin_band_weights(bands, skin->skin) : make_band_weights(bands);
}

void make_bands_common(Scene& scene) {
  const BandSet bands = bands_of(scene);
  const BandWeights weights = weights_of_bands(scene, bands);
  const auto change = [&](std::uint32_t i, const std::string& covering, Material& layers) {
    if (layers.bands == bands) return;
    const Material before = layers;
    layers = with_bands(before, bands, weights);
    scene.band_changes.push_back(
        {i, covering, before.bands, color_error(before, own_weights(before), layers, weights)});
  };
  const std::vector<bool> is_used = materials_in_use(scene);
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    if (!is_used[i]) continue;
    SurfaceMaterial& material = scene.materials[i];
    if (Material* layers = layers_of(material.surface)) change(i, {}, *layers);
    for (Covering& covering : coverings_of(material)) change(i, covering.name, covering.material);
  }
}

std::string describe_band_change(const BandChange& change, const Scene& scene) {
  char error[32];
  std::snprintf(error, sizeof error, "%.2g", change.color_error);
  return "material \"" + scene.materials[change.material].name +
         "\": " + (change.covering.empty() ? "" : "over \"" + change.covering + "\": ") +
         (change.from.is_rgb() ? "RGB" : std::to_string(change.from.size()) + " wavelengths") +
         " turned into the " + std::to_string(bands_of(scene).size()) +
         " wavelengths of the scene; colors differ by up to " + error;
}

}  // namespace lamina
