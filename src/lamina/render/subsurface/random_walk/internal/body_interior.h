// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "lamina/core/low_discrepancy.h"
#include "lamina/core/random.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/random_walk/internal/distance_field.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// The random numbers of a path: of a pixel's, stratified over its samples for the first events.
class WalkNumbers {
 public:
  explicit WalkNumbers(PixelSamples& samples)
      : samples_(&samples), random_(make_stream(samples)), left_(2 * dealt_events) {}
  explicit WalkNumbers(const Random& random) : random_(random) {}
  [[nodiscard]] Vec2f pair() {
    if (left_ > 0) {
      --left_;
      return samples_->next_2d();
    }
    const float x = random_.uniform_float();
    return {x, random_.uniform_float()};
  }
  [[nodiscard]] Random& stream() { return random_; }

 private:
  static constexpr int dealt_events = 4;
  PixelSamples* samples_ = nullptr;
  Random random_;
  int left_ = 0;
};

/// A path inside, against the light.
template <int N>
struct WalkPath {
  Ray ray;
  BandValues<N> carried;       ///< of the light that is met, to where the path started
  bool has_scattered = false;  ///< and met no surface since
  float safe = 0.0f;           ///< least distance to a surface

  /// Where it scattered last, before it turned there.
  struct Event {
    Ray ray;
    BandValues<N> carried;
    float searching = 0.0f, going = 1.0f;  ///< chances of a search for lamps, of going on
  } last{};
};

template <int N>
struct WalkMedium {
  BandValues<N> sigma_s, sigma_t;      ///< [1/mm]
  BandValues<N> sigma_t_over_least{};  ///< of the bands
  float longest_free_path = 0.0f;      ///< of the bands [mm]; may be infinite
};
/// @param bands  those of all lanes that count
template <int N>
[[nodiscard]] WalkMedium<N> make_walk_medium(const BandValues<N>& sigma_s,
                                             const BandValues<N>& sigma_t, int bands);

/// Where a path leaves, and towards where.
struct WalkExit {
  SurfacePoint point;
  Vec3f outside;
};
/// Is told of a path that leaves, as it is on its last way inside.
template <int N>
using OnLeaving = std::function<void(const WalkPath<N>&, const WalkExit&)>;

/// A band, each drawn in proportion to what it carries.
template <int N>
[[nodiscard]] int draw_band(const BandValues<N>& carried, int bands, float u) {
  float total = 0.0f;
  for (int b = 0; b < bands; ++b) total += carried[b];
  float left = u * total;
  for (int b = 0; b + 1 < bands; ++b) {
    if (left < carried[b]) return b;
    left -= carried[b];
  }
  return bands - 1;
}

struct Box {
  Vec3f low, high;
};
/// Around all triangles of a material; both corners 0 if there are none.
[[nodiscard]] Box box_of_material(const Scene& scene, std::uint32_t material);

/// @throws InvalidInput if a mesh of the material is open
void require_closed_meshes(const Scene& scene, std::uint32_t material);

/// The inside of all meshes of one material, with what is in there: where paths go.
///
/// The boundary is smooth. An opaque object inside reflects as its base does.
template <int N>
class WalkSpace {
 public:
  using Bands = BandValues<N>;

  /// @param ior        inside over outside
  /// @param free_path  the shortest of what will walk here [mm]
  WalkSpace(const RenderScene& scene, const BandConversion<N>& conversion, std::uint32_t material,
            float ior, int bands, float free_path);

  /// Follows a path, mirrored by surfaces on its way, to where it scatters (not yet turned). Each
  /// segment is drawn by the bands in proportion to what they carry and counts for all by the
  /// density of that mixture, so that what a path carries in all bands never grows.
  ///
  /// Where no sky shines, a path does not end where it leaves: it always goes on inside, and
  /// carries as much less. For most that leave find no light, so whether they do is but noise.
  ///
  /// @param on_leaving  of what leaves, as often as paths do
  /// @return            whether it came to where it scatters
  [[nodiscard]] bool advance(WalkPath<N>& path, const WalkMedium<N>& medium, WalkNumbers& numbers,
                             const OnLeaving<N>& on_leaving) const;

  /// A band, each drawn in proportion to what it carries.
  [[nodiscard]] int draw_band(const Bands& carried, float u) const {
    return lamina::draw_band(carried, bands_, u);
  }

  /// Whether what a path meets stops it, and is not the boundary of its medium seen from inside.
  [[nodiscard]] bool is_blocker(const SurfacePoint& point, const Vec3f& direction) const {
    return point.material != material_ || !(dot(point.geometric_normal, direction) > 0.0f);
  }
  /// Turns a path at a blocker, by its base, without its boundary.
  void bounce(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit, Vec2f u) const;

  [[nodiscard]] bool is_inside(const Vec3f& position) const;
  [[nodiscard]] const SafeDistances& safe() const { return *safe_; }
  [[nodiscard]] const RenderScene& scene() const { return scene_; }
  [[nodiscard]] const BandConversion<N>& conversion() const { return conversion_; }
  [[nodiscard]] std::uint32_t material() const { return material_; }
  [[nodiscard]] float ior() const { return ior_; }
  [[nodiscard]] int bands() const { return bands_; }
  /// A lattice over the inside.
  [[nodiscard]] NodeLattice lattice(float spacing, double most_nodes) const {
    return {box_.low, box_.high, spacing, most_nodes};
  }

 private:
  /// The next straight part of a path: to where it scatters, or to a surface.
  struct Part {
    float length = 0.0f;
    Hit hit;
    SurfacePoint point;  ///< of the hit
    float kept = 1.0f;   ///< of what is carried, if no path leaves
  };
  [[nodiscard]] Part draw_part(const WalkPath<N>& path, const WalkMedium<N>& medium, Vec2f u) const;
  [[nodiscard]] Part draw_part_inside(const WalkPath<N>& path, const WalkMedium<N>& medium, Vec2f u,
                                      Random& random, const OnLeaving<N>& on_leaving) const;
  [[nodiscard]] Part part_to(const Hit& hit) const;
  [[nodiscard]] float sum_of_bands(const Bands& values) const {
    float sum = 0.0f;
    for (int b = 0; b < bands_; ++b) sum += values[b];
    return sum;
  }
  /// Of what meets a surface from inside: what share leaves, and towards where.
  struct Passing {
    float share = 0.0f;
    Vec3f outside;
  };
  [[nodiscard]] Passing passing_at(const SurfacePoint& point, const Vec3f& direction) const;
  /// Turns a path that does not leave at what it meets.
  void turn(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit, Vec2f u) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  std::uint32_t material_;
  float ior_;
  int bands_;
  Box box_;
  bool is_dark_outside_;  ///< but for lamps and what they light
  std::unique_ptr<SafeDistances> safe_;
};

}  // namespace lamina
