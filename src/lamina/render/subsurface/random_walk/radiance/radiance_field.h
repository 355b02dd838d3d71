// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/base/spectrum/brief_bands.h"
#include "lamina/render/subsurface/random_walk/interior/body_interior.h"
#include "lamina/render/subsurface/random_walk/interior/manifold_next_event.h"
#include "lamina/render/subsurface/random_walk/radiance/direct_light_field.h"
#include "lamina/render/subsurface/random_walk/radiance/field_radiance.h"

namespace lamina {

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

  /// Multiplies all that is solved, to show that paths have the same mean with any field.
  void scale(float factor);

 private:
  const BodyInterior<N>& interior_;
  const ManifoldNextEvent<N>& next_event_;
  Bands reduction_;          ///< [band] of the extinction: reduced over own
  WalkMedium<N> reduced_;    ///< coefficients by similarity: isotropic scattering
  float reduced_free_path_;  ///< the shortest [mm]
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
