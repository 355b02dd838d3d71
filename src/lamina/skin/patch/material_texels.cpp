// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/patch/material_texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

using Of = MappableNumber::Of;

/// What a material is at one texel.
struct PlaceState {
  std::vector<LayerState> layers;
  std::vector<double> absorbance;  ///< [layer - 1]
};

/// Beside absorption, what of the layers may differ from texel to texel.
struct Varying {
  bool sigma_s = true, g = true, thickness = true;
};

/// Skin at one place after the other: its numbers are set, then its layers are asked for.
class SkinAtPlace {
 public:
  SkinAtPlace(const SkinParameters& skin, double wavelength, std::span<const NumberTexels> maps)
      : skin_(skin),
        wavelength_(wavelength),
        spectrum_(skin_spectrum(wavelength)),
        g_(skin_mean_cosine(wavelength)),
        scattering_(epidermis_scattering(skin, wavelength)),
        junction_factor_(spectrum_factor(skin.junction_spectrum, wavelength)) {
    for (const SkinInk& ink : skin.inks)
      ink_factors_.push_back(spectrum_factor(ink.spectrum, wavelength));
    varying_ = {.sigma_s = false, .g = false, .thickness = false};
    for (const NumberTexels& map : maps) {
      if (map.number.of != Of::skin) continue;
      const auto value = skin_parameter_ranges()[map.number.part].value;
      varying_.sigma_s |=
          value == &SkinParameters::scattering_scale || value == &SkinParameters::scattering_power;
      varying_.thickness |= value == &SkinParameters::epidermis_thickness ||
                            value == &SkinParameters::dermis_thickness;
    }
  }

  [[nodiscard]] Varying varying() const { return varying_; }

  void set(const MappableNumber& number, double value) {
    if (number.of == Of::skin) skin_.*skin_parameter_ranges()[number.part].value = value;
    if (number.of == Of::ink) skin_.inks[number.part].absorbance = value;
  }

  void put(PlaceState& place) {
    if (varying_.sigma_s) scattering_ = epidermis_scattering(skin_, wavelength_);
    const double sigma_s = scattering_ / (1.0 - g_);
    const LayerState epidermis{.sigma_a = epidermis_absorption(skin_, spectrum_),
                               .sigma_s = sigma_s,
                               .g = g_,
                               .thickness = skin_.epidermis_thickness};
    const LayerState dermis{.sigma_a = dermis_absorption(skin_, spectrum_),
                            .sigma_s = 0.5 * sigma_s,
                            .g = g_,
                            .thickness = skin_.dermis_thickness};
    double sheet = junction_factor_ * skin_.junction_absorption;
    for (std::size_t i = 0; i < ink_factors_.size(); ++i)
      sheet += ink_factors_[i] * skin_.inks[i].absorbance;
    if (std::isinf(skin_.dermis_thickness)) {
      place.layers = {epidermis, dermis};
      place.absorbance = {sheet};
    } else {
      place.layers = {epidermis, dermis, epidermis};
      place.absorbance = {sheet, sheet};
    }
  }

 private:
  SkinParameters skin_;
  double wavelength_;
  SkinSpectrum spectrum_;
  double g_, scattering_, junction_factor_;
  std::vector<double> ink_factors_;
  Varying varying_;
};

/// A leaf, likewise.
class LeafAtPlace {
 public:
  LeafAtPlace(const LeafParameters& leaf, double wavelength)
      : leaf_(leaf), spectrum_(leaf_spectrum(wavelength)) {}

  [[nodiscard]] static Varying varying() { return {.g = false}; }

  void set(const MappableNumber& number, double value) {
    if (number.of == Of::leaf) leaf_.*leaf_parameter_ranges()[number.part].value = value;
  }

  void put(PlaceState& place) const {
    place.layers.clear();
    for (const Layer& layer : leaf_layers(leaf_, spectrum_))
      place.layers.push_back({.sigma_a = layer.medium.sigma_a,
                              .sigma_s = layer.medium.sigma_s,
                              .g = layer.medium.g,
                              .thickness = layer.thickness});
    place.absorbance = {0.0};
  }

 private:
  LeafParameters leaf_;
  LeafSpectrum spectrum_;
};

