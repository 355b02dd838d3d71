// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/layers/optics/rough/surface_boundary.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/solve/scattering/layered_bsdf/sampled_layers.h"

namespace lamina {

/// The layers of a material as they are at one point, seen from one direction. Directions are in a
/// frame whose +z is the normal, those of light included; light that leaves below is lost.
template <int N>
class LayeredPoint {
 public:
  using Bands = BandValues<N>;

  /// Layers at a point, their table of higher orders, and the color that scales what leaves.
  struct Layers {
    FirstOrderStack<Bands> stack;
    std::optional<HigherOrderBands<N>> own;       ///< where parameters vary
    const HigherOrderBands<N>* higher = nullptr;  ///< else that of the material
    LayeredOrders orders = LayeredOrders::all;
    LayeredFactors factors;
    bool is_bare = false;  ///< the surface is the smooth top of the stack, with nothing over it
    Bands color = Bands::filled(1.0f);
  };
  LayeredPoint(Layers layers, const SurfaceBoundary& boundary, const Vec3f& wo);
  LayeredPoint(const LayeredPoint&) = delete;
  LayeredPoint& operator=(const LayeredPoint&) = delete;

  struct Value {
    Bands bsdf;        ///< [1/sr]
    float pdf = 0.0f;  ///< of sample() [1/sr]
  };
  [[nodiscard]] Value evaluate(const Vec3f& wi, PixelSamples& samples) const;
  struct Sample {
    Vec3f wi;
    Value value;  ///< pdf 0: nothing was drawn
  };
  [[nodiscard]] Sample sample(float u, Vec2f u2, PixelSamples& samples) const;
  /// Whether values are random estimates. Then a sample's value holds for its own density alone,
  /// and densities are only near those of the samples: for weights, not to divide by.
  [[nodiscard]] bool is_random() const { return layers_.orders == LayeredOrders::random_walk; }

  /// Fraction of the light from wo that leaves again scattered: by reciprocity also what uniform
  /// light makes of wo.
  [[nodiscard]] const Bands& reflectance() const { return reflectance_; }
  /// By mirrors below a smooth surface, per radiance from the mirror direction.
  [[nodiscard]] Bands mirrored_inside() const;

 private:
  [[nodiscard]] Value factors(const Vec3f& wi) const;
  [[nodiscard]] Value seen(const typename SampledLayers<N>::Value& value, float mu) const;

  Layers layers_;
  SurfaceBoundary boundary_;
  SampledLayers<N> scattering_;
  Bands entering_;  ///< of wo, over what the smooth top lets through
  Bands reflectance_;
};

inline constexpr std::size_t most_mapped = 4;  ///< quantities of one material

/// A material with layers as a BSDF: method layered_bsdf. Its parameters may follow maps; the first
/// order is worked out for the values at a point, the higher orders come from a table over them.
template <int N>
class LayeredMaterial {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive it.
  /// @throws InvalidInput if boundaries inside are rough, if more than 4 parameters are mapped, and
  ///         for what only methods with a profile know.
  LayeredMaterial(const RenderScene& scene, const BandConversion<N>& conversion,
                  std::uint32_t material);

  [[nodiscard]] std::unique_ptr<LayeredPoint<N>> at(const SurfacePoint& point,
                                                    const SurfaceBoundary& boundary,
                                                    const Vec3f& wo) const;

 private:
  /// Coefficients of what a layer is mixed of.
  struct Part {
    Bands sigma_a, sigma_s, g;
    float fraction = 0.0f;  ///< unless a map says otherwise; of the base, what is left
    bool is_rayleigh = false;
  };
  struct MixedLayer {
    std::optional<Part> base;
    std::vector<Part> parts;
    bool is_mapped = false;
  };
  /// A quantity that a map varies, with the values at which the table has rows.
  struct Parameter {
    const LayerMap* map;
    float low, high;
  };
  /// Whether numbers of a recipe are mapped, so that the table holds the layers, too.
  [[nodiscard]] bool has_skin_maps() const;
  void make_stack();
  void make_table();
  [[nodiscard]] float value_of(const Parameter& parameter, const SurfacePoint& point) const;
  [[nodiscard]] FirstOrderStack<Bands> stack_of(std::span<const float> values) const;
  [[nodiscard]] FirstOrderStack<Bands> stack_between(std::span<const float> values) const;
  /// take(entry, weight) for the entries of the table around the values, multilinear.
  template <class Take>
  void for_corners(std::span<const float> values, const Take& take) const;
  [[nodiscard]] HigherOrderBands<N> higher_of(std::span<const float> values) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  const std::vector<LayerMap>& maps_;
  LayeredOrders orders_;
  FirstOrderStack<Bands> stack_;
  std::vector<MixedLayer> layers_;
  std::vector<Parameter> parameters_;
  int rows_ = 1;                                ///< of the table, in each parameter
  std::vector<HigherOrderBands<N>> table_;      ///< [last parameter] ... [first parameter]
  std::vector<FirstOrderStack<Bands>> stacks_;  ///< likewise, where numbers of a recipe are mapped
  Vec3f mean_color_{1, 1, 1};
};

/// One entry per material, null where it is none or where the method is another one.
template <int N>
using LayeredMaterials = std::vector<std::unique_ptr<LayeredMaterial<N>>>;

}  // namespace lamina
