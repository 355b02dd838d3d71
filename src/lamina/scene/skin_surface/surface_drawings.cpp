// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/smooth_step.h"
#include "lamina/scene/skin_surface/internal/surface_canvas.h"
#include "lamina/scene/surface/noise.h"
#include "lamina/skin/maps/vessel_fork.h"

namespace lamina {
namespace {

/// One after the other in a vessel.
struct VesselPoint {
  Vec3f position, normal;
  double along;  ///< [mm]
};

/// A vessel with its branches, drawn on the texels near it.
class VesselPen {
 public:
  VesselPen(const SurfaceVein& vein, const SurfaceCanvas& canvas, Random& random)
      : vein_(vein), canvas_(canvas), random_(random), blood_(canvas.texels.size()) {
    const Vec3f middle = 0.5f * (vein.from + vein.to);
    const float radius = 0.75f * length(vein.to - vein.from) + 10.0f;
    for (std::uint32_t i = 0; i < canvas.texels.size(); ++i)
      if (length(canvas.texels[i].position - middle) < radius) near_.push_back(i);
  }

  /// One vessel from end to end, and its branches where `levels` of them are left.
  void draw(const SurfaceTexel& from, const SurfaceTexel& to, double diameter, double depth,
            int branches, int levels) {
    const std::vector<VesselPoint> path = find_path(from, to);
    const double whole = std::max(path.back().along, 1e-6);
    const double last_depth = random_depth();
    std::vector<double> forks(static_cast<std::size_t>(levels > 0 ? branches : 0));
    for (std::size_t f = 0; f < forks.size(); ++f)
      forks[f] = (static_cast<double>(f) + 0.2 + 0.6 * random_.uniform()) /
                 (static_cast<double>(forks.size()) + 0.5);
    for (std::size_t i = 1, f = 0; i < path.size(); ++i) {
      const double at = 0.5 * (path[i - 1].along + path[i].along) / whole;
      const double here = depth + smooth_step(at) * (last_depth - depth);
      // Its end is lost to vessels too thin to be seen, which take the flow evenly.
      draw_piece(path[i - 1], path[i], diameter * std::cbrt(std::min(1.0, 5.0 * (1.0 - at))), here);
      for (; f < forks.size() && forks[f] * whole <= path[i].along; ++f) {
        const VesselFork fork = sample_fork(diameter, random_);
        const double side = (f % 2 == 0) == (random_.uniform() < 0.8) ? 1.0 : -1.0;
        const SurfaceTexel& start = nearest(path[i].position);
        const SurfaceTexel& end =
            branch_end(path[i], to.position - from.position, side * fork.narrow_angle);
        if (length(end.position - start.position) > 2.0f * start.width)
          draw(start, end, fork.narrow, here, branches_of_branch(branches), levels - 1);
        diameter = fork.wide;
      }
    }
  }

  [[nodiscard]] double random_depth() {
    const Span2& depth = vein_.look.depth;
    return depth[0] + random_.uniform() * (depth[1] - depth[0]);
  }

  /// Share of the look's blood at each texel.
  [[nodiscard]] const std::vector<float>& blood() const { return blood_; }

 private:
  /// Where a branch of a vessel that leads ahead ends, by its angle from that.
  [[nodiscard]] const SurfaceTexel& branch_end(const VesselPoint& start, const Vec3f& ahead,
                                               double angle) {
    const Vec3f aside = cross(start.normal, ahead);
    const auto reach = static_cast<float>(0.3 + 0.25 * random_.uniform());
    return nearest(start.position + reach * (static_cast<float>(std::cos(angle)) * ahead +
                                             static_cast<float>(std::sin(angle)) * aside));
  }

  /// Points from one texel to another, with how far along they are.
  [[nodiscard]] std::vector<VesselPoint> find_path(const SurfaceTexel& from,
                                                   const SurfaceTexel& to) {
    std::vector<VesselPoint> path = {{from.position, from.normal, 0.0}};
    wander(from, to, 0.16 * static_cast<double>(length(to.position - from.position)), most_halvings,
           path);
    for (std::size_t i = 1; i < path.size(); ++i)
      path[i].along =
          path[i - 1].along + static_cast<double>(length(path[i].position - path[i - 1].position));
    return path;
  }

  [[nodiscard]] const SurfaceTexel& nearest(const Vec3f& at) const {
    return canvas_.texels[*std::ranges::min_element(near_, {}, [&](std::uint32_t i) {
      const Vec3f offset = canvas_.texels[i].position - at;
      return dot(offset, offset);
    })];
  }

  /// Adds points from one texel to another, about a millimetre apart but not less than texels:
  /// half-way ones moved aside, by less the shorter the way. Where the surface has a gap on the
  /// way, halves may stay as long as the whole: not for ever.
  void wander(const SurfaceTexel& from, const SurfaceTexel& to, double amount, int halvings,
              std::vector<VesselPoint>& path) {
    const Vec3f ahead = to.position - from.position;
    if (length(ahead) < std::max(1.0f, 4.0f * from.width) || halvings == 0) {
      path.push_back({to.position, to.normal, 0.0});
      return;
    }
    const Vec3f aside = cross(normalize(from.normal + to.normal), ahead) / length(ahead);
    const auto moved = static_cast<float>(amount * (2.0 * random_.uniform() - 1.0));
    const SurfaceTexel& middle = nearest(0.5f * (from.position + to.position) + moved * aside);
    wander(from, middle, 0.4 * amount, halvings - 1, path);
    wander(middle, to, 0.4 * amount, halvings - 1, path);
  }

