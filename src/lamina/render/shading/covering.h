// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/shading/internal/cosine_table.h"
#include "lamina/render/shading/render_scene.h"

namespace lamina {

/// Table of how thin coverings change the light of the surface that they lie on, where each
/// combination of them lies: layers solved by adding-doubling between the outside and what is below
/// them.
///
/// Light that enters or leaves passes the coverings at that very point. What is below sends light
/// up that they return in part: of a base that returns R of the light that comes down to it, the
/// part that leaves is t / (1 - r R), with what they let through and return of diffuse light from
/// below, t and r. Totals are exact for a base without end and light that is diffuse below; that
/// coverings widen the spread of light, by what they return, is left out.
///
/// All fractions are of the flux that has entered through the boundary on top, which the renderer
/// keeps apart (SurfaceBoundary). Source: adding of layers, [Plass1973].
template <int N>
class CoveringTable {
 public:
  using Bands = BandValues<N>;
  static constexpr std::size_t most_states = std::size_t{1} << most_coverings;

  /// @param material  index of one that has coverings
  /// @throws InvalidInput if a layer of theirs is infinite
  CoveringTable(const RenderScene& scene, std::uint32_t material);

 private:
  template <int M>
  friend class CoverAt;
  struct State {
    std::array<Bands, cosine_nodes> reflected, through;
    Bands mean_reflected;  ///< of diffuse light
    Bands below;           ///< of diffuse light from below, what comes back there
    /// Fraction of diffuse light from below that leaves, over the mean of `through`: by reciprocity
    /// what passes the top boundary of diffuse light from outside, over the square of the index
    /// below.
    float leaving = 1.0f;

    /// All but `leaving` of a band; bands can be solved at once.
    void solve(const LayerStack& stack, int band);
  };

  std::vector<State> states_;  ///< [bit i: covering i lies there]; 0 is the bare surface
};

/// [material], null where nothing covers it.
template <int N>
using Coverings = std::vector<std::unique_ptr<CoveringTable<N>>>;

template <int N>
[[nodiscard]] Coverings<N> make_coverings(const RenderScene& scene);

/// The coverings at one point of a surface.
template <int N>
class CoverAt {
 public:
  using Bands = BandValues<N>;

  /// @param share  of the states of the table, sum 1
  CoverAt(const CoveringTable<N>& table,
          const std::array<float, CoveringTable<N>::most_states>& share)
      : table_(&table), share_(share) {}

  /// Fraction of the light of a direction that comes down to what is covered; and, for that which
  /// leaves, the factor on what would leave the bare surface.
  [[nodiscard]] Bands through(float cos_i) const;
  /// The mean of that over diffuse light.
  [[nodiscard]] Bands mean_through() const;

  /// Fraction of the light of a direction that the coverings scatter back by themselves.
  [[nodiscard]] Bands reflected(float cos_i) const;
  /// The BRDF of that over what a white Lambertian base of the same boundary has; symmetric.
  [[nodiscard]] Bands reflection(float cos_i, float cos_o) const;

  /// Factor on all light that comes from below, by what the coverings return to it, where light
  /// spreads from what is covered to what is bare.
  /// @param reflectance  of the bare surface, of the flux that has entered
  [[nodiscard]] Bands returning(const Bands& reflectance) const;

  /// Like `reflection`, of the light that a matte surface below sends back. It stays below what it
  /// came through.
  [[nodiscard]] Bands matte_reflection(float cos_i, float cos_o, const Bands& reflectance) const;

 private:
  template <class Value>
  [[nodiscard]] Bands sum_of(const Value& value) const;

  const CoveringTable<N>* table_;
  std::array<float, CoveringTable<N>::most_states> share_;
};

/// None where nothing covers a point, or only on its other side.
template <int N>
[[nodiscard]] std::optional<CoverAt<N>> cover_at(const RenderScene& scene,
                                                 const Coverings<N>& coverings,
                                                 const SurfacePoint& point);

}  // namespace lamina
