// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/surface/internal/near_places.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/scene/surface/internal/near_places.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, surface_detail::padding_of_rows>;

std::size_t find_near_places(const surface_detail::PlaceRows& places,
                             std::span<const surface_detail::PlaceRange> ranges,
                             const Vec3f& position, const Vec3f& normal, float reach,
                             float least_facing, std::span<std::uint32_t> found) {
  const Tag d;
  const auto n = static_cast<std::uint32_t>(hn::Lanes(d));
  const auto px = hn::Set(d, position.x), py = hn::Set(d, position.y), pz = hn::Set(d, position.z);
  const auto nx = hn::Set(d, normal.x), ny = hn::Set(d, normal.y), nz = hn::Set(d, normal.z);
  const auto reach2 = hn::Set(d, reach * reach), least = hn::Set(d, least_facing);
  std::size_t count = 0;
  for (const auto& [first, end] : ranges)
    for (std::uint32_t k = first; k < end; k += n) {
      const auto row = [&](std::size_t i) { return hn::LoadU(d, places[i].data() + k); };
      const auto x = hn::Sub(row(0), px), y = hn::Sub(row(1), py), z = hn::Sub(row(2), pz);
      const auto distance2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const auto facing = hn::MulAdd(row(3), nx, hn::MulAdd(row(4), ny, hn::Mul(row(5), nz)));
      const auto is_near = hn::And(hn::Lt(distance2, reach2), hn::Gt(facing, least));
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::And(is_near, hn::FirstN(d, end - k)), bits);
      for (unsigned left = bits[0]; left != 0 && count < found.size(); left &= left - 1)
        found[count++] = k + static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
    }
  return count;
}

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {

HWY_EXPORT(find_near_places);

std::size_t surface_detail::find_near_places(const PlaceRows& places,
                                             std::span<const PlaceRange> ranges,
                                             const Vec3f& position, const Vec3f& normal,
                                             float reach, float least_facing,
                                             std::span<std::uint32_t> found) {
  return HWY_DYNAMIC_DISPATCH(find_near_places)(places, ranges, position, normal, reach,
                                                least_facing, found);
}

}  // namespace lamina
#endif
