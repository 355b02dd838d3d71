// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/random_walk.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <variant>

#include "lamina/optics/henyey_greenstein.h"
#include "lamina/reflectance/exact_totals.h"
#include "lamina/render/subsurface/colored_transport.h"
#include "lamina/render/subsurface/random_walk/internal/walk_turn.h"
#include "lamina/scattering/layered_bsdf/first_order-inl.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int most_events = 100'000;
constexpr std::uint32_t walks = 4;  // from where a ray of the eye enters
// How often a path searches for a lamp and goes on: these times what that may change of the light
// that it brings home, and at least so often. By the least work for the same noise.
constexpr float search_scale = 3.0f, least_search = 0.05f;
constexpr float going_scale = 4.0f, least_going = 0.1f;
// Light over that of the scene below which noise does not matter.
constexpr float least_reference = 5e-4f;

}  // namespace

template <int N>
RandomWalk<N>::RandomWalk(const RenderScene& scene, const BandConversion<N>& conversion,
                          std::uint32_t material) {
  const Material layers = colored_medium<N>(scene, conversion, material);
  require_closed_meshes(*scene.scene, material);
  bands_ = static_cast<int>(layers.bands.size());
  std::vector<LayerStack> stacks;
  double ior = 0.0;
  for (std::size_t b = 0; b < layers.bands.size(); ++b) {
    stacks.push_back(layer_stack(layers, b));
    phases_.push_back(phase_function(stacks[b].layers()[0]));
    is_same_phase_ = is_same_phase_ && phases_[b] == phases_[0];
    ior += layers.layers[0].ior[b] / layers.ior_above[b] / static_cast<double>(bands_);
    reflectance_[static_cast<int>(b)] = static_cast<float>(exact_totals(layers, b).reflectance);
  }
  is_isotropic_ = is_same_phase_ && phases_[0] == PhaseFunction(HenyeyGreenstein{.g = 0.0});
  stack_ = make_first_order<N>(stacks);
  const Bands sigma_s = stack_.layers[0].sigma_s, sigma_t = stack_.layers[0].sigma_t;
  for (int b = 0; b < N; ++b)
    mean_cosine_[b] =
        static_cast<float>(mean_cosine(phases_[static_cast<std::size_t>(std::min(b, bands_ - 1))]));
  const Bands reduced_sigma_s = sigma_s - mean_cosine_ * sigma_s;
  const Bands reduced_sigma_t = reduced_sigma_s + (sigma_t - sigma_s);
  for (int b = 0; b < N; ++b)
    reduction_[b] = sigma_t[b] > 0.0f ? reduced_sigma_t[b] / sigma_t[b] : 1.0f;
  medium_ = make_walk_medium(sigma_s, sigma_t, bands_);
  reduced_ = make_walk_medium(reduced_sigma_s, reduced_sigma_t, bands_);
  const auto shortest = [](const Bands& extinction) {
    return 1.0f / std::max(largest(extinction), 1e-6f);
  };
  reduced_free_path_ = shortest(reduced_sigma_t);
  space_ = std::make_unique<WalkSpace<N>>(scene, conversion, material, static_cast<float>(ior),
                                          bands_, shortest(sigma_t));
  lamps_ = std::make_unique<WalkLamps<N>>(*space_, sigma_t, reduced_sigma_t, shortest(sigma_t));
  typical_radiance_ = std::max(scene.lights.typical_irradiance() / pi, 1e-30f);
}

template <int N>
bool RandomWalk<N>::prepare(const LightGatherer<N>& light, const Progress& progress, float scale) {
  if (!light_.find_out(*space_, reduced_, reduced_free_path_, *lamps_, light, progress))
    return false;
  if (scale != 1.0f) light_.scale(scale);
  return true;
}

template <int N>
BandValues<N> RandomWalk<N>::phase(float one_minus_cos) const {
  if (is_isotropic_) return Bands::filled(0.25f / pi);
  return first_order::layer_phase(stack_, stack_.layers[0], Bands::filled(one_minus_cos));
}

template <int N>
void RandomWalk<N>::scatter(WalkPath<N>& path, WalkNumbers& numbers) const {
  if (!is_isotropic_)
    return turn_at_event(path, phases_, is_same_phase_, numbers,
                         [&](float one_minus_cos) { return phase(one_minus_cos); });
  const Vec2f u = numbers.pair();
  const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(1.0f - z * z, 0.0f));
  const float phi = 2.0f * pi * u.y;
  path.ray.direction = {r * std::cos(phi), r * std::sin(phi), z};
}

template <int N>
BandValues<N> RandomWalk<N>::leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                              PixelSamples& samples) const {
  const Vec3f inward = -refract_inside(exit.to_eye, exit.point.normal, space_->ior());
  if (!(dot(inward, exit.point.geometric_normal) < 0.0f)) return {};
  Bands radiance;
  for (std::uint32_t i = 0; i < walks; ++i) {
    PixelSamples own = samples.branch(i, walks);
    radiance += walk(exit, inward, light, own);
  }
  return (1.0f / static_cast<float>(walks)) * radiance;
}

