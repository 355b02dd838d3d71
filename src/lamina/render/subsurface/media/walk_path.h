// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// The random numbers of a path: of a pixel's, stratified over its samples for the first events.
class WalkNumbers {
 public:
  explicit WalkNumbers(PixelSamples& samples)
      : samples_(&samples), random_(make_stream(samples)), left_(2 * dealt_events) {}
  explicit WalkNumbers(const Random& random) : random_(random) {}
  [[nodiscard]] Vec2f pair() {
    if (left_ > 0) {
      --left_;
      return samples_->next_2d();
    }
    const float x = random_.uniform_float();
    return {x, random_.uniform_float()};
  }
  [[nodiscard]] Random& stream() { return random_; }

 private:
  static constexpr int dealt_events = 4;
  PixelSamples* samples_ = nullptr;
  Random random_;
  int left_ = 0;
};

/// A path inside a medium, followed from the eye.
template <int N>
struct WalkPath {
  Ray ray;
  BandValues<N> throughput;
  int events = 0;                       ///< that it has had
  bool has_scattered = false;           ///< and met no surface since
  bool is_reflected_once = false;       ///< by the smooth boundary, since it scattered
  bool is_reflected_diffusely = false;  ///< by an object inside, since it scattered
  float clearance = 0.0f;               ///< lower bound of the distance to a surface [mm]

  /// At a surface it is followed in and out, with the share of each, and not one of them by chance:
  /// little is as bright as lamps that shine straight through thin parts, and few paths meet them.
  [[nodiscard]] bool leaves_for_certain() const { return events < 2; }

  /// Whether light comes straight from its last event, but for refraction at boundaries of layers.
  bool comes_from_event = false;

  /// The last scattering event, before the path turned there.
  struct Event {
    Ray ray;
    BandValues<N> throughput;
    float next_event_rate = 0.0f;  ///< of next-event estimation, as MIS weights count it
    float continuation = 1.0f;     ///< probability that the path went on
    Vec3f turned;                  ///< the direction in which it did

    /// The event before, where it is the other end of the straight way to this one.
    bool is_straight = false;
    Vec3f before;
    float phase_before = 0.0f;  ///< the phase function there [1/sr]
  } last{};
};

/// The coefficients of a medium.
template <int N>
struct WalkMedium {
  BandValues<N> sigma_s, sigma_t;      ///< [1/mm]
  BandValues<N> sigma_t_over_least{};  ///< of the bands
  float longest_free_path = 0.0f;      ///< of the bands [mm]; may be infinite
};
/// @param bands  those of all lanes that count
template <int N>
[[nodiscard]] WalkMedium<N> make_walk_medium(const BandValues<N>& sigma_s,
                                             const BandValues<N>& sigma_t, int bands) {
  WalkMedium<N> medium{.sigma_s = sigma_s, .sigma_t = sigma_t};
  const float least = *std::min_element(sigma_t.v, sigma_t.v + bands);
  medium.longest_free_path = 1.0f / least;
  // Lanes beyond the bands are copies of the last, and decay as it does.
  for (int b = 0; b < N; ++b) medium.sigma_t_over_least[b] = sigma_t[b] - least;
  return medium;
}

/// Samples a band in proportion to its throughput. Source: the first step of hero-wavelength
/// sampling, [Wilkie2014]; all bands count by the density of the mixture.
template <int N>
[[nodiscard]] int sample_band(const BandValues<N>& throughput, int bands, float u) {
  float total = 0.0f;
  for (int b = 0; b < bands; ++b) total += throughput[b];
  float left = u * total;
  for (int b = 0; b + 1 < bands; ++b) {
    if (left < throughput[b]) return b;
    left -= throughput[b];
  }
  return bands - 1;
}

}  // namespace lamina
