// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/phase_function.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/depth_layers/depth_layers.h"
#include "lamina/render/subsurface/depth_layers/layer_maps.h"
#include "lamina/render/subsurface/media/walk_path.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {

/// The medium inside the meshes of one translucent or dielectric material: layers by depth, each
/// with an index of refraction of its own; thickness, coefficients and absorbing sheets between
/// layers may be maps. The last layer fills the rest.
template <int N>
class WalkLayers {
 public:
  using Bands = BandValues<N>;
  using Place = DepthLayers::Place;
  using Crossing = DepthLayers::Crossing;

  /// @param is_quiet  as quiet_layers, if it is translucent
  WalkLayers(const RenderScene& scene, const BandConversion<N>& conversion, std::uint32_t material,
             bool is_quiet = false);

  /// Layers with isotropic scattering, by similarity: sigma_s and the extinction less sigma_s
  /// times the mean cosine. Shares what is large.
  [[nodiscard]] WalkLayers with_even_scattering() const;

  [[nodiscard]] const DepthLayers& by_depth() const { return *by_depth_; }
  /// Medium of a layer without maps.
  [[nodiscard]] const WalkMedium<N>& medium(std::size_t layer) const {
    return layers_[layer].medium;
  }
  /// Whether the coefficients of a layer are maps; or of any.
  [[nodiscard]] bool is_mapped(std::size_t layer) const { return maps_->layers[layer].is_mapped(); }
  [[nodiscard]] bool has_maps() const { return maps_->is_mapped(); }
  /// The largest of each band in a layer [1/mm].
  [[nodiscard]] const Bands& most_extinction(std::size_t layer) const {
    return layers_[layer].most;
  }
  struct Coefficients {
    Bands sigma_s, sigma_t;  ///< [1/mm]
  };
  /// At the texel of a place.
  [[nodiscard]] Coefficients coefficients(const Place& place) const {
    const auto& [sigma_s, sigma_t, g, sheet, most, least] = maps_->layers[place.layer];
    Coefficients here{sigma_s[sigma_s.size() > 1 ? place.texel : 0],
                      sigma_t[sigma_t.size() > 1 ? place.texel : 0]};
    if (is_even_) {
      const Bands off = taken_off(place.layer, place.texel);
      here.sigma_s = here.sigma_s - off;
      here.sigma_t = here.sigma_t - off;
    }
    return here;
  }
  [[nodiscard]] std::size_t sample_texel(const Place& place, float u) const {
    return by_depth_->grid().sample(place.uv, u);
  }
  /// Optical thickness of the absorbing sheet between two layers, for a path that crosses it
  /// aslant.
  [[nodiscard]] Bands crossing_thickness(std::size_t from, const Crossing& crossing,
                                         const Vec3f& direction) const;
  [[nodiscard]] int bands() const { return bands_; }
  [[nodiscard]] float ior() const { return ior_; }  ///< of the first layer over that outside
  [[nodiscard]] float own_ior(std::size_t layer) const { return layers_[layer].ior; }
  /// Whether no boundary above a layer refracts.
  [[nodiscard]] bool sees_out(std::size_t layer) const { return layers_[layer].sees_out; }
  /// The upper boundary of a layer.
  [[nodiscard]] const Interface& boundary(std::size_t layer) const { return layers_[layer].top; }
  [[nodiscard]] float shortest_free_path() const;  ///< of all layers and bands [mm]
  /// Shortest free path with isotropic scattering in place of anisotropic, by similarity, in the
  /// last layer.
  [[nodiscard]] float shortest_reduced_free_path() const;
  /// Diffuse reflectance of the flat layers, of the flux that enters.
  [[nodiscard]] const Bands& diffuse_reflectance() const { return reflectance_; }

  /// Along a straight segment inside; huge where a boundary of layers refracts. Coefficients that
  /// are maps count as those at the texture coordinates of the start.
  [[nodiscard]] Bands optical_thickness(const Ray& ray, const Place& start, float length,
                                        const Place& end) const;
  /// An unbiased estimate of the transmittance of a segment over exp(-optical_thickness), which is
  /// 1 without maps. Source: residual ratio tracking, [Novak2014] Eq. 12.
  [[nodiscard]] Bands sample_residual(const Ray& ray, const Place& start, float length,
                                      const Place& end, Random& random) const;
  /// Optical depth of layers that lie flat above an exact place, about: as the texels beside it
  /// are.
  [[nodiscard]] Bands optical_depth(const Place& place) const;
  /// A lower bound, for the shortest way out in the band where it is least.
  [[nodiscard]] float least_optical_depth(const Place& place) const;

  [[nodiscard]] Bands phase(const Place& place, float one_minus_cos) const;
  /// Mean cosine of the phase function of a layer without maps of it; at a place.
  [[nodiscard]] const Bands& mean_cosine(std::size_t layer) const {
    return layers_[layer].mean_cosine;
  }
  [[nodiscard]] const Bands& mean_cosine(const Place& place) const {
    const auto& g = maps_->layers[place.layer].g;
    return is_even_ || g.empty() ? mean_cosine(place.layer) : g[place.texel];
  }
  /// Samples the phase function of a band, each in proportion to its throughput; all bands count by
  /// the density of the mixture.
  void sample_phase(const Place& place, WalkPath<N>& path, WalkNumbers& numbers) const;

 private:
  WalkLayers(const RenderScene& scene, std::uint32_t material, const SheetedLayers& sheeted,
             float tolerance);
  /// sigma_s times the mean cosine where that is taken off, at a texel.
  [[nodiscard]] Bands taken_off(std::size_t layer, std::size_t texel) const {
    const auto& [sigma_s, sigma_t, g, sheet, most, least] = maps_->layers[layer];
    return (g.empty() ? layers_[layer].true_mean_cosine : g[texel]) *
           sigma_s[sigma_s.size() > 1 ? texel : 0];
  }
  /// The extinction of a layer at texture coordinates.
  [[nodiscard]] Bands extinction(std::size_t layer, Vec2f uv) const;

  struct Layer {
    WalkMedium<N> medium;
    std::vector<PhaseFunction> phases;    ///< [band]
    Bands mean_cosine, true_mean_cosine;  ///< of them; before it was taken off
    Bands most, least;                    ///< extinction [1/mm]
    bool is_same_phase = true;            ///< in all bands
    bool is_isotropic = false;
    Interface top;
    float ior = 0.0f;               ///< over that of vacuum
    bool sees_out = true;           ///< no layer above refracts
    float least_depth = 0.0f;       ///< optical, of its top in the band where it is least
    float least_extinction = 0.0f;  ///< of the bands [1/mm]
  };
  std::shared_ptr<const LayerMaps<N>> maps_;
  std::shared_ptr<const DepthLayers> by_depth_;
  std::vector<Layer> layers_;
  FirstOrderStack<Bands> stack_;
  Bands reflectance_;
  int bands_;
  float ior_ = 0.0f;
  bool is_even_ = false;
};

}  // namespace lamina
