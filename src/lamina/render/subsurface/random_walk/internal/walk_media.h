// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/refracted_entry.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/render/subsurface/random_walk/internal/manifold_next_event.h"
#include "lamina/render/subsurface/random_walk/internal/nested_dielectrics.h"
#include "lamina/render/subsurface/random_walk/internal/walk_layers.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// What fills the bodies of one material, with all that paths in it ask.
template <int N>
struct BodyMedium {
  WalkLayers<N> layers;
  WalkSpace<N> space;
  WalkLamps<N> lamps;
  bool is_rough;       ///< its boundary to the outside
  bool has_neighbors;  ///< other bodies may touch or hold its own, or be within

  BodyMedium(const RenderScene& scene, const BandConversion<N>& conversion,
             const WalkBodies& bodies, std::uint32_t material);
};

/// Where a path is: in which bodies, in which medium, at which depth.
template <int N>
struct MediaPlace {
  WalkHolders holders;
  const BodyMedium<N>* medium = nullptr;
  DepthLayers::Place depth;
};

/// All bodies of a scene and what fills them.
template <int N>
class WalkMedia {
 public:
  using Bands = BandValues<N>;

  WalkMedia(const RenderScene& scene, const BandConversion<N>& conversion);

  [[nodiscard]] const WalkBodies& bodies() const { return bodies_; }
  [[nodiscard]] const RenderScene& scene() const { return scene_; }
  [[nodiscard]] const BandConversion<N>& conversion() const { return conversion_; }

  /// Null if no body has it.
  [[nodiscard]] const BodyMedium<N>* of_material(std::uint32_t material) const {
    return of_material_[material].get();
  }
  /// The medium where bodies hold a place; null outside of all.
  [[nodiscard]] const BodyMedium<N>* filling(const WalkHolders& holders) const;
  [[nodiscard]] MediaPlace<N> place(const WalkHolders& holders, const Vec3f& position) const;

  /// The next surface on a straight way, if one is met before t_far.
  struct Surface {
    Hit hit;
    SurfacePoint point;
    WalkBodies::Crossing crossing;
    MediaPlace<N> beyond;  ///< without a medium: outside
    bool passes = false;   ///< light goes straight on, in a medium of the same index
  };
  [[nodiscard]] Surface next_surface(const Ray& way, const MediaPlace<N>& start, float t_near,
                                     float t_far) const;

  /// Extinction along a straight way through media of one index.
  [[nodiscard]] Bands optical_thickness(const Ray& way, const MediaPlace<N>& start,
                                        float length) const;

  /// Where a straight way through media of one index leaves all bodies by a smooth boundary.
  [[nodiscard]] std::optional<BoundaryHit> find_boundary(const Ray& way,
                                                         const MediaPlace<N>& start) const;

  /// Facets of the boundary between a medium and what is beyond a surface: those of the body that
  /// fills, of the two, where both are.
  [[nodiscard]] const Interface& facets(const MediaPlace<N>& here, const Surface& surface) const;

 private:
  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  WalkBodies bodies_;
  std::vector<std::unique_ptr<BodyMedium<N>>> of_material_;  ///< null: of no body
};

}  // namespace lamina
