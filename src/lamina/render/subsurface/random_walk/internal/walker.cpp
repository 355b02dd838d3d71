// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walker.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "lamina/base/core/float_pi.h"
#include "lamina/layers/optics/henyey_greenstein.h"

namespace lamina {
namespace {

constexpr int most_steps = 200'000;
// Probabilities of next-event estimation and of going on where a radiance field is the control
// variate: these times what either may change of the light that the path finds, and at least so
// much. By the least work for the same noise: benchmarks/subsurface_methods.
constexpr float next_event_scale = 3.0f, least_next_event = 0.05f;
constexpr float continuation_scale = 4.0f, least_continuation = 0.1f;
// The same by DepthRadiance, whose deviation is that of all that paths find after, and which may
// miss what they find seldom; and of next-event estimation as it were without it, at least so much:
// benchmarks/subsurface_methods.
constexpr float continuation_scale_by_depth = 2.0f, least_continuation_by_depth = 0.5f;
constexpr float next_event_share_by_depth = 0.5f;

}  // namespace

/// What a radiance field expects at an event, and the probabilities that follow from it.
template <int N>
struct Walker<N>::Expectation {
  FieldRadiance<N> field;
  Bands direct;  ///< scattered into the path
  float next_event = 0.0f, continuation = 1.0f;
};

template <int N>
Walker<N>::Walker(const WalkMedia<N>& media, const MediaPlace<N>& start, const WalkPath<N>& path,
                  const LightGatherer<N>& light, PixelSamples& samples, float least_reference)
    : media_(media),
      light_(light),
      samples_(samples),
      numbers_(samples),
      path_(path),
      place_(start),
      last_place_(start),
      least_reference_(least_reference) {}

template <int N>
BandValues<N> Walker<N>::trace(bool with_unscattered) {
  with_unscattered_ = with_unscattered;
  if (place_.medium->is_homogeneous) {
    trace_homogeneous();
    return radiance_;
  }
  bool goes_on = true;
  for (int steps = 0; goes_on && steps < most_steps; ++steps) {
    const Step step = advance();
    switch (step.end) {
      case Step::End::event:
        goes_on = scatter();
        break;
      case Step::End::layer:
        meet_layer(step.crossing);
        break;
      case Step::End::surface:
        goes_on = meet_surface(step.surface);
        break;
      case Step::End::lost:
        goes_on = false;
        break;
    }
  }
  return radiance_;
}

/// The special case of a closed body of one medium by itself: it knows its surfaces.
template <int N>
void Walker<N>::trace_homogeneous() {
  const BodyMedium<N>& medium = *place_.medium;
  const auto add_escaping = [&](const WalkPath<N>& leaving, const WalkExit& exit) {
    if (!with_unscattered_ && leaving.events == 0) return;
    radiance_ += leaving.throughput * escaping_radiance(leaving, exit);
  };
  const OnEscape<N> on_escape = std::ref(add_escaping);
  for (int steps = 0; steps < most_steps; ++steps)
    if (!medium.interior.advance(path_, medium.layers.medium(0), numbers_, on_escape) || !scatter())
      return;
}

template <int N>
bool Walker<N>::expects() const {
  const BodyMedium<N>& medium = *place_.medium;
  return medium.field ||
         (medium.depth_radiance && medium.depth_radiance->has_learned() && place_.depth.is_exact);
}

/// Adds what a radiance field expects at an event.
template <int N>
typename Walker<N>::Expectation Walker<N>::add_expectation() {
  const BodyMedium<N>& medium = *place_.medium;
  const WalkLayers<N>& layers = medium.layers_at(path_.events);
  const WalkLayers<N>& onward = medium.layers_after(path_.events);
  const bool is_first = reference_ == 0.0f;
  const Vec3f& direction = path_.ray.direction;
  // In detail at the first event only: most light comes from there.
  Expectation expected{.field = medium.field
                                    ? medium.field->at(path_.ray.origin, is_first, light_)
                                    : medium.depth_radiance->at(place_.depth, onward,
                                                                &onward != &medium.layers, light_)};
  const Bands phase =
      layers.phase(place_.depth, std::max(1.0f - dot(expected.field.to_light, direction), 0.0f));
  expected.direct = phase * expected.field.direct_fluence;
  const Bands radiance =
      path_.throughput *
      (expected.direct + expected.field.mean(direction, layers.mean_cosine(place_.depth)));
  radiance_ += radiance;
  if (is_first) reference_ = std::max(largest(radiance), 0.0f) + least_reference_;

  const float throughput = largest(path_.throughput), importance = throughput / reference_;
  const float most = std::min(throughput, 1.0f);
  const auto continuation = [&](float scale, float least) {
    return std::clamp(scale * importance * expected.field.deviation, least * most, 1.0f);
  };
  expected.continuation = most;
  if (expected.field.is_solved())
    expected.continuation =
        medium.field ? continuation(continuation_scale, least_continuation)
                     : continuation(continuation_scale_by_depth, least_continuation_by_depth);
  const float peak = std::max(largest(phase), 0.25f / float_pi);
  if (medium.next_event.has_lights() && layers.sees_out(place_.depth.layer)) {
    float rate = next_event_scale * peak * importance * expected.field.direct_deviation;
    if (!medium.field)
      rate = std::max(rate, next_event_share_by_depth * most *
                                std::exp(-layers.least_optical_depth(place_.depth)));
    expected.next_event = std::clamp(rate, least_next_event, 1.0f);
  }
  return expected;
}

/// Adds light that is scattered into the path at an event; samples whether it goes on, and where.
template <int N>
bool Walker<N>::scatter() {
  if (!(largest(path_.throughput) > 0.0f)) return false;  // all of it is absorbed
  const BodyMedium<N>& medium = *place_.medium;
  const WalkLayers<N>& layers = medium.layers_at(path_.events);
  const bool has_field = expects();
  Expectation expected;
  if (has_field) {
    expected = add_expectation();
  } else {
    expected.continuation = std::min(largest(path_.throughput), 1.0f);
    // From deep inside next-event estimation finds little, and is rare.
    const bool sees_lights =
        medium.is_rough ? finds_light_through_facets(medium) : layers.sees_out(place_.depth.layer);
    if (medium.next_event.has_lights() && sees_lights)
      expected.next_event =
          std::clamp(std::exp(-layers.least_optical_depth(place_.depth)), least_next_event, 1.0f);
  }
  // With a field, MIS counts next-event estimation as if every event did it: where few do, lights
  // must not be left to paths that meet them by chance.
  typename WalkPath<N>::Event event{path_.ray, path_.throughput,
                                    has_field ? 1.0f : expected.next_event, expected.continuation};
  const LightVertices<N>* vertices = medium.light_vertices.get();
  if (vertices && !vertices->is_empty()) {
    const Vec3f bend = path_.ray.direction - path_.last.turned;
    event.is_straight = dot(bend, bend) == 0.0f;
    event.before = path_.last.ray.origin;
    event.phase_before = largest(layers.phase(
        last_place_.depth, one_minus_cos(path_.last.ray.direction, path_.last.turned)));
    radiance_ += path_.throughput * sample_light_vertex();
  }
  path_.last = event;
  last_place_ = place_;

  Random& random = numbers_.stream();
  if (random.uniform_float() < expected.next_event) {
    const Bands found = medium.is_rough ? sample_light_through_facets() : sample_direct_light();
    radiance_ += (1.0f / expected.next_event) * path_.throughput * (found - expected.direct);
  }
  if (!(random.uniform_float() < expected.continuation)) return false;
  path_.throughput *= 1.0f / expected.continuation;
  layers.sample_phase(place_.depth, path_, numbers_);
  path_.last.turned = path_.ray.direction;
  if (has_field)
    radiance_ += (-1.0f * path_.throughput) * expected.field.along(path_.ray.direction);
  if (record_)
    record_->events.push_back({place_.depth, path_.ray.direction,
                               &medium.layers_after(path_.events) != &medium.layers,
                               path_.throughput, radiance_});
  return true;
}

template class Walker<4>;
template class Walker<8>;
template class Walker<16>;

}  // namespace lamina
