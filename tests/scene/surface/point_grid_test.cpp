// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/surface/point_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lamina/base/core/random.h"

namespace lamina {
namespace {

/// Nothing but the definition.
std::vector<std::uint32_t> near_by_search(const std::vector<PointGrid::Place>& places, float reach,
                                          const Vec3f& position, const Vec3f& normal) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3f offset = places[i].position - position;
    if (dot(offset, offset) < reach * reach && dot(places[i].normal, normal) > 0.25f)
      found.push_back(static_cast<std::uint32_t>(i));
  }
  return found;
}

TEST(PointGrid, FindsWhatASearchFinds) {
  Random random = make_random(7, 0);
  const auto number = [&](float from, float to) {
    return from + (to - from) * random.uniform_float();
  };
  std::vector<PointGrid::Place> places;
  for (int i = 0; i < 400; ++i)
    places.push_back({{number(-9.0f, 9.0f), number(-9.0f, 9.0f), number(-9.0f, 9.0f)},
                      i % 3 == 0 ? Vec3f{0, 0, -1} : Vec3f{0, 0, 1}});
  const float reach = 1.9f;
  const PointGrid grid(places, reach);
  for (int i = 0; i < 400; ++i) {
    const Vec3f at{number(-10.0f, 10.0f), number(-10.0f, 10.0f), number(-10.0f, 10.0f)};
    const PointGrid::Near near = grid.near(at, {0, 0, 1});
    std::vector<std::uint32_t> found(near.point.begin(), near.point.begin() + near.count);
    std::ranges::sort(found);
    EXPECT_EQ(found, near_by_search(places, reach, at, {0, 0, 1}));
  }
}

// Cells that are as wide as what is looked through must not part where numbers are rounded: a
// million samples far from the origin had one that did not find itself, and a picture of NaN.
TEST(PointGrid, FindsEachPointItselfHoweverItIsRounded) {
  const float reach = 0.0483862f;
  std::vector<PointGrid::Place> places;
  for (int k = -400; k < 400; ++k) {
    float x = (static_cast<float>(k) + 0.5f) * (2.0f * reach);
    for (int step = 0; step < 16; ++step) x = std::nextafter(x, -1e9f);
    for (int step = 0; step < 32; ++step, x = std::nextafter(x, 1e9f))
      places.push_back({{x, 0.3f, 0.7f}, {0, 0, 1}});
  }
  int lost = 0;
  for (const PointGrid::Place& place : places)
    lost += PointGrid({&place, 1}, reach).near(place.position, place.normal).count == 0;
  EXPECT_EQ(lost, 0) << "of " << places.size();
}

}  // namespace
}  // namespace lamina
