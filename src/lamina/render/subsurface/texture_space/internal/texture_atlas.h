// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/surface_point.h"
#include "lamina/solve/scattering/heterogeneous/blurs/cell_graph.h"

namespace lamina {

/// A texel on a mesh: what lies under its middle.
struct AtlasTexel {
  std::uint32_t mesh = 0, triangle = 0;
  float u = 0.0f, v = 0.0f;  ///< barycentric weights of the second and third vertex
  std::uint32_t chart = 0;
  std::int32_t x = 0, y = 0;  ///< in the grid of its chart
  Vec3f position, normal;     ///< of the surface [mm], unit length
  Vec3f across, up;           ///< change of position to the next texel in x and in y [mm]
  float area = 0.0f;          ///< on the surface [mm²]
};

/// A connected piece of texture space with a grid of its own.
struct AtlasChart {
  float density = 0.0f;  ///< texels to a unit of texture coordinates
  std::int32_t x0 = 0, y0 = 0, width = 0, height = 0;
  /// [y - y0][x - x0]: a texel, or a border texel (counted on from the last texel), or no_texel
  std::vector<std::uint32_t> index;
};

inline constexpr std::uint32_t no_texel = 0xffffffff;

/// The surface of a material as texels of about one size, in the texture coordinates of its meshes.
/// Charts do not know each other: they may lie close together, or on top of one another where the
/// halves of a body share a texture.
class TextureAtlas {
 public:
  /// @param spacing  square root of a texel's mean area [mm], > 0.
  /// @throws InvalidInput if a mesh has no texture coordinates, if they are spread too far or lie
  ///         too far from 0 to be filled with texels, or if most of a chart lies on several faces.
  TextureAtlas(const std::vector<Mesh>& meshes, std::uint32_t material, float spacing);

  [[nodiscard]] std::span<const AtlasTexel> texels() const { return texels_; }

  /// Warnings for the user, one line each: charts that overlap themselves, where one of the
  /// faces has the texel and the others look up what is not theirs.
  [[nodiscard]] std::span<const std::string> warnings() const { return warnings_; }

  /// The cells of the texels and how light flows between them: as the first fundamental form has it
  /// within a chart, and over its borders to where the surface goes on.
  struct Cells {
    std::vector<GraphCell> cells;
    std::vector<CellLink> links;
  };
  [[nodiscard]] Cells cells() const;

  /// Texels of a chart to a unit of texture coordinates.
  [[nodiscard]] float density(std::uint32_t chart) const { return charts_[chart].density; }

  /// Texels around a point, with weights that sum to 1.
  struct Weights {
    std::array<std::uint32_t, 4> texel{};
    std::array<float, 4> weight{};
    int count = 0;
  };
  [[nodiscard]] Weights weights_at(const SurfacePoint& point) const;

  /// A border texel, just outside a chart: weights of the texels that lie where it would, beyond
  /// the border too.
  struct Border {
    std::vector<std::pair<std::uint32_t, float>> from;
  };
  [[nodiscard]] std::span<const Border> borders() const { return borders_; }

 private:
  void find_charts(const std::vector<Mesh>& meshes, std::uint32_t material);
  void fill_chart(const std::vector<Mesh>& meshes, std::uint32_t chart, float spacing);
  void add_borders();
  [[nodiscard]] std::uint32_t texel_at(const AtlasChart& chart, std::int32_t x,
                                       std::int32_t y) const;

  struct Face {
    std::uint32_t mesh, triangle;
  };
  std::vector<AtlasTexel> texels_;
  std::vector<AtlasChart> charts_;
  std::vector<std::vector<Face>> faces_;              ///< [chart]
  std::vector<std::vector<std::uint32_t>> chart_of_;  ///< [mesh][triangle]
  std::vector<Border> borders_;
  std::vector<std::string> warnings_;
  double grid_size_ = 0.0;  ///< of all charts, texels or not
};

}  // namespace lamina
