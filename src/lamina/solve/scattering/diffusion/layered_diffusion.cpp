// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

void check_that_it_diffuses(const Medium& medium, std::size_t index) {
  if (sigma_s_prime(medium) > 0.0 && std::isfinite(mfp_prime(medium))) return;
  PlainTextStream message;
  message << "layer " << index << ": diffusion requires sigma_s > 0 [1/mm], but is "
          << medium.sigma_s;
  throw InvalidInput(message.str());
}

/// Fraction of the flux out of the last layer that a Lambertian ground sends back through the
/// boundary between them, after all the reflections between ground and boundary.
double reflection_of_ground(const Ground& ground, double reflectance_outside) {
  const double rho = ground.reflectance;
  return rho * (1.0 - reflectance_outside) / (1.0 - rho * reflectance_outside);
}

/// What boundaries reflect from inside, each found once: a rough one takes half a second.
class BoundaryReflectances {
 public:
  explicit BoundaryReflectances(DiffuseFresnel fresnel) : fresnel_(fresnel) {}

  double operator()(const Interface& boundary, double ior_inside, double ior_outside) {
    for (const Entry& entry : found_)
      if (entry.boundary == boundary && entry.ior_inside == ior_inside &&
          entry.ior_outside == ior_outside)
        return entry.reflectance;
    found_.push_back({boundary, ior_inside, ior_outside,
                      diffuse_reflectance_inside(boundary, ior_inside, ior_outside, fresnel_)});
    return found_.back().reflectance;
  }

 private:
  struct Entry {
    Interface boundary;
    double ior_inside, ior_outside, reflectance;
  };
  DiffuseFresnel fresnel_;
  std::vector<Entry> found_;
};

LayeredDiffusion make_model(const LayerStack& stack, BoundaryReflectances& reflectance_inside,
                            Interreflections interreflections) {
  const auto layers = stack.layers();
  LayeredDiffusion model{.interreflections = interreflections};
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const bool is_first = i == 0, is_last = i + 1 == layers.size();
    const Medium& medium = layers[i].medium;
    check_that_it_diffuses(medium, i);
    const double ior_above = is_first ? stack.ior_above() : layers[i - 1].medium.ior;
    const double ior_below = is_last ? stack.ior_below() : layers[i + 1].medium.ior;
    const Interface& bottom = is_last ? stack.ground().top : layers[i + 1].top;
    model.layers.push_back(make_multipole(medium, layers[i].thickness,
                                          reflectance_inside(layers[i].top, medium.ior, ior_above),
                                          reflectance_inside(bottom, medium.ior, ior_below)));
  }
  if (!is_semi_infinite(stack) && stack.ground().reflectance > 0.0)
    model.ground_reflection = reflection_of_ground(
        stack.ground(),
        reflectance_inside(stack.ground().top, stack.ior_below(), layers.back().medium.ior));
  return model;
}

}  // namespace

LayeredDiffusion make_layered_diffusion(const LayerStack& stack, const DiffusionOptions& options) {
  BoundaryReflectances reflectance_inside(options.fresnel);
  return make_model(stack, reflectance_inside, options.interreflections);
}

std::vector<LayeredDiffusion> make_layered_diffusion(std::span<const LayerStack> stacks,
                                                     const DiffusionOptions& options) {
  BoundaryReflectances reflectance_inside(options.fresnel);
  std::vector<LayeredDiffusion> models;
  for (std::size_t band = 0; band < stacks.size(); ++band) {
    try {
      models.push_back(make_model(stacks[band], reflectance_inside, options.interreflections));
    } catch (const InvalidInput& error) {
      throw InvalidInput("band " + std::to_string(band) + ": " + error.what());
    }
  }
  return models;
}

LayerResponse ground_response(const LayeredDiffusion& model) {
  if (model.ground_reflection == 0.0) return {};
  return {.reflection_above = model.ground_reflection,
          .transmission_down = 0.0,
          .reflection_below = 0.0,
          .transmission_up = 0.0};
}

LayerResponse response(const LayeredDiffusion& model, double k) {
  LayerResponse all;
  for (const Multipole& layer : model.layers)
    all = stacked(all, response(layer, k), model.interreflections);
  return stacked(all, ground_response(model), model.interreflections);
}

LayerResponse local_response(const LayeredDiffusion& model) {
  LayerResponse all;
  for (const Multipole& layer : model.layers)
    all = stacked(all, local_response(layer), model.interreflections);
  return stacked(all, ground_response(model), model.interreflections);
}

std::vector<std::size_t> thin_layers(const LayeredDiffusion& model) {
  std::vector<std::size_t> thin;
  for (std::size_t i = 0; i < model.layers.size(); ++i)
    if (is_thin(model.layers[i])) thin.push_back(i);
  return thin;
}

SlabTotals diffusion_totals(const LayerStack& stack, const Incidence& incidence,
                            const DiffusionOptions& options) {
  const LayeredDiffusion model = make_layered_diffusion(stack, options);
  const std::size_t n = model.layers.size();
  // beneath[i]: layers i and below with the ground; i = n is the ground alone.
  std::vector<LayerResponse> beneath(n + 1);
  beneath[n] = ground_response(model);
  for (std::size_t i = n; i-- > 0;)
    beneath[i] = stacked(response(model.layers[i], 0.0), beneath[i + 1], model.interreflections);

  const double entered = entry_transmittance(stack, incidence);
  SlabTotals totals{.specular_reflectance = 1.0 - entered,
                    .diffuse_reflectance = entered * beneath[0].reflection_above,
                    .transmittance = 0.0,
                    .absorptance = {}};
  LayerResponse above;
  double net_into = entered * (1.0 - beneath[0].reflection_above);
  for (std::size_t i = 0; i < n; ++i) {
    above = stacked(above, response(model.layers[i], 0.0), model.interreflections);
    // The flux down through the lower face, of which the layers beneath send back a share.
    const double down =
        entered * stacked(above, {.reflection_above = beneath[i + 1].reflection_above},
                          model.interreflections)
                      .transmission_down;
    const double net_out = down * (1.0 - beneath[i + 1].reflection_above);
    totals.absorptance.push_back(std::max(0.0, net_into - net_out));  // rounding at sigma_a = 0
    net_into = net_out;
  }
  totals.transmittance = is_semi_infinite(stack) ? 0.0 : std::max(0.0, net_into);
  return totals;
}

}  // namespace lamina