template <int N>
typename RandomWalk<N>::Known RandomWalk<N>::what_is_known(const Vec3f& place, bool in_detail,
                                                           const LightGatherer<N>& light) const {
  Known known = light_.at(place);
  if (lamps_->are_there() && (in_detail || !known.is_known())) {
    const LampLight<N> lamp = lamps_->known(place, light);
    known.lamps = lamp.fluence;
    for (int axis = 0; axis < 3; ++axis) known.others[axis] = lamp.direction[axis];
    known.others[4] = lamp.spread;
  }
  return known;
}

template <int N>
BandValues<N> RandomWalk<N>::walk(const ExitPoint& exit, const Vec3f& inward,
                                  const LightGatherer<N>& light, PixelSamples& samples) const {
  WalkNumbers numbers(samples);
  Random& random = numbers.stream();
  WalkPath<N> path{.ray = {leave_surface(exit.point, inward), inward},
                   .carried = Bands::filled(1.0f - reflectance(exit.boundary, exit.cos_o))};
  Bands radiance;
  float reference = 0.0f;  // about the radiance that comes home
  const auto add_from_outside = [&](const WalkPath<N>& leaving, const WalkExit& at) {
    const auto weight = [&](const RefractedEntry& entry, float pdf) {
      return weight_of_search(leaving.last, entry, pdf);
    };
    radiance += leaving.carried * lamps_->light_from_outside(leaving, at, light, samples, weight);
  };
  const OnLeaving<N> on_leaving = std::ref(add_from_outside);
  bool scatters = space_->advance(path, medium_, numbers, on_leaving);
  for (int event = 0; scatters && event < most_events; ++event) {
    // In detail at the first event only: most light comes from there.
    const Known known = what_is_known(path.ray.origin, event == 0, light);
    const Bands into_path =
        phase(std::max(1.0f - dot(known.direction(), path.ray.direction), 0.0f));
    const Bands from_lamps = into_path * known.lamps;
    // Of a path that goes on in a direction w: scattered + (flow · w) change. Here, their mean.
    const Bands change = reduction_ * known.scattered;
    const Bands expected =
        known.scattered + dot(known.flow(), path.ray.direction) * mean_cosine_ * change;
    radiance += path.carried * (from_lamps + expected);
    if (event == 0)
      reference = std::max(largest(path.carried * (from_lamps + expected)), 0.0f) +
                  least_reference * typical_radiance_;
    const float importance = largest(path.carried) / reference;

    // A search for a lamp, now and then.
    const float most = std::min(largest(path.carried), 1.0f);
    const float going = known.is_known() ? std::clamp(going_scale * importance * known.spread(),
                                                      least_going * most, 1.0f)
                                         : most;
    const float peak = std::max(largest(into_path), 0.25f / pi);
    const float searching =
        lamps_->are_there()
            ? std::clamp(search_scale * peak * importance * known.lamp_spread(), least_search, 1.0f)
            : 0.0f;
    path.last = {path.ray, path.carried, searching, going};
    if (random.uniform_float() < searching) {
      Bands found;
      const float u_light = random.uniform_float();
      const Vec2f u{random.uniform_float(), random.uniform_float()};
      lamps_->search(path.ray.origin, u_light, u, light, [&](const FoundLamp<N>& lamp) {
        found += weight_of_search(path.last, lamp.entry, lamp.pdf) *
                 phase(one_minus_cos(lamp.entry.to_surface, path.ray.direction)) *
                 exp_minus(lamp.entry.length * medium_.sigma_t) * lamp.unweakened;
      });
      radiance += (1.0f / searching) * path.carried * (found - from_lamps);
    }

    // On, now and then.
    if (!(random.uniform_float() < going)) return radiance;
    path.carried *= 1.0f / going;
    scatter(path, numbers);
    radiance +=
        (-1.0f * path.carried) * (known.scattered + dot(known.flow(), path.ray.direction) * change);
    scatters = space_->advance(path, medium_, numbers, on_leaving);
  }
  return radiance;
}

/// Of the two that find the same light of a lamp: a search, and paths that leave. The power
/// heuristic of [VeachGuibas1995] for densities over directions at the event; where a curved
/// boundary focuses light, paths find it more easily. As if every event searched: where few do,
/// the lamp must not be left to paths that meet it by chance.
///
/// @param pdf  with which a search draws the way [1/sr]; infinite for what no path meets
template <int N>
float RandomWalk<N>::weight_of_search(const typename WalkPath<N>::Event& event,
                                      const RefractedEntry& entry, float pdf) const {
  if (!std::isfinite(pdf)) return 1.0f;
  const Bands leaving = exp_minus(entry.length * medium_.sigma_t) *
                        phase(one_minus_cos(entry.to_surface, event.ray.direction)) * event.carried;
  float rival = 0.0f, carried = 0.0f;
  for (int b = 0; b < bands_; ++b) {
    rival += leaving[b];
    carried += event.carried[b];
  }
  rival *= event.going / carried;
  return pdf * pdf / (pdf * pdf + rival * rival);
}

template class RandomWalk<4>;
template class RandomWalk<8>;
template class RandomWalk<16>;

}  // namespace lamina
