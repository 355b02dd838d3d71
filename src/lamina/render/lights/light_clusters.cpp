// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/render/lights/lights.h"

namespace lamina {
namespace {

constexpr int sky_halvings = 7;     // 128 parts
constexpr int panel_cuts = 2;       // along either side
constexpr int samples_of_part = 4;  // along either side, to find out how bright it is and where

float brightness(const Vec3f& c) { return (c.x + c.y + c.z) / 3.0f; }

}  // namespace

void Lights::make_parts() {
  for (std::size_t i = 0; i < skies_.size(); ++i)
    if (skies_[i].environment.can_be_drawn()) cut_sky(i, {0.0f, 0.0f}, {1.0f, 1.0f}, sky_halvings);
  const auto add_spots = [&](bool far) {
    for (std::size_t i = 0; i < spots_.size(); ++i)
      if (spots_[i].is_far == far && spots_[i].probability > 0.0f)
        parts_.push_back({Part::Of::spot, i, {0.0f, 0.0f}, {1.0f, 1.0f}, spots_[i].probability});
  };
  add_spots(true);
  for (std::size_t i = far_parts_[0].size(); i < parts_.size(); ++i) {
    const Spot& spot = spots_[parts_[i].light];
    const float values[] = {spot.where.x, spot.where.y, spot.where.z, brightness(spot.strength),
                            0.0f};
    for (std::size_t v = 0; v < 5; ++v) far_parts_[v].push_back(values[v]);
  }
  add_spots(false);
  constexpr float side = 1.0f / panel_cuts;
  for (std::size_t i = 0; i < panels_.size(); ++i)
    for (int y = 0; y < panel_cuts; ++y)
      for (int x = 0; x < panel_cuts; ++x)
        if (panels_[i].probability > 0.0f)
          parts_.push_back({Part::Of::panel,
                            i,
                            {side * static_cast<float>(x), side * static_cast<float>(y)},
                            {side, side},
                            side * side * panels_[i].probability});
  const bool are_too_many = parts_.size() > most_light_parts ||
                            parts_.size() - far_parts_[0].size() > most_near_light_parts;
  if (are_too_many) parts_.clear();
}

void Lights::cut_sky(std::size_t sky, Vec2f low, Vec2f size, int halvings) {
  const Environment& environment = skies_[sky].environment;
  const auto at = [&](float x, float y) {
    return environment.draw({low.x + x * size.x, low.y + y * size.y});
  };
  if (halvings > 0) {
    const auto apart = [](const Vec3f& a, const Vec3f& b) { return dot(a - b, a - b); };
    const float across = apart(at(0.02f, 0.5f).direction, at(0.98f, 0.5f).direction);
    const float down = apart(at(0.5f, 0.02f).direction, at(0.5f, 0.98f).direction);
    const Vec2f half = across > down ? Vec2f{0.5f * size.x, size.y} : Vec2f{size.x, 0.5f * size.y};
    cut_sky(sky, low, half, halvings - 1);
    cut_sky(sky, low + (size - half), half, halvings - 1);
    return;
  }
  std::vector<Environment::Drawn> drawn;
  for (int i = 0; i < samples_of_part * samples_of_part; ++i)
    drawn.push_back(at((static_cast<float>(i % samples_of_part) + 0.5f) / samples_of_part,
                       (static_cast<float>(i / samples_of_part) + 0.5f) / samples_of_part));
  Vec3f middle;
  float flux = 0.0f, spread2 = 0.0f;
  const auto flux_of = [&](const Environment::Drawn& d) {
    return d.seen.pdf > 0.0f ? size.x * size.y * brightness(d.seen.radiance) /
                                   (d.seen.pdf * static_cast<float>(drawn.size()))
                             : 0.0f;
  };
  for (const Environment::Drawn& d : drawn) {
    flux += flux_of(d);
    middle += flux_of(d) * d.direction;
  }
  middle = length(middle) > 0.0f ? normalize(middle) : drawn.front().direction;
  for (const Environment::Drawn& d : drawn)
    spread2 += dot(d.direction - middle, d.direction - middle) / static_cast<float>(drawn.size());
  parts_.push_back({Part::Of::sky, sky, low, size, size.x * size.y * skies_[sky].probability});
  const float values[] = {middle.x, middle.y, middle.z, flux, spread2};
  for (std::size_t v = 0; v < 5; ++v) far_parts_[v].push_back(values[v]);
}

LightPartsSeen Lights::far_parts() const {
  const auto& [x, y, z, flux, spread2] = far_parts_;
  return {parts_.empty() ? 0 : x.size(), x.data(), y.data(), z.data(), flux.data(), spread2.data()};
}

LightPartsSeen Lights::near_parts(const Vec3f& position, NearLightParts& storage) const {
  std::size_t count = 0;
  for (std::size_t i = far_parts().count; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    Vec3f where, strength;
    float area = 0.0f;
    if (part.of == Part::Of::spot) {
      where = spots_[part.light].where;
      strength = spots_[part.light].strength;
    } else {
      const Panel& panel = panels_[part.light];
      const Vec2f at = part.low + 0.5f * part.size;
      where = panel.corner + at.x * panel.edge_u + at.y * panel.edge_v;
      area = panel.size_u * panel.size_v * part.size.x * part.size.y;
      strength = area * panel.radiance;
    }
    const Vec3f d = where - position;
    const float distance2 = std::max({dot(d, d), 0.1f * area, 1e-12f});
    const Vec3f direction = d / std::sqrt(distance2);
    const float facing = part.of == Part::Of::spot
                             ? 1.0f
                             : std::max(0.0f, -dot(direction, panels_[part.light].normal));
    storage.x[count] = direction.x;
    storage.y[count] = direction.y;
    storage.z[count] = direction.z;
    storage.flux[count] = facing * brightness(strength) / distance2;
    storage.spread2[count] = area / (6.0f * distance2);  // of a square
    ++count;
  }
  return {count,
          storage.x.data(),
          storage.y.data(),
          storage.z.data(),
          storage.flux.data(),
          storage.spread2.data()};
}

LightSample Lights::sample_part(std::size_t part, const Vec3f& position, Vec2f u) const {
  const auto& [of, light, low, size, probability] = parts_[part];
  const Vec2f v{low.x + u.x * size.x, low.y + u.y * size.y};
  if (of == Part::Of::spot) return sample_spot(spots_[light], position);
  if (of == Part::Of::panel) {
    LightSample sample = sample_panel(panels_[light], position, v);
    sample.pdf *= panels_[light].probability;
    return sample;
  }
  return sample_sky(skies_[light], v);
}

}  // namespace lamina
