// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/render/subsurface/random_walk/internal/manifold_next_event.h"
#include "lamina/spectrum/band_values.h"
#include "lamina/spectrum/brief_bands.h"

namespace lamina {

/// About the light at places inside: that straight from lamps, and all other, what a path may
/// expect when it goes on from there. Paths add it, and correct it at random by searching and going
/// on, so that the mean is that of doing so always.
///
/// It solves the equation of transport on a lattice: from places around each node, isotropic
/// segments of a random walk are drawn once; the light at a node is the mean of that at their ends.
/// Anisotropic scattering is taken as isotropic with the reduced coefficients, so that the lattice
/// needs only be as fine as the reduced free path, and what is known has no direction.
template <int N>
class WalkLight {
 public:
  using Bands = BandValues<N>;

  struct Known {
    Bands scattered;  ///< radiance that is scattered into any direction, per sigma_s
    Bands lamps;      ///< fluence straight from lamps
    /// Mean direction towards the lamps (3); of single estimates around the mean: the root mean
    /// square of `scattered`, the largest of `lamps`; flow (3).
    BandValues<8> others;

    [[nodiscard]] bool is_known() const { return spread() > 0.0f; }
    [[nodiscard]] Vec3f direction() const { return {others[0], others[1], others[2]}; }
    [[nodiscard]] float spread() const { return others[3]; }
    [[nodiscard]] float lamp_spread() const { return others[4]; }
    /// A path that goes on in a direction w may expect `scattered` (1 + flow · w), about.
    [[nodiscard]] Vec3f flow() const { return {others[5], others[6], others[7]}; }
  };

  /// Until then nothing is known.
  ///
  /// @param reduced    the medium with reduced coefficients
  /// @param free_path  shortest of it [mm]
  /// @return           false if `progress` asked to stop; nothing is known then
  [[nodiscard]] bool find_out(const WalkSpace<N>& space, const WalkMedium<N>& reduced,
                              float free_path, const WalkLamps<N>& lamps,
                              const LightGatherer<N>& light, const Progress& progress);

  [[nodiscard]] Known at(const Vec3f& p) const;

  /// Multiplies all light that is known.
  void scale(float factor);

 private:
  std::vector<NodeLattice> lattice_;  ///< none or one
  /// In 16 bits each: a third of the time went into waiting for nodes from memory.
  struct Node {
    BriefBands<N> scattered, lamps;
    BriefBands<8> others;
  };
  std::vector<Node> nodes_;
};

}  // namespace lamina
