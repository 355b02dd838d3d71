// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/internal/photon_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/random.h"
#include "lamina/layers/optics/fresnel.h"

namespace lamina::photon {
namespace {

void require(bool holds, const std::string& rule, double given) {
  if (holds) return;
  PlainTextStream message;
  message << rule << ", but is " << given;
  throw InvalidInput(message.str());
}

void check(const MonteCarloOptions& options) {
  require(options.photons >= 1 && options.photons <= 1'000'000'000'000'000u,
          "photons must lie in [1, 1e15]", static_cast<double>(options.photons));
  const Incidence& incidence = options.incidence;
  require(incidence.theta >= 0.0 && incidence.theta < 0.5 * std::numbers::pi,
          "the angle of incidence must lie in [0, pi/2)", incidence.theta);
  if (options.beam.shape != Beam::Shape::pencil)
    require(std::isfinite(options.beam.radius) && options.beam.radius > 0.0,
            "the radius of the beam must be > 0 [mm]", options.beam.radius);
  require(options.relative_error >= 0.0 && std::isfinite(options.relative_error),
          "relative_error must be >= 0", options.relative_error);
  require(options.seconds >= 0.0, "seconds must be >= 0", options.seconds);
  require(options.shard.count >= 1, "the number of shards must be >= 1", options.shard.count);
  require(options.shard.index >= 0 && options.shard.index < options.shard.count,
          "the index of the shard must lie in [0, " + std::to_string(options.shard.count) + ")",
          options.shard.index);
  require(options.max_events >= 1, "max_events must be >= 1", options.max_events);
  require(options.roulette_weight > 0.0 && options.roulette_weight <= 0.5,
          "roulette_weight must lie in (0, 0.5]", options.roulette_weight);
}

/// The lobes of a phase function, of which a mixture has several.
std::vector<PhaseMixture::Lobe> lobes_of(const PhaseFunction& phase) {
  return std::visit(
      [](const auto& kind) -> std::vector<PhaseMixture::Lobe> {
        if constexpr (std::is_same_v<decltype(kind), const PhaseMixture&>)
          return kind.lobes;
        else
          return {{.weight = 1.0, .phase = kind}};
      },
      phase);
}

/// A lobe as `Scene::lobe_g` holds it: the lanes know these kinds alone.
float lane_g(const HenyeyGreenstein& lobe) { return static_cast<float>(lobe.g); }
float lane_g(const Rayleigh& /*lobe*/) { return 2.0f; }

void add_phase_functions(const LayerStack& stack, Scene& scene) {
  const bool is_simple = std::ranges::all_of(stack.layers(), [](const Layer& layer) {
    return std::holds_alternative<HenyeyGreenstein>(phase_function(layer));
  });
  if (is_simple) return;
  for (const Layer& layer : stack.layers())
    scene.lobes = std::max(scene.lobes, static_cast<int>(lobes_of(phase_function(layer)).size()));
  for (const Layer& layer : stack.layers()) {
    auto lobes = lobes_of(phase_function(layer));
    const std::size_t last = lobes.size() - 1;
    lobes.resize(static_cast<std::size_t>(scene.lobes), lobes.back());
    double end = 0.0;
    for (std::size_t i = 0; i < lobes.size(); ++i) {
      end += lobes[i].weight;
      scene.lobe_end.push_back(i >= last ? 2.0f : static_cast<float>(end));
      scene.lobe_g.push_back(
          std::visit([](const auto& lobe) { return lane_g(lobe); }, lobes[i].phase));
    }
  }
}

/// MCML's deterministic entry through a clear first layer: its interreflections are specular.
void enter_below_clear_top(const LayerStack& stack, Scene& scene) {
  const Layer& top = stack.layers()[0];
  if (sigma_t(top.medium) > 0.0 || stack.layers().size() < 2) return;
  const double r1 = fresnel(1.0, top.medium.ior / stack.ior_above());
  const double r2 = fresnel(1.0, stack.layers()[1].medium.ior / top.medium.ior);
  scene.specular = r1 + (1.0 - r1) * (1.0 - r1) * r2 / (1.0 - r1 * r2);
  scene.first_layer = 1;
}

void add_light(const LayerStack& stack, const MonteCarloOptions& options, Scene& scene) {
  scene.incidence = options.incidence;
  scene.beam = options.beam;
  scene.enters_at_random = options.incidence.is_diffuse || scene.is_rough[0] != 0;
  if (scene.enters_at_random) return;
  const double eta = stack.layers()[0].medium.ior / stack.ior_above();
  const double cos_i = std::cos(options.incidence.theta);
  scene.specular = fresnel(cos_i, eta);
  scene.ux = static_cast<float>(std::sin(options.incidence.theta) / eta);
  scene.uz = static_cast<float>(cos_refracted(cos_i, eta));
  if (options.clear_top_is_specular) {
    if (options.incidence.theta != 0.0 || !is_smooth(stack))
      throw InvalidInput(
          "clear_top_is_specular: incidence must be normal and boundaries smooth, but are not");
    enter_below_clear_top(stack, scene);
  }
  scene.weight = static_cast<float>(1.0 - scene.specular);
}

}  // namespace

Scene make_scene(const LayerStack& stack, const MonteCarloOptions& options) {
  check(options);
  Scene scene;
  scene.layers = static_cast<int>(stack.layers().size());
  const std::size_t n = stack.layers().size();
  double depth = 0.0, longest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Layer& layer = stack.layers()[i];
    const double extinction = sigma_t(layer.medium);
    // Light never returns from a clear half-space: it counts as transmitted at any depth.
    const bool is_open = extinction == 0.0 && std::isinf(layer.thickness);
    const double thickness = is_open ? 1.0 : layer.thickness;
    scene.mfp.push_back(static_cast<float>(std::min(1.0 / extinction, 1e30)));
    scene.thickness.push_back(static_cast<float>(thickness));
    // A clear layer has no events but for light exactly along it, which goes on.
    scene.albedo.push_back(extinction > 0.0 ? static_cast<float>(albedo(layer.medium)) : 1.0f);
    scene.g.push_back(static_cast<float>(layer.medium.g));
    scene.top.push_back(static_cast<float>(depth));
    scene.ior.push_back(static_cast<float>(layer.medium.ior));
    depth += thickness;
    if (extinction > 0.0) longest = std::max(longest, 1.0 / extinction);
    const double above = i == 0 ? stack.ior_above() : stack.layers()[i - 1].medium.ior;
    const double below = i + 1 == n ? stack.ior_below() : stack.layers()[i + 1].medium.ior;
    scene.eta.push_back(static_cast<float>(layer.medium.ior / above));
    scene.eta.push_back(static_cast<float>(layer.medium.ior / below));
    scene.interfaces.push_back(layer.top);
    scene.ior_sides.push_back(static_cast<float>(above));
    if (i + 1 == n) {
      scene.interfaces.push_back(stack.ground().top);
      scene.ior_sides.push_back(static_cast<float>(layer.medium.ior));
      scene.ior_sides.push_back(static_cast<float>(below));
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (const std::size_t boundary : {i, i + 1}) {
      const bool is_rough = scene.interfaces[boundary].roughness >= 1e-4 &&
                            scene.ior_sides[boundary] != scene.ior_sides[boundary + 1];
      scene.is_rough.push_back(is_rough ? 1 : 0);
      scene.has_rough = scene.has_rough || is_rough;
    }
  if (longest > 0.0) scene.length_unit = std::min({longest, depth, 1e30});
  scene.ground = static_cast<float>(stack.ground().reflectance);
  add_phase_functions(stack, scene);
  add_light(stack, options, scene);
  for (const ExitDirection& direction : options.tallies.directions)
    scene.views.push_back(make_exit_view(stack, direction));
  std::uint64_t state = options.seed;
  scene.seed = Random::splitmix(state);
  scene.max_events = options.max_events;
  scene.roulette_weight = static_cast<float>(options.roulette_weight);
  return scene;
}

void check_tallies(const PhotonTallies& t) {
  // Areas, volumes and what is divided by them stay finite.
  constexpr double shortest = 1e-9, longest = 1e9;
  const auto check_length = [](double length, const std::string& name) {
    require(length >= shortest && length <= longest,
            "tallies: " + name + " must lie in [1e-9, 1e9] mm", length);
  };
  const auto check_bins = [&](const UniformBins& bins, const std::string& name) {
    require(bins.count >= 0, "tallies: " + name + ": the number of bins must be >= 0", bins.count);
    if (bins.count > 0) check_length(bins.width, name + ": the width of a bin");
  };
  check_bins(t.r, "r");
  check_bins(t.depth, "depth");
  check_bins(t.path_length, "path_length");
  require(t.time.count >= 0, "tallies: time: the number of bins must be >= 0", t.time.count);
  if (t.time.count > 0)
    require(t.time.width >= shortest && t.time.width <= longest,
            "tallies: time: the width of a bin must lie in [1e-9, 1e9] ps", t.time.width);
  for (const double frequency : t.frequencies)
    require(frequency >= 0.0 && frequency <= 1e6, "tallies: a frequency must lie in [0, 1e6] MHz",
            frequency);
  require(t.angles >= 0, "tallies: angles must be >= 0", t.angles);
  require(t.bsdf_cosines >= 0, "tallies: bsdf_cosines must be >= 0", t.bsdf_cosines);
  require(t.bsdf_azimuths >= 0, "tallies: bsdf_azimuths must be >= 0", t.bsdf_azimuths);
  require(t.log_r.count >= 0, "tallies: log_r: the number of bins must be >= 0", t.log_r.count);
  if (t.log_r.count > 0) {
    check_length(t.log_r.low, "log_r: the lowest radius");
    check_length(t.log_r.high, "log_r: the highest radius");
    require(t.log_r.high > t.log_r.low,
            "tallies: log_r: the highest radius must be above the lowest [mm]", t.log_r.high);
  }
  if (t.depth.count > 0 && t.r.count == 0)
    throw InvalidInput("tallies: depth needs r, but r has 0 bins");
  if (t.fluence && t.depth.count == 0)
    throw InvalidInput("tallies: fluence needs depth, but depth has 0 bins");
  if (!t.detectors.empty()) check_length(t.detector_width, "detector_width");
  for (const double r : t.detectors)
    require(r >= 0.0 && r <= longest, "tallies: the distance of a detector must lie in [0, 1e9] mm",
            r);
  for (const ExitDirection& direction : t.directions) {
    require(direction.theta >= 0.0 && direction.theta < 0.5 * std::numbers::pi,
            "tallies: the angle of an exit direction must lie in [0, pi/2)", direction.theta);
    require(std::isfinite(direction.phi),
            "tallies: the azimuth of an exit direction must be finite", direction.phi);
  }
}

TallyPlan make_tally_plan(const PhotonTallies& tallies, std::size_t layers, double length_unit) {
  TallyPlan plan{.layout = make_photon_layout(tallies, layers), .tallies = tallies};
  const auto inverse = [](const UniformBins& bins) {
    return bins.count > 0 ? static_cast<float>(1.0 / bins.width) : 0.0f;
  };
  plan.inverse_dr = inverse(tallies.r);
  plan.inverse_dz = inverse(tallies.depth);
  plan.inverse_dl = inverse(tallies.path_length);
  plan.inverse_da = static_cast<float>(tallies.angles / (0.5 * std::numbers::pi));
  if (tallies.log_r.count > 0) {
    plan.log_low = static_cast<float>(std::log(tallies.log_r.low));
    plan.inverse_dlog =
        static_cast<float>(tallies.log_r.count / std::log(tallies.log_r.high / tallies.log_r.low));
  }
  plan.path_unit = static_cast<float>(std::ldexp(1.0 / length_unit, -path_scale));
  plan.fluence_unit = static_cast<float>(std::ldexp(1.0 / length_unit, fluence_scale));
  plan.inverse_dt = inverse(tallies.time);
  plan.needs_flight = tallies.time.count > 0 || !tallies.frequencies.empty();
  plan.needs_path = tallies.mean_path_length || tallies.path_length.count > 0 || plan.needs_flight;
  plan.needs_reflections =
      tallies.known_above != KnownLight{} || tallies.known_below != KnownLight{};
  plan.has_rare_exits = plan.needs_path || tallies.log_r.count > 0 || tallies.bsdf_cosines > 0 ||
                        tallies.orders || !tallies.detectors.empty();
  return plan;
}

}  // namespace lamina::photon