  /// A tube that is seen as wide as its diameter, the spread of light from its depth and the texels
  /// make it.
  void draw_piece(const VesselPoint& a, const VesselPoint& b, double diameter, double depth) {
    const double seen = std::hypot(0.25 * diameter, 0.5 * depth);
    const Vec3f axis = b.position - a.position;
    for (const std::uint32_t i : near_) {
      const SurfaceTexel& texel = canvas_.texels[i];
      const Vec3f offset = texel.position - a.position;
      const float t = std::clamp(dot(offset, axis) / std::max(dot(axis, axis), 1e-12f), 0.0f, 1.0f);
      const Vec3f away = offset - t * axis;
      constexpr double of_texel = 0.2887;  // the deviation of a box as wide as 1
      const double spread = std::hypot(seen, of_texel * static_cast<double>(texel.width));
      const auto across = static_cast<double>(length(away)) / spread;
      if (across > 3.5 || dot(texel.normal, a.normal) < 0.2f) continue;
      const double share = 0.25 * diameter / spread * std::exp(-0.5 * across * across);
      blood_[i] = std::max(blood_[i], static_cast<float>(share));
    }
  }

  static constexpr int most_halvings = 7;
  const SurfaceVein& vein_;
  const SurfaceCanvas& canvas_;
  Random& random_;
  std::vector<float> blood_;
  std::vector<std::uint32_t> near_;
};

}  // namespace

Framef upright_frame(const Vec3f& normal) {
  const Vec3f up = std::abs(normal.y) < 0.999f ? Vec3f{0, 1, 0} : Vec3f{0, 0, 1};
  const Vec3f x = normalize(cross(up, normal));
  return {.x = x, .y = cross(normal, x), .z = normal};
}

Vec2f unrolled(const Framef& frame, const Vec3f& offset) {
  const Vec3f local = frame.to_local(offset);
  const float aside = std::hypot(local.x, local.y);
  const float scale = aside > 0.0f ? length(offset) / aside : 0.0f;
  return {scale * local.x, scale * local.y};
}

const SurfaceTexel& nearest_texel(const SurfaceCanvas& canvas, const Vec3f& at, float most) {
  const auto distance2 = [&](const SurfaceTexel& texel) {
    const Vec3f offset = texel.position - at;
    return dot(offset, offset);
  };
  const auto nearest = std::ranges::min_element(canvas.texels, {}, distance2);
  const float distance = nearest == canvas.texels.end() ? std::numeric_limits<float>::infinity()
                                                        : std::sqrt(distance2(*nearest));
  if (distance > most)
    throw InvalidInput("a feature must lie within " + number_text(most) +
                       " mm of the surface, but is " + number_text(distance) + " mm away");
  return *nearest;
}

void apply_feature(const SurfaceTattoo& tattoo, const SurfacePlaces& where, std::uint64_t,
                   SurfaceCanvas& canvas) {
  const double width = tattoo.ink.width;
  const double height = width * tattoo.ink.image.height / tattoo.ink.image.width;
  const SurfaceTexel& middle = nearest_texel(canvas, tattoo.at, static_cast<float>(width));
  const Framef frame = upright_frame(middle.normal);
  const double c = std::cos(tattoo.turn), s = std::sin(tattoo.turn);
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    const Vec3f offset = texel.position - middle.position;
    if (dot(texel.normal, middle.normal) < 0.0f ||
        static_cast<double>(length(offset)) > std::hypot(width, height))
      return;
    const Vec2f place = unrolled(frame, offset);
    const auto x = static_cast<double>(place.x), y = static_cast<double>(place.y);
    absorbance_of(tattoo.ink, canvas.skin[i]) +=
        static_cast<double>(where.weight(texel.position)) * tattoo.ink.absorbance *
        ink_at(tattoo.ink.image, (c * x + s * y) / width + 0.5, 0.5 - (c * y - s * x) / height);
  });
}

void apply_feature(const SurfacePress& press, const SurfacePlaces& where, std::uint64_t seed,
                   SurfaceCanvas& canvas) {
  const SurfaceTexel& middle =
      nearest_texel(canvas, press.at, static_cast<float>(press.disc.diameter));
  const NoiseMap ragged{.kind = NoiseMap::Kind::smooth,
                        .size = static_cast<float>(0.5 * press.disc.diameter),
                        .octaves = 3,
                        .seed = static_cast<std::uint32_t>(seed)};
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    if (dot(texel.normal, middle.normal) < 0.0f) return;
    const double left =
        share_left(press.disc, static_cast<double>(length(texel.position - middle.position)),
                   static_cast<double>(evaluate_noise(ragged, texel.position, texel.width)));
    const double weight = static_cast<double>(where.weight(texel.position));
    SkinParameters& skin = canvas.skin[i];
    skin.hemoglobin_dermis *= 1.0 - weight * (1.0 - left);
    skin.hemoglobin_epidermis *= 1.0 - weight * (1.0 - left);
  });
}

void apply_feature(const SurfaceVein& vein, const SurfacePlaces& where, std::uint64_t seed,
                   SurfaceCanvas& canvas) {
  constexpr float most = 30.0f;
  Random random = make_random(seed, 0);
  const SurfaceTexel& from = nearest_texel(canvas, vein.from, most);
  const SurfaceTexel& to = nearest_texel(canvas, vein.to, most);
  VesselPen pen(vein, canvas, random);
  pen.draw(from, to, vein.look.diameter[1], pen.random_depth(), vein.branches, vein.look.levels);
  for (std::size_t i = 0; i < canvas.texels.size(); ++i) {
    const double share = static_cast<double>(pen.blood()[i]) *
                         static_cast<double>(where.weight(canvas.texels[i].position));
    SkinParameters& skin = canvas.skin[i];
    mix_in(skin.hemoglobin_dermis, skin.saturation_dermis, share * vein.look.hemoglobin,
           vein.look.saturation);
    skin.junction_absorption += share * vein.look.absorbance;
  }
}

}  // namespace lamina
