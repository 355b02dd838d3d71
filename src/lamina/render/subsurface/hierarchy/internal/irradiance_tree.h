// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"

namespace lamina {

/// A sample of the light that enters a surface, standing for a patch of it.
template <int N>
struct IrradianceSample {
  Vec3f position;     ///< [mm]
  Vec3f normal;       ///< unit length
  float area = 0.0f;  ///< [mm²]
  BandValues<N> irradiance;
  BandValues<N> albedo_index;  ///< where in a series of ever darker profiles its own is; any unit
};

/// Samples close together as one, from afar: an octree whose nodes hold what their samples give in
/// sum, at their centre of light.
///
/// Source: [JensenBuhler2002] §3.2. Departures: the light of a node is split by the mean normal of
/// its samples, since profiles are blended linearly by normals and a sum over normals is exact; the
/// width of a node is kept, so that the bend of the profile over it counts to second order.
template <int N>
class IrradianceTree {
 public:
  struct Node {
    BandValues<N> power;       ///< irradiance times area, summed
    Vec3f center;              ///< weighted by power
    Vec3f normal;              ///< the same; shorter the more the normals differ
    float mean_square = 0.0f;  ///< distance of the samples from the centre, the same [mm²]
    float size = 0.0f;         ///< area, more where normals or albedo indices differ [mm²]
    float radius = 0.0f;       ///< around the centre, of all samples [mm]
    std::uint32_t next = 0;    ///< where to go on past all that is below
  };

  IrradianceTree() = default;
  explicit IrradianceTree(std::span<const IrradianceSample<N>> samples);

  /// Calls on_node(node, albedo_index, offset, distance²) for nodes that together hold all samples
  /// within `radius` of a point, each as coarse as the criterion size <= error * (distance² +
  /// width²) allows.
  ///
  /// @param error  solid angle of a node [sr], > 0
  /// @param width  of the profile's middle, where it does not change much [mm]
  template <class OnNode>
  void gather(const Vec3f& point, float radius, float error, float width,
              const OnNode& on_node) const {
    const std::size_t count = nodes_.size();
    const float width2 = width * width;
    for (std::size_t i = 0; i < count;) {
      const Node& node = nodes_[i];
      const Vec3f offset = node.center - point;
      const float d2 = dot(offset, offset), far = radius + node.radius;
      if (d2 > far * far) {
        i = node.next;
      } else if (node.next == i + 1 || node.size <= error * (d2 + width2)) {
        on_node(node, shades_.empty() ? no_shade_ : shades_[i], offset, d2);
        i = node.next;
      } else {
        ++i;
      }
    }
  }

  [[nodiscard]] std::size_t node_count() const { return nodes_.size(); }

 private:
  struct Builder;
  std::vector<Node> nodes_;            ///< each before what is below it
  std::vector<BandValues<N>> shades_;  ///< [node]; empty if all are 0
  BandValues<N> no_shade_;
};

}  // namespace lamina