/// Layers with coefficients of their own, likewise.
class LayersAtPlace {
 public:
  LayersAtPlace(const Material& material, std::size_t band) {
    for (const MaterialLayer& from : material.layers) {
      MixedLayer& to = layers_.emplace_back();
      to.thickness = from.thickness;
      for (const MixturePart& part : from.mixture)
        to.parts.push_back({part.sigma_a[band], part.sigma_s[band], part.g[band], part.fraction});
      to.has_rest = !from.sigma_a.empty();
      if (to.has_rest) to.rest = {from.sigma_a[band], from.sigma_s[band], from.g[band], 0.0};
    }
  }

  [[nodiscard]] static Varying varying() { return {}; }

  void set(const MappableNumber& number, double value) {
    if (number.layer >= layers_.size()) return;
    MixedLayer& layer = layers_[number.layer];
    if (number.of == Of::sigma_a) layer.rest.sigma_a = value;
    if (number.of == Of::sigma_s) layer.rest.sigma_s = value;
    if (number.of == Of::g) layer.rest.g = value;
    if (number.of == Of::thickness) layer.thickness = value;
    if (number.of == Of::fraction) layer.parts[number.part].fraction = value;
  }

  void put(PlaceState& place) const {
    place.layers.clear();
    for (const MixedLayer& layer : layers_) place.layers.push_back(mixed(layer));
    place.absorbance.assign(layers_.size() - 1, 0.0);
  }

 private:
  struct Part {
    double sigma_a = 0.0, sigma_s = 0.0, g = 0.0, fraction = 0.0;
  };
  struct MixedLayer {
    std::vector<Part> parts;
    Part rest;
    bool has_rest = false;
    double thickness = 0.0;
  };

  static LayerState mixed(const MixedLayer& layer) {
    double all = 0.0;
    for (const Part& part : layer.parts) all += part.fraction;
    const double room = all > 1.0 ? 1.0 / all : 1.0;
    LayerState state{.thickness = layer.thickness};
    double forward = 0.0;
    const auto add = [&](const Part& part, double fraction) {
      state.sigma_a += fraction * part.sigma_a;
      state.sigma_s += fraction * part.sigma_s;
      forward += fraction * part.sigma_s * part.g;
    };
    for (const Part& part : layer.parts) add(part, room * part.fraction);
    if (layer.has_rest) add(layer.rest, std::max(0.0, 1.0 - all));
    if (state.sigma_s > 0.0) state.g = forward / state.sigma_s;
    return state;
  }

  std::vector<MixedLayer> layers_;
};

/// Adds the value of texel i, the next one; as long as all are the same there is one.
void add_value(double value, std::size_t i, std::size_t texels, std::vector<float>& values) {
  const auto rounded = static_cast<float>(value);
  if (i > 0 && values.size() == 1) {
    if (rounded == values[0]) return;
    values.reserve(texels);
    values.resize(i, values[0]);
  }
  values.push_back(rounded);
}

/// A layer of many states, whose own numbers are those of the middle one.
MappedLayer mapped_layer(StateLattice states, double ior) {
  const LayerState middle = state_of(states.origin);
  return {middle.sigma_s, middle.g, ior, middle.thickness, std::move(states)};
}

template <class AtPlace>
BandTexels texels_of(AtPlace at, double surface_roughness, std::span<const NumberTexels> maps,
                     std::size_t texels, std::size_t band) {
  if (maps.empty()) texels = 1;
  const Varying varying = at.varying();
  const bool has_roughness_map = std::ranges::any_of(
      maps, [](const NumberTexels& map) { return map.number.of == Of::roughness; });
  BandTexels result;
  PlaceState place;
  for (std::size_t i = 0; i < texels; ++i) {
    double roughness = surface_roughness;
    for (const NumberTexels& map : maps) {
      const std::size_t channel = map.channels > 1 ? band : 0;
      const auto value = static_cast<double>(map.values[i * map.channels + channel]);
      if (map.number.of == Of::roughness) roughness = value;
      at.set(map.number, value);
    }
    at.put(place);
    if (i == 0) {
      result.layers.resize(place.layers.size());
      result.absorbance.resize(place.absorbance.size());
    }
    for (std::size_t l = 0; l < place.layers.size(); ++l) {
      const LayerState& state = place.layers[l];
      LayerTexels& to = result.layers[l];
      const auto add = [&](bool varies, double value, std::vector<float>& values) {
        if (varies || i == 0) add_value(value, i, texels, values);
      };
      add(true, std::max(least_coefficient, state.sigma_a), to.sigma_a);
      add(varying.sigma_s, std::max(least_coefficient, state.sigma_s), to.sigma_s);
      add(varying.g, state.g, to.g);
      add(varying.thickness, state.thickness, to.thickness);
      add(has_roughness_map, l == 0 ? roughness : 0.0, to.roughness);
    }
    for (std::size_t j = 0; j < place.absorbance.size(); ++j)
      add_value(place.absorbance[j], i, texels, result.absorbance[j]);
  }
  return result;
}

}  // namespace

