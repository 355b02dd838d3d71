// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/render/subsurface/random_walk/internal/direct_light_field.h"
#include "lamina/render/subsurface/random_walk/internal/manifold_next_event.h"
#include "lamina/spectrum/band_values.h"
#include "lamina/spectrum/brief_bands.h"

namespace lamina {

/// What a precomputed radiance field says of a point: what a path may expect to find at a
/// scattering event there. Means, with how far single estimates are from them.
template <int N>
struct FieldRadiance {
  BandValues<N> direct_fluence;   ///< of light that comes straight from lights
  BandValues<N> scattered;        ///< mean radiance of all other light
  Vec3f to_light;                 ///< mean direction towards the lights, length at most 1
  float deviation = 0.0f;         ///< root mean square of that of `scattered`
  float direct_deviation = 0.0f;  ///< of `direct_fluence`, at most
  /// Three times the net flux of `scattered` over its fluence, the P1 moment, towards where it
  /// comes from: radiance from a direction w is `scattered` (1 + net_flux · w), about.
  Vec3f net_flux;

  /// Whether `scattered` was precomputed.
  [[nodiscard]] bool is_solved() const { return deviation > 0.0f; }
};

/// A precomputed radiance field inside a body of one homogeneous medium: a control variate of
/// random walks. A path adds what the field expects at an event and, at random, estimates it by
/// next-event estimation or by going on, and adds the difference over the probability of doing so.
/// So the mean is that of complete paths, whatever the field holds, and few paths need to be
/// complete.
///
/// It solves the radiative transfer equation on a lattice: from points around each node, isotropic
/// segments of a random walk are sampled once; the light at a node is the mean of that at their
/// ends. Anisotropic scattering is taken as isotropic with the reduced coefficients, so that the
/// lattice needs only be as fine as the reduced free path; of the direction the P1 moment is left.
template <int N>
class RadianceField {
 public:
  using Bands = BandValues<N>;

  /// @param mean_cosine  of the phase function
  RadianceField(const BodyInterior<N>& interior, const ManifoldNextEvent<N>& next_event,
                const WalkMedium<N>& medium, const Bands& mean_cosine);

  /// Precomputes `scattered`. Without it the mean of paths is the same, at more work.
  /// @return  false if `progress` asked to stop; nothing is solved then
  [[nodiscard]] bool solve(const LightGatherer<N>& light, const Progress& progress);

  /// @param in_detail  with direct light by its own, finer lattice
  [[nodiscard]] FieldRadiance<N> at(const Vec3f& p, bool in_detail,
                                    const LightGatherer<N>& light) const;

  /// Mean of `scattered_along` for a path that comes in a direction and scatters by the phase
  /// function.
  [[nodiscard]] Bands mean_scattered(const FieldRadiance<N>& here, const Vec3f& incoming) const {
    return here.scattered +
           dot(here.net_flux, incoming) * mean_cosine_ * (reduction_ * here.scattered);
  }
  /// Scattered radiance per sigma_s that a path which goes on in a direction may expect.
  [[nodiscard]] Bands scattered_along(const FieldRadiance<N>& here, const Vec3f& direction) const {
    return here.scattered + dot(here.net_flux, direction) * (reduction_ * here.scattered);
  }

  /// Multiplies all that is solved, to show that paths have the same mean with any field.
  void scale(float factor);

 private:
  const BodyInterior<N>& interior_;
  const ManifoldNextEvent<N>& next_event_;
  Bands mean_cosine_, reduction_;  ///< [band]; of the extinction, reduced over own
  WalkMedium<N> reduced_;          ///< coefficients by similarity: isotropic scattering
  float reduced_free_path_;        ///< the shortest [mm]
  DirectLightField<N> direct_;
  std::optional<NodeLattice> lattice_;  ///< once solved
  /// In 16 bits each: a third of the time went into waiting for nodes from memory.
  struct Node {
    BriefBands<N> scattered, direct_fluence;
    BriefBands<8> moments;  ///< to_light, deviation, direct_deviation, net_flux
  };
  std::vector<Node> nodes_;
};

}  // namespace lamina
