// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina {

/// Fraction of the flux that an interface with Torrance and Sparrow's facets reflects, over
/// roughness and angle: light from outside. Made once per material, evaluated often.
class BoundaryReflectance {
 public:
  /// @param ior           index inside over outside, > 0
  /// @param is_mapped     whether the roughness varies; else it is the only one that is tabulated
  BoundaryReflectance(float ior, MicrofacetDistribution distribution, float roughness,
                      bool is_mapped);

  /// @param cos_i  in [0, 1]
  [[nodiscard]] float at(float roughness, float cos_i) const;

  /// For diffuse light: the integral of 2 mu reflectance(mu).
  [[nodiscard]] float diffuse(float roughness) const;

  [[nodiscard]] float ior() const { return ior_; }
  [[nodiscard]] MicrofacetDistribution distribution() const { return distribution_; }

 private:
  static constexpr int angles = 65;
  struct Row {
    std::array<float, angles> reflectance;  ///< at the cosines i / (angles - 1)
    float diffuse;
  };
  struct Place {
    std::size_t row;
    float blend;
  };
  [[nodiscard]] Place find_row(float roughness) const;

  float ior_;
  MicrofacetDistribution distribution_;
  std::vector<float> roughness_;  ///< [row], ascending
  std::vector<Row> rows_;
};

/// A boundary at one point of a surface, covering a share of it.
struct SpecularLobe {
  const BoundaryReflectance* table = nullptr;
  float roughness = 0.0f;  ///< microfacet alpha
  float share = 1.0f;      ///< of the surface, in [0, 1]
};

/// Boundary over the base of an opaque surface at one point: nothing, a boundary, or several side
/// by side. Each light ray crosses one of them. What they reflect does not enter, and what is
/// inside leaves with the angular distribution of what they let through, so light is never lost
/// twice: a base of reflectance 1 under any boundary returns exactly all light.
///
/// Directions are unit vectors in a frame whose +z is the normal, away from the surface.
struct SurfaceBoundary {
  static constexpr int most = 7;  ///< two of a coat, four of coverings, and the material's own
  std::array<SpecularLobe, most> lobes;
  int count = 0;

  /// Shares sum to 1 at most.
  void add(const SpecularLobe& lobe) {
    if (lobe.share > 0.0f) lobes[static_cast<std::size_t>(count++)] = lobe;
  }
};

/// Fraction of the flux from a direction of cosine cos_i that the boundary reflects.
[[nodiscard]] float reflectance(const SurfaceBoundary& boundary, float cos_i);

/// Radiance leaving to a direction of cosine cos_o for unit exitant flux density under the
/// boundary [1/sr]: (1 - reflectance) over its projected integral, 1 / pi without a boundary.
[[nodiscard]] float exit_distribution(const SurfaceBoundary& boundary, float cos_o);

/// Radiance mirrored to wo per irradiance from wi [1/sr]. Smooth lobes count as 0.
[[nodiscard]] float specular_brdf(const SurfaceBoundary& boundary, const Vec3f& wi,
                                  const Vec3f& wo);

/// Density with which sample_specular draws wi [1/sr], smooth lobes left out.
[[nodiscard]] float pdf_specular(const SurfaceBoundary& boundary, const Vec3f& wo, const Vec3f& wi);

struct SpecularSample {
  Vec3f wi;
  float weight = 0.0f;  ///< brdf * cos_i / pdf over all lobes; 0: absorbed
  float pdf = 0.0f;     ///< [1/sr]; unused if is_mirror
  bool is_mirror = false;
};

/// Draws a direction from which light is mirrored to wo.
[[nodiscard]] SpecularSample sample_specular(const SurfaceBoundary& boundary, const Vec3f& wo,
                                             float u_lobe, Vec2f u);

}  // namespace lamina
