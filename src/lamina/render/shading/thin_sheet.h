// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/shading/internal/cosine_table.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/texture.h"

namespace lamina {

/// Layers that light crosses without spreading sideways: a leaf. What it reflects and transmits is
/// exact for every angle of incidence, by adding-doubling; the directions in which scattered light
/// leaves are those of a reciprocal, nearly diffuse lobe.
///
/// All fractions are of the flux that has entered through the boundary on its side, which the
/// renderer keeps apart (SurfaceBoundary), so that coats may cover it.
template <int N>
class ThinSheet {
 public:
  using Bands = BandValues<N>;

  /// @throws InvalidInput if the layers are infinite or lie on a ground.
  explicit ThinSheet(const SurfaceMaterial& material);

  /// One point of the sheet: its thickness in the table.
  struct Place {
    std::size_t row = 0;
    float blend = 0.0f;
  };
  [[nodiscard]] Place place_at(const TextureStore& textures, const SurfacePoint& point) const;

  /// Fractions of light of one direction that are scattered back and through, and the one
  /// that goes straight through.
  struct Fractions {
    Bands reflected, transmitted, straight;
  };
  /// @param side   that the light arrives on: 0 is the first layer's, 1 the last one's
  /// @param cos_i  outside, in [0, 1]
  [[nodiscard]] Fractions fractions(const Place& place, int side, float cos_i) const;

  /// BRDF over what a white Lambertian base of the same boundary has, for both directions on a
  /// side. Symmetric; its flux is `fractions().reflected`.
  [[nodiscard]] Bands reflection(const Place& place, int side, float cos_i, float cos_o) const;

  /// Transmission of light that arrives on a side and leaves on the other.
  [[nodiscard]] Bands transmission(const Place& place, int side, float cos_i, float cos_o) const;

 private:
  struct Side {
    std::array<Fractions, cosine_nodes> at;
    Bands mean_reflected, mean_transmitted;  ///< of diffuse light
  };
  struct Row {
    std::array<Side, 2> sides;
  };
  [[nodiscard]] static Fractions at_cosine(const Side& side, float cos_i);

  ScalarParameter thickness_;         ///< [mm]
  std::vector<float> log_thickness_;  ///< [row], ascending, evenly spaced
  std::vector<Row> rows_;
};

/// [material], null where it is not thin.
template <int N>
using ThinSheets = std::vector<std::unique_ptr<ThinSheet<N>>>;

template <int N>
[[nodiscard]] ThinSheets<N> make_thin_sheets(const Scene& scene);

}  // namespace lamina
