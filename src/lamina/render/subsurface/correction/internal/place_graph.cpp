// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/place_graph.h"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

constexpr float reach_of_spacing = 1.9f;
constexpr float step_width = 0.6f;  // over the spacing
constexpr float zone_width = 0.25f;

int level_of(float spacing, float least) {
  return static_cast<int>(std::lround(std::log2(spacing / least)));
}

}  // namespace

double PlaceGraph::places_reached(int steps) {
  // 4 pi times the variance along each axis: what remains at a place of a Gaussian, inverted.
  constexpr double per_step = 4.5;
  return 1.0 + per_step * steps;
}

PlaceGraph::PlaceGraph(std::span<const Place> places) {
  first_.assign(places.size() + 1, 0);
  if (places.empty()) return;
  float least = places.front().spacing, most = least;
  for (const Place& place : places) {
    least = std::min(least, place.spacing);
    most = std::max(most, place.spacing);
  }
  for (int level = 0; level <= level_of(most, least); ++level) {
    std::vector<PointGrid::Place> of_level;
    auto& numbers = places_of_.emplace_back();
    for (std::size_t i = 0; i < places.size(); ++i)
      if (level_of(places[i].spacing, least) >= level - 1) {
        of_level.push_back(places[i].at);
        numbers.push_back(static_cast<std::uint32_t>(i));
      }
    const float spacing = least * static_cast<float>(1 << level);
    grids_.emplace_back(of_level, reach_of_spacing * spacing);
  }
  std::vector<float> sent(places.size(), 0.0f);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto level = static_cast<std::size_t>(level_of(places[i].spacing, least));
    const auto near = grids_[level].near(places[i].at.position, places[i].at.normal);
    const float width = step_width * places[i].spacing;
    const auto connect = [&](std::uint32_t from, float weight) {
      from_.push_back(from);
      share_.push_back(weight);
      sent[from] += weight;
    };
    bool has_itself = false;
    for (std::size_t k = 0; k < near.count; ++k) {
      const std::uint32_t from = places_of_[level][near.point[k]];
      has_itself = has_itself || from == i;
      const float apart = (places[from].zone - places[i].zone) / zone_width;
      connect(from, near.facing[k] *
                        std::exp(-0.5f * (dot(near.offset[k], near.offset[k]) / (width * width) +
                                          apart * apart)));
    }
    if (!has_itself) connect(static_cast<std::uint32_t>(i), 1.0f);
    first_[i + 1] = from_.size();
  }
  for (std::size_t k = 0; k < from_.size(); ++k) share_[k] /= sent[from_[k]];
}

PointGrid::Weights PlaceGraph::weights_at(const Vec3f& position, const Vec3f& normal) const {
  for (std::size_t level = 0; level < grids_.size(); ++level) {
    PointGrid::Weights weights = grids_[level].weights_at(position, normal);
    if (weights.count == 0) continue;
    for (std::size_t k = 0; k < weights.count; ++k)
      weights.point[k] = places_of_[level][weights.point[k]];
    return weights;
  }
  return {.point = {}, .weight = {}, .count = 0};
}

}  // namespace lamina
