// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/dielectric_scattering.h"
#include "lamina/render/shading/refracted_entry.h"
#include "lamina/render/subsurface/bodies/nested_dielectrics.h"
#include "lamina/render/subsurface/media/walk_layers.h"
#include "lamina/render/subsurface/random_walk/interior/body_interior.h"
#include "lamina/render/subsurface/random_walk/interior/manifold_next_event.h"
#include "lamina/render/subsurface/random_walk/radiance/depth_radiance.h"
#include "lamina/render/subsurface/random_walk/radiance/light_vertices.h"
#include "lamina/render/subsurface/random_walk/radiance/radiance_field.h"

namespace lamina {

/// The medium inside the bodies of one material, with all that paths in it need.
template <int N>
struct BodyMedium {
  /// Events of a path before `even_layers`: balls of skin are within 3 % so, up to 15 % brighter
  /// with none.
  static constexpr int true_events = 2;

  WalkLayers<N> layers;
  /// Optional: what `layers` are taken as after some events.
  std::optional<WalkLayers<N>> even_layers;
  BodyInterior<N> interior;
  const DielectricSurface* glass;  ///< null: translucent
  bool is_rough;                   ///< its boundary to the outside
  bool has_neighbors;              ///< other bodies may touch, overlap or hold its own
  /// One layer without maps under a smooth boundary, without neighbours: BodyInterior::advance
  /// takes paths from
  /// event to event.
  bool is_homogeneous;
  ManifoldNextEvent<N> next_event;
  /// Optional, a control variate: absent where it cannot be solved, which is where the medium is
  /// not homogeneous. Paths are the same with it and without, and so is their mean.
  std::unique_ptr<RadianceField<N>> field;
  /// Radiance by depth for layers and maps under a smooth boundary.
  std::unique_ptr<DepthRadiance<N>> depth_radiance;
  /// Beside the field: absent where that is.
  std::unique_ptr<LightVertices<N>> light_vertices;

  BodyMedium(const RenderScene& scene, const BandConversion<N>& conversion,
             const NestedDielectrics& bodies, std::uint32_t material, bool is_quiet);

  /// The layers that paths of so many events fly through; and those that scatter them at the last.
  [[nodiscard]] const WalkLayers<N>& layers_after(int events) const {
    return even_layers && events >= true_events ? *even_layers : layers;
  }
  [[nodiscard]] const WalkLayers<N>& layers_at(int events) const {
    return even_layers && events > true_events ? *even_layers : layers;
  }

  /// Narrows what is precomputed to where paths from some points of its surface mostly go.
  void narrow_to(std::span<const SurfacePoint> seen);

 private:
  void make_field();
  void make_depth_radiance(const Box& region);
};

/// Where a path is: in which bodies, in which medium, at which depth.
template <int N>
struct MediaPlace {
  InteriorList interior;
  const BodyMedium<N>* medium = nullptr;
  DepthLayers::Place depth;
};

/// All bodies of a scene and the media inside them.
template <int N>
class WalkMedia {
 public:
  using Bands = BandValues<N>;

  /// @param are_quiet  translucent materials as quiet_layers where is_better_quiet
  WalkMedia(const RenderScene& scene, const BandConversion<N>& conversion, bool are_quiet = false);

  [[nodiscard]] const NestedDielectrics& bodies() const { return bodies_; }
  [[nodiscard]] const RenderScene& scene() const { return scene_; }
  [[nodiscard]] const BandConversion<N>& conversion() const { return conversion_; }

  /// Null if the material is opaque, or a dielectric by itself.
  [[nodiscard]] BodyMedium<N>* of_material(std::uint32_t material) const {
    return of_material_[material].get();
  }
  /// The medium of the body of highest priority; null outside of all.
  [[nodiscard]] const BodyMedium<N>* medium_in(const InteriorList& interior) const;
  /// @param near  a place beside it: so it is found more quickly
  [[nodiscard]] MediaPlace<N> place(const InteriorList& interior, const Vec3f& position,
                                    const MediaPlace<N>& near = MediaPlace<N>()) const;

  /// Where a path enters, refracted from the eye; absent if it does not.
  struct Entry {
    MediaPlace<N> place;
    Vec3f inward;
  };
  [[nodiscard]] std::optional<Entry> sample_entry(const ExitPoint& exit, std::uint32_t material,
                                                  PixelSamples& samples) const;

  /// The next surface along a ray, if one is met before t_far.
  struct Surface {
    Hit hit;
    SurfacePoint point;
    NestedDielectrics::Crossing crossing;
    MediaPlace<N> beyond;  ///< without a medium: outside
    bool passes = false;   ///< light goes straight on, in a medium of the same index
  };
  [[nodiscard]] Surface next_surface(const Ray& ray, const MediaPlace<N>& start, float t_near,
                                     float t_far) const;

  /// Along a straight segment through media of one index, for a path of so many events; as
  /// WalkLayers::optical_thickness.
  [[nodiscard]] Bands optical_thickness(const Ray& ray, const MediaPlace<N>& start, float length,
                                        int events) const;
  [[nodiscard]] bool has_maps() const { return has_maps_; }
  /// Residual of maps in its transmittance; as WalkLayers::sample_residual.
  [[nodiscard]] Bands sample_residual(const Ray& ray, const MediaPlace<N>& start, float length,
                                      int events, Random& random) const;

  /// Where a ray through media of one index leaves all bodies by a smooth boundary.
  [[nodiscard]] std::optional<BoundaryHit> find_boundary(const Ray& ray,
                                                         const MediaPlace<N>& start) const;

  /// The boundary between a medium and what is beyond a surface that a path meets: that of the body
  /// of highest priority among all that meet there.
  [[nodiscard]] DielectricScattering boundary(const MediaPlace<N>& here, const Surface& surface,
                                              const Vec3f& direction) const;

 private:
  /// Cuts a straight segment at the surfaces that light passes in a straight line: calls
  /// `on_body(layers, ray, start, length, end)` for each body.
  template <class OnBody>
  void for_bodies(const Ray& ray, const MediaPlace<N>& start, float length, int events,
                  const OnBody& on_body) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  NestedDielectrics bodies_;
  bool has_maps_ = false;
  std::vector<std::unique_ptr<BodyMedium<N>>> of_material_;  ///< [material]
};

}  // namespace lamina