BandTexels band_texels(const Material& material, std::span<const NumberTexels> maps,
                       std::size_t texels, std::size_t band) {
  const double roughness = material.layers.front().top.roughness;
  if (material.skin || material.leaf) {
    const double wavelength = material.bands.wavelengths()[band];
    if (material.skin)
      return texels_of(SkinAtPlace(material.skin->skin, wavelength, maps), roughness, maps, texels,
                       band);
    return texels_of(LeafAtPlace(*material.leaf, wavelength), roughness, maps, texels, band);
  }
  return texels_of(LayersAtPlace(material, band), roughness, maps, texels, band);
}

MappedStack mapped_stack(const Material& material, std::size_t band, const BandTexels& texels,
                         const GaussianTableGrid& grid) {
  std::vector<double> indices;  // of skin without its junction
  for (const MaterialLayer& layer : material.layers) {
    if (!indices.empty() && layer.top.roughness > 0.0)
      throw InvalidInput("boundaries between layers that are maps must be smooth, but that of \"" +
                         layer.name + "\" has a roughness");
    if (!material.skin || indices.empty() || layer.ior[band] != indices.back())
      indices.push_back(layer.ior[band]);
  }
  if (material.ground.top.roughness > 0.0)
    throw InvalidInput("the lowest boundary of layers that are maps must be smooth");
  MappedStack stack{.ior_above = material.ior_above[band],
                    .layers = {},
                    .ior_below = material.ior_below[band],
                    .ground_reflectance = material.ground.reflectance,
                    .distribution = material.layers.front().top.distribution};
  for (std::size_t i = 0; i < texels.layers.size(); ++i) {
    const LayerTexels& layer = texels.layers[i];
    const LayerState first = state_of(layer, 0);
    MappedLayer& to =
        stack.layers.emplace_back(MappedLayer{first.sigma_s, first.g, indices[i], first.thickness});
    const auto [low, high] = std::ranges::minmax(layer.sigma_a);
    const bool is_on_grid =
        grid.lowest <= static_cast<double>(low) && static_cast<double>(high) <= grid.highest;
    if (!varies_in_absorption_only(layer) || first.roughness > 0.0 || !is_on_grid)
      to = mapped_layer(fit_lattice(layer), indices[i]);
  }
  return stack;
}

std::vector<double> reference_absorptions(const BandTexels& texels) {
  std::vector<double> reference;
  for (const LayerTexels& layer : texels.layers)
    reference.push_back(typical_absorption(layer.sigma_a));
  return reference;
}

std::vector<double> typical_absorbances(const BandTexels& texels) {
  std::vector<double> typical;
  for (const std::vector<float>& sheet : texels.absorbance) {
    double sum = 0.0;
    for (const float value : sheet) sum += static_cast<double>(value);
    typical.push_back(sum / static_cast<double>(sheet.size()));
  }
  return typical;
}

double typical_absorption(std::span<const float> sigma_a) {
  double sum = 0.0;
  for (const float value : sigma_a) sum += std::log(static_cast<double>(value));
  const double mean = sum / static_cast<double>(sigma_a.size());
  const auto [low, high] = std::ranges::minmax(sigma_a);
  return std::exp(low == high ? mean : std::round(4.0 * mean) / 4.0);
}

}  // namespace lamina
