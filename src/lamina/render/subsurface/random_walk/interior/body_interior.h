// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/bodies/closed_bodies.h"
#include "lamina/render/subsurface/bodies/distance_field.h"
#include "lamina/render/subsurface/media/walk_path.h"

namespace lamina {

/// Where a path leaves, and its direction outside.
struct WalkExit {
  SurfacePoint point;
  Vec3f outside;
};
/// Called for a path that leaves, as it is on its last segment inside.
template <int N>
using OnEscape = std::function<void(const WalkPath<N>&, const WalkExit&)>;

/// The direction in which a smooth boundary reflects light inside: by its smooth normal, unless
/// that sends it outside.
[[nodiscard]] Vec3f reflect_inside(const SurfacePoint& point, const Vec3f& direction);

/// The inside of all meshes of one material, with its distance field and the objects in it.
///
/// An opaque object inside reflects diffusely, as its base does.
template <int N>
class BodyInterior {
 public:
  using Bands = BandValues<N>;

  /// @param ior        inside over outside
  /// @param free_path  the shortest of the medium [mm]
  BodyInterior(const RenderScene& scene, const BandConversion<N>& conversion,
               std::uint32_t material, float ior, int bands, float free_path);

  /// Free-path sampling in one homogeneous medium with a smooth boundary: follows a path, reflected
  /// by surfaces, to its next scattering event (before it turns there). A free path is
  /// sampled for one band and weighted for all by the density of the mixture of bands, so that the
  /// throughput summed over the bands never grows.
  ///
  /// Where no environment light shines, scattering is forced: a path does not end where it leaves,
  /// but always goes on inside with less throughput. For most that leave find no light, so whether
  /// they do is but noise. So it is everywhere before the second event, and all that leaves is
  /// followed: a lamp that shines straight through thin parts is seen without noise.
  ///
  /// @param on_escape  called for what leaves, as often as paths do
  /// @return           whether it reached a scattering event
  [[nodiscard]] bool advance(WalkPath<N>& path, const WalkMedium<N>& medium, WalkNumbers& numbers,
                             const OnEscape<N>& on_escape) const;

  /// Whether what a path meets stops it, and is not the boundary of its medium seen from inside.
  [[nodiscard]] bool is_blocker(const SurfacePoint& point, const Vec3f& direction) const {
    return point.material != material_ || !(dot(point.geometric_normal, direction) > 0.0f);
  }
  /// Reflects a path diffusely at a blocker, by its base, without its boundary.
  void reflect_diffusely(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit,
                         Vec2f u) const;

  [[nodiscard]] bool is_inside(const Vec3f& position) const;
  [[nodiscard]] const DistanceField& distance() const { return *distance_; }
  [[nodiscard]] const RenderScene& scene() const { return scene_; }
  [[nodiscard]] const BandConversion<N>& conversion() const { return conversion_; }
  [[nodiscard]] std::uint32_t material() const { return material_; }
  [[nodiscard]] float ior() const { return ior_; }
  [[nodiscard]] int bands() const { return bands_; }
  /// Where paths mostly are: in the box of the material, unless it was narrowed.
  [[nodiscard]] const Box& region() const { return region_; }
  /// Narrows the region to what is in a box, too: its lattices get finer.
  void narrow_to(const Box& box);
  /// A lattice over the region.
  [[nodiscard]] NodeLattice lattice(float spacing, double most_nodes) const {
    return {region_.low, region_.high, spacing, most_nodes};
  }

 private:
  /// The next straight segment of a path: to a scattering event, or to a surface.
  struct Segment {
    float length = 0.0f;
    Hit hit;
    SurfacePoint point;  ///< of the hit
    float remaining =
        1.0f;  ///< fraction of the throughput that does not leave, if none is sampled to
  };
  [[nodiscard]] Segment sample_segment(const WalkPath<N>& path, const WalkMedium<N>& medium,
                                       Vec2f u) const;
  [[nodiscard]] Segment sample_forced_segment(const WalkPath<N>& path, const WalkMedium<N>& medium,
                                              Vec2f u, Random& random,
                                              const OnEscape<N>& on_escape) const;
  [[nodiscard]] Segment segment_to(const Hit& hit) const;
  [[nodiscard]] int sample_band(const Bands& throughput, float u) const {
    return lamina::sample_band(throughput, bands_, u);
  }
  [[nodiscard]] float sum_of_bands(const Bands& values) const {
    float sum = 0.0f;
    for (int b = 0; b < bands_; ++b) sum += values[b];
    return sum;
  }
  /// Light that meets a surface from inside: the fraction that leaves, and its direction.
  struct Transmission {
    float fraction = 0.0f;
    Vec3f outside;
  };
  [[nodiscard]] Transmission transmission_at(const SurfacePoint& point,
                                             const Vec3f& direction) const;
  /// Reflects a path that does not leave at what it meets.
  void reflect(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit, Vec2f u) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  std::uint32_t material_;
  float ior_;
  int bands_;
  float free_path_;
  Box region_;
  bool is_dark_outside_;  ///< no environment light: paths that leave find little
  std::unique_ptr<DistanceField> distance_;
};

}  // namespace lamina
