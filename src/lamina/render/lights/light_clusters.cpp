// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/core/float_pi.h"
#include "lamina/render/lights/lights.h"

namespace lamina {
namespace {

constexpr int environment_halvings = 7;  // 128 clusters
constexpr int area_light_cuts = 2;       // along either side
constexpr int samples_of_cluster = 4;  // along either side, to find out how bright it is and where

}  // namespace

void Lights::make_clusters() {
  for (std::size_t i = 0; i < infinite_lights_.size(); ++i)
    if (infinite_lights_[i].environment.can_be_sampled())
      split_environment(i, {0.0f, 0.0f}, {1.0f, 1.0f}, environment_halvings);
  const auto add_delta_lights = [&](bool far) {
    for (std::size_t i = 0; i < delta_lights_.size(); ++i)
      if (delta_lights_[i].is_far == far && delta_lights_[i].probability > 0.0f)
        clusters_.push_back({Cluster::Kind::delta_light,
                             i,
                             {0.0f, 0.0f},
                             {1.0f, 1.0f},
                             delta_lights_[i].probability});
  };
  add_delta_lights(true);
  for (std::size_t i = far_clusters_[0].size(); i < clusters_.size(); ++i) {
    const DeltaLight& delta_light = delta_lights_[clusters_[i].light];
    const float values[] = {delta_light.where.x, delta_light.where.y, delta_light.where.z,
                            mean_of_channels(delta_light.strength), 0.0f};
    for (std::size_t v = 0; v < 5; ++v) far_clusters_[v].push_back(values[v]);
  }
  add_delta_lights(false);
  constexpr float side = 1.0f / area_light_cuts;
  for (std::size_t i = 0; i < area_lights_.size(); ++i)
    for (int y = 0; y < area_light_cuts; ++y)
      for (int x = 0; x < area_light_cuts; ++x)
        if (area_lights_[i].probability > 0.0f)
          clusters_.push_back({Cluster::Kind::area_light,
                               i,
                               {side * static_cast<float>(x), side * static_cast<float>(y)},
                               {side, side},
                               side * side * area_lights_[i].probability});
  const auto add_whole = [&](Cluster::Kind kind, std::size_t light, float probability) {
    if (probability > 0.0f)
      clusters_.push_back({kind, light, {0.0f, 0.0f}, {1.0f, 1.0f}, probability});
  };
  for (std::size_t i = 0; i < ball_lights_.size(); ++i)
    add_whole(Cluster::Kind::ball, i, ball_lights_[i].probability);
  for (std::size_t i = 0; i < surface_lights_.size(); ++i)
    add_whole(Cluster::Kind::surface, i, surface_lights_[i].probability);
  const bool are_too_many = clusters_.size() > max_light_clusters ||
                            clusters_.size() - far_clusters_[0].size() > max_near_light_clusters;
  if (are_too_many) clusters_.clear();
}

void Lights::split_environment(std::size_t light, Vec2f low, Vec2f size, int halvings) {
  const Environment& environment = infinite_lights_[light].environment;
  const auto at = [&](float x, float y) {
    return environment.sample({low.x + x * size.x, low.y + y * size.y});
  };
  if (halvings > 0) {
    const auto apart = [](const Vec3f& a, const Vec3f& b) { return dot(a - b, a - b); };
    const float across = apart(at(0.02f, 0.5f).direction, at(0.98f, 0.5f).direction);
    const float down = apart(at(0.5f, 0.02f).direction, at(0.5f, 0.98f).direction);
    const Vec2f half = across > down ? Vec2f{0.5f * size.x, size.y} : Vec2f{size.x, 0.5f * size.y};
    split_environment(light, low, half, halvings - 1);
    split_environment(light, low + (size - half), half, halvings - 1);
    return;
  }
  std::vector<Environment::Sample> drawn;
  for (int i = 0; i < samples_of_cluster * samples_of_cluster; ++i)
    drawn.push_back(at((static_cast<float>(i % samples_of_cluster) + 0.5f) / samples_of_cluster,
                       (static_cast<float>(i / samples_of_cluster) + 0.5f) / samples_of_cluster));
  Vec3f middle;
  float flux = 0.0f, spread2 = 0.0f;
  const auto flux_of = [&](const Environment::Sample& d) {
    return d.seen.pdf > 0.0f ? size.x * size.y * mean_of_channels(d.seen.radiance) /
                                   (d.seen.pdf * static_cast<float>(drawn.size()))
                             : 0.0f;
  };
  for (const Environment::Sample& d : drawn) {
    flux += flux_of(d);
    middle += flux_of(d) * d.direction;
  }
  middle = length(middle) > 0.0f ? normalize(middle) : drawn.front().direction;
  for (const Environment::Sample& d : drawn)
    spread2 += dot(d.direction - middle, d.direction - middle) / static_cast<float>(drawn.size());
  clusters_.push_back({Cluster::Kind::infinite_light, light, low, size,
                       size.x * size.y * infinite_lights_[light].probability});
  const float values[] = {middle.x, middle.y, middle.z, flux, spread2};
  for (std::size_t v = 0; v < 5; ++v) far_clusters_[v].push_back(values[v]);
}

LightClusters Lights::far_clusters() const {
  const auto& [x, y, z, flux, spread2] = far_clusters_;
  return {
      clusters_.empty() ? 0 : x.size(), x.data(), y.data(), z.data(), flux.data(), spread2.data()};
}

LightClusters Lights::near_clusters(const Vec3f& position, NearLightClusters& storage) const {
  std::size_t count = 0;
  for (std::size_t i = far_clusters().count; i < clusters_.size(); ++i) {
    const Cluster& cluster = clusters_[i];
    Vec3f where, strength;
    float area = 0.0f;
    std::optional<float> spread2;  // [mm²]; absent: of a square
    if (cluster.kind == Cluster::Kind::ball) {
      const BallLight& ball = ball_lights_[cluster.light];
      where = ball.center;
      area = float_pi * ball.radius * ball.radius;
      strength = area * ball.radiance;
      spread2 = 0.5f * ball.radius * ball.radius;  // of a disk
    } else if (cluster.kind == Cluster::Kind::surface) {
      const SurfaceLight& surface = surface_lights_[cluster.light];
      where = surface.triangles.middle();
      area = 0.25f * surface.triangles.area();  // as it is seen, about
      strength = area * surface.radiance;
      spread2 = surface.triangles.spread2();
    } else if (cluster.kind == Cluster::Kind::delta_light) {
      where = delta_lights_[cluster.light].where;
      strength = delta_lights_[cluster.light].strength;
    } else {
      const AreaLight& area_light = area_lights_[cluster.light];
      const Vec2f at = cluster.low + 0.5f * cluster.size;
      where = area_light.corner + at.x * area_light.edge_u + at.y * area_light.edge_v;
      area = area_light.size_u * area_light.size_v * cluster.size.x * cluster.size.y;
      strength = area * area_light.radiance;
    }
    const Vec3f d = where - position;
    const float distance2 = std::max({dot(d, d), 0.1f * area, 1e-12f});
    const Vec3f direction = d / std::sqrt(distance2);
    const float facing = cluster.kind == Cluster::Kind::area_light
                             ? std::max(0.0f, -dot(direction, area_lights_[cluster.light].normal))
                             : 1.0f;
    storage.x[count] = direction.x;
    storage.y[count] = direction.y;
    storage.z[count] = direction.z;
    storage.flux[count] = facing * mean_of_channels(strength) / distance2;
    storage.spread2[count] = spread2 ? *spread2 / distance2 : area / (6.0f * distance2);
    ++count;
  }
  return {count,
          storage.x.data(),
          storage.y.data(),
          storage.z.data(),
          storage.flux.data(),
          storage.spread2.data()};
}

LightSample Lights::sample_cluster(std::size_t cluster, const Vec3f& position, Vec2f u) const {
  const auto& [kind, light, low, size, probability] = clusters_[cluster];
  const Vec2f v{low.x + u.x * size.x, low.y + u.y * size.y};
  if (kind == Cluster::Kind::delta_light) return sample_delta_light(delta_lights_[light], position);
  if (kind == Cluster::Kind::ball) return sample_ball_light(ball_lights_[light], position, v);
  if (kind == Cluster::Kind::surface)
    return sample_surface_light(surface_lights_[light], position, v);
  if (kind == Cluster::Kind::area_light) {
    LightSample sample = sample_area_light(area_lights_[light], position, v);
    sample.pdf *= area_lights_[light].probability;
    return sample;
  }
  return sample_infinite_light(infinite_lights_[light], v);
}

}  // namespace lamina
