// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/materials/material.h"
#include "lamina/optics/phase_function.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/random_walk/internal/depth_layers.h"
#include "lamina/render/subsurface/random_walk/internal/walk_path.h"
#include "lamina/scattering/layered_bsdf/first_order.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// The medium inside the meshes of one translucent or dielectric material: layers by depth, each
/// with an index of refraction of its own. The last layer fills the rest.
template <int N>
class WalkLayers {
 public:
  using Bands = BandValues<N>;

  WalkLayers(const RenderScene& scene, const BandConversion<N>& conversion, std::uint32_t material);

  [[nodiscard]] const DepthLayers& by_depth() const { return by_depth_; }
  [[nodiscard]] const WalkMedium<N>& medium(std::size_t layer) const {
    return layers_[layer].medium;
  }
  [[nodiscard]] int bands() const { return bands_; }
  [[nodiscard]] float ior() const { return ior_; }  ///< of the first layer over that outside
  [[nodiscard]] float own_ior(std::size_t layer) const { return layers_[layer].ior; }
  /// Whether no boundary above a layer refracts.
  [[nodiscard]] bool sees_out(std::size_t layer) const { return layers_[layer].sees_out; }
  /// The upper boundary of a layer.
  [[nodiscard]] const Interface& boundary(std::size_t layer) const { return layers_[layer].top; }
  [[nodiscard]] float shortest_free_path() const;  ///< of all layers and bands [mm]
  /// Of the flux that enters flat layers.
  [[nodiscard]] const Bands& diffuse_reflectance() const { return reflectance_; }

  /// Along a straight segment inside; huge where a boundary of layers refracts.
  [[nodiscard]] Bands optical_thickness(const Ray& ray, const DepthLayers::Place& start,
                                        float length) const;
  /// A lower bound, for the shortest way out in the band where it is least.
  [[nodiscard]] float least_optical_depth(const DepthLayers::Place& place) const;

  /// The least extinction that a band has in any layer [1/mm].
  [[nodiscard]] float least_extinction(int band) const { return least_extinction_[band]; }

  [[nodiscard]] Bands phase(std::size_t layer, float one_minus_cos) const;
  [[nodiscard]] Bands mean_cosine(std::size_t layer) const;  ///< of the phase function
  /// Samples the phase function of a band, each in proportion to its throughput; all bands count by
  /// the density of the mixture.
  void sample_phase(std::size_t layer, WalkPath<N>& path, WalkNumbers& numbers) const;

 private:
  WalkLayers(const RenderScene& scene, std::uint32_t material, const Material& inside);

  struct Layer {
    WalkMedium<N> medium;
    std::vector<PhaseFunction> phases;  ///< [band]
    bool is_same_phase = true;          ///< in all bands
    bool is_isotropic = false;
    Interface top;
    float ior = 0.0f;               ///< over that of vacuum
    bool sees_out = true;           ///< no layer above refracts
    float least_depth = 0.0f;       ///< optical, of its top in the band where it is least
    float least_extinction = 0.0f;  ///< of the bands [1/mm]
  };
  DepthLayers by_depth_;
  std::vector<Layer> layers_;
  FirstOrderStack<Bands> stack_;
  Bands reflectance_, least_extinction_;
  int bands_;
  float ior_ = 0.0f;
};

}  // namespace lamina
