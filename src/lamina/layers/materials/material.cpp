// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/material.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

double at(const std::vector<double>& values, std::size_t band, const std::string& where) {
  if (band < values.size()) return values[band];
  throw InvalidInput(where + " must hold a number for band " + std::to_string(band) +
                     ", but holds " + std::to_string(values.size()));
}

/// A share of sigma_s [1/mm] and how it scatters.
struct Scatterer {
  double sigma_s;
  decltype(PhaseMixture::Lobe::phase) phase;
};

/// The medium of a layer and, unless it is Henyey-Greenstein, its phase function.
struct Mixed {
  Medium medium;
  std::optional<PhaseFunction> phase;
};

class Mixer {
 public:
  /// @param part  a MixturePart or the MaterialLayer itself.
  void add_part(const auto& part, double fraction, std::size_t band, const std::string& where) {
    sigma_a_ += fraction * at(part.sigma_a, band, where + ".sigma_a");
    const double sigma_s = fraction * at(part.sigma_s, band, where + ".sigma_s");
    if (part.phase == ParticlePhase::rayleigh)
      add_scatterer({sigma_s, Rayleigh{}});
    else
      add_scatterer({sigma_s, HenyeyGreenstein{at(part.g, band, where + ".g")}});
  }

  [[nodiscard]] Mixed result(double ior) const {
    double sigma_s = 0.0;
    for (const Scatterer& scatterer : scatterers_) sigma_s += scatterer.sigma_s;
    Mixed mixed{.medium = {.sigma_a = sigma_a_, .sigma_s = sigma_s, .ior = ior}, .phase = {}};
    if (scatterers_.empty()) return mixed;
    if (scatterers_.size() == 1) {
      if (const auto* hg = std::get_if<HenyeyGreenstein>(&scatterers_[0].phase)) {
        mixed.medium.g = hg->g;
      } else {
        std::visit([&](const auto& phase) { mixed.phase = phase; }, scatterers_[0].phase);
        mixed.medium.g = mean_cosine(*mixed.phase);
      }
      return mixed;
    }
    PhaseMixture mixture;
    for (const Scatterer& scatterer : scatterers_)
      mixture.lobes.push_back({.weight = scatterer.sigma_s / sigma_s, .phase = scatterer.phase});
    mixed.phase = std::move(mixture);
    mixed.medium.g = mean_cosine(*mixed.phase);
    return mixed;
  }

 private:
  /// Parts that scatter alike count as one: most solvers are fastest without a mixture. What does
  /// not scatter has no say in how the layer does, unless nothing does.
  void add_scatterer(const Scatterer& scatterer) {
    const auto same = std::ranges::find(scatterers_, scatterer.phase, &Scatterer::phase);
    if (same != scatterers_.end())
      same->sigma_s += scatterer.sigma_s;
    else if (scatterer.sigma_s != 0.0)
      scatterers_.push_back(scatterer);
  }

  double sigma_a_ = 0.0;
  std::vector<Scatterer> scatterers_;
};

/// The share of the volume that a mixture leaves. @throws InvalidInput if that is not in [0, 1].
double rest_of(const MaterialLayer& layer, const std::string& where) {
  double sum = 0.0;
  bool in_range = true;
  for (const MixturePart& part : layer.mixture) {
    in_range = in_range && part.fraction >= 0.0 && part.fraction <= 1.0;
    sum += part.fraction;
  }
  const bool is_whole = layer.sigma_a.empty() && !layer.mixture.empty();
  if (!in_range || sum > 1.0 + mixture_tolerance || (is_whole && sum < 1.0 - mixture_tolerance))
    throw InvalidInput(where + ".mixture: fractions must lie in [0, 1] and sum to " +
                       (is_whole ? "1" : "at most 1") + ", but sum to " + number_text(sum));
  return std::max(1.0 - sum, 0.0);
}

Layer optical_layer(const MaterialLayer& layer, std::size_t band, const std::string& where) {
  const double rest = rest_of(layer, where);
  Mixer mixer;
  for (std::size_t i = 0; i < layer.mixture.size(); ++i)
    mixer.add_part(layer.mixture[i], layer.mixture[i].fraction, band,
                   where + ".mixture[" + std::to_string(i) + "]");
  if (layer.mixture.empty() || !layer.sigma_a.empty()) mixer.add_part(layer, rest, band, where);
  Mixed mixed = mixer.result(at(layer.ior, band, where + ".ior"));
  return {.medium = mixed.medium,
          .thickness = layer.thickness,
          .top = layer.top,
          .phase = std::move(mixed.phase)};
}

}  // namespace

LayerStack layer_stack(const Material& material, std::size_t band) {
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < material.layers.size(); ++i)
    layers.push_back(optical_layer(material.layers[i], band, "layers[" + std::to_string(i) + "]"));
  return LayerStack(std::move(layers), at(material.ior_above, band, "ior_above"),
                    at(material.ior_below, band, "ior_below"), material.ground);
}

std::vector<LayerStack> layer_stacks(const Material& material) {
  std::vector<LayerStack> stacks;
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    stacks.push_back(layer_stack(material, band));
  return stacks;
}

Material half_space_material(std::span<const Medium> channels, const Interface& top) {
  Material material;
  MaterialLayer layer{.name = "inside", .top = top};
  for (const Medium& medium : channels) {
    layer.sigma_a.push_back(medium.sigma_a);
    layer.sigma_s.push_back(medium.sigma_s);
    layer.g.push_back(medium.g);
    layer.ior.push_back(medium.ior);
    material.ior_above.push_back(1.0);
    material.ior_below.push_back(medium.ior);
  }
  material.layers.push_back(std::move(layer));
  return material;
}

}  // namespace lamina
