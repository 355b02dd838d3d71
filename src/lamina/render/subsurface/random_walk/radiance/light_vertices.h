// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/core/random.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/subsurface/media/walk_layers.h"
#include "lamina/render/subsurface/random_walk/interior/body_interior.h"
#include "lamina/render/subsurface/random_walk/interior/manifold_next_event.h"

namespace lamina {

/// Light vertices: where light from lamps scatters first inside a homogeneous body, on ways that
/// next-event estimation from there does not find, as through a fold of a caustic, or after
/// curved parts of the boundary have reflected it inside. Random walks connect their events with
/// them, on a straight line: what walks would else find when they leave and meet a lamp by chance.
/// Both share by multiple importance sampling.
///
/// They are traced once, into the region of the body: a walk has no bias, but noise that all walks
/// share.
///
/// Source: bidirectional path tracing, [VeachGuibas1994], in media [LafortuneWillems1996], with
/// light vertices that all paths share [Davidovic2014].
template <int N>
class LightVertices {
 public:
  using Bands = BandValues<N>;

  struct Vertex {
    Vec3f position;
    Vec3f to_light;        ///< direction inside from which light comes, unit length
    Bands power;           ///< that it scatters, over ior²
    float density = 0.0f;  ///< of vertices, as `density_of_light` has it
  };

  LightVertices(const BodyInterior<N>& interior, const ManifoldNextEvent<N>& next_event,
                const WalkLayers<N>& layers);

  /// Traces light into the region of the body, where it amounts to anything.
  ///
  /// @return  false if `progress` asked to stop
  [[nodiscard]] bool trace(const LightGatherer<N>& light, const Progress& progress);

  [[nodiscard]] bool is_empty() const { return vertices_.empty(); }
  [[nodiscard]] std::span<const Vertex> vertices() const { return vertices_; }

  /// Draws a vertex near a point.
  struct Choice {
    const Vertex& vertex;
    float probability;
    std::size_t others;  ///< around it, that might have been drawn
  };
  [[nodiscard]] std::optional<Choice> choose(const Vec3f& from, Vec2f u) const;

  /// A path's two last events and the way of light to the last.
  struct Way {
    Vec3f from, to;  ///< the events
    float phases;    ///< product of the phase functions at both [1/sr²]
    float density;   ///< `density_of_light`
  };
  /// The MIS weight of a vertex that was drawn.
  [[nodiscard]] float weight(const Way& way, std::size_t others) const;
  /// The MIS weight of a path that leaves, which vertices share.
  [[nodiscard]] float weight_of_path(const Way& way) const;

  /// How densely light is traced that enters at a point from a direction: vertices per area across
  /// the beam and solid angle inside, but for what paths have in common with it.
  ///
  /// @param pdf  of `Lights::sample_light` there [1/sr]
  [[nodiscard]] float density_of_light(const SurfacePoint& entry, const Vec3f& to_light,
                                       float pdf) const;

 private:
  /// The surface in the region, sampled evenly over its area.
  void find_surface();
  [[nodiscard]] double surface_area() const {
    return area_to_end_.empty() ? 0.0 : area_to_end_.back();
  }
  [[nodiscard]] SurfacePoint sample_surface(Random& random) const;
  /// Light on its way inside.
  struct Beam {
    SurfacePoint entry;
    Ray outside;  ///< from there towards the light
    float light_distance, density;
    Ray inside;
    Bands power;  ///< over ior²
  };
  [[nodiscard]] std::optional<Beam> sample_beam(const LightGatherer<N>& light,
                                                Random& random) const;
  /// Where a beam scatters before the boundary, sampled for one band and weighted for all.
  ///
  /// @param passing  transmittance to the boundary
  [[nodiscard]] std::optional<Vertex> sample_event(const Beam& beam, const Bands& passing,
                                                   Random& random) const;
  /// False where nothing is reflected, or diffusely.
  [[nodiscard]] bool reflect(Beam& beam, const SurfacePoint& mirror) const;
  [[nodiscard]] float sum_of_bands(const Bands& values) const {
    float sum = 0.0f;
    for (int b = 0; b < interior_.bands(); ++b) sum += values[b];
    return sum;
  }
  /// Appends the vertices of a ray of light.
  ///
  /// @return  the power that enters, sum of the bands
  float trace_ray(const LightGatherer<N>& light, Random random, std::vector<Vertex>& found) const;
  void sort_by_cells();
  [[nodiscard]] std::uint64_t cell_at(const Vec3f& p) const;
  [[nodiscard]] std::span<const Vertex> vertices_in(std::uint64_t cell) const;
  /// Density of vertices that are drawn over that of paths.
  [[nodiscard]] float vertices_over_paths(const Way& way, std::size_t others) const;

  const BodyInterior<N>& interior_;
  const ManifoldNextEvent<N>& next_event_;
  const WalkLayers<N>& layers_;
  float cell_size_;
  std::vector<Hit> triangles_;       ///< of the surface, at least in part in the region
  std::vector<double> area_to_end_;  ///< [triangle] [mm²]
  double rays_ = 0.0;                ///< that were traced
  std::vector<Vertex> vertices_;
  std::vector<std::uint64_t> cells_;  ///< [vertex], ascending
};

}  // namespace lamina
