// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/hierarchy/internal/irradiance_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamina {
namespace {

/// Every third bit of the result is one of the 21 bits of x.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | (x << 32)) & 0x001f00000000ffffu;
  x = (x | (x << 16)) & 0x001f0000ff0000ffu;
  x = (x | (x << 8)) & 0x100f00f00f00f00fu;
  x = (x | (x << 4)) & 0x10c30c30c30c30c3u;
  return (x | (x << 2)) & 0x1249249249249249u;
}

constexpr int levels = 21;
constexpr float normal_weight = 3.0f;  // how much finer nodes of differing normals are cut
constexpr float albedo_weight = 3.0f;  // and of differing albedo indices, per unit of variance

}  // namespace

template <int N>
struct IrradianceTree<N>::Builder {
  std::span<const IrradianceSample<N>> samples;
  std::vector<std::uint64_t> codes;  ///< [place], ascending
  std::vector<std::uint32_t> order;  ///< [place]
  IrradianceTree& tree;

  /// What a node is made of.
  struct Sum {
    double weight = 0.0, area = 0.0;
    Vec3 position, normal;
    double shade2 = 0.0;
    BandValues<N> power, albedo_index;  ///< albedo_index weighted
  };

  Sum sum_of(std::size_t from, std::size_t to) const {
    Sum total;
    for (std::size_t i = from; i < to; ++i) {
      const IrradianceSample<N>& s = samples[order[i]];
      const BandValues<N> power = s.area * s.irradiance;
      // A dark sample still has a place.
      const double weight =
          static_cast<double>(lamina::sum(power)) + 1e-6 * static_cast<double>(s.area);
      total.weight += weight;
      total.area += static_cast<double>(s.area);
      for (int k = 0; k < 3; ++k) {
        total.position[k] += weight * static_cast<double>(s.position[k]);
        total.normal[k] += weight * static_cast<double>(s.normal[k]);
      }
      total.power += power;
      total.albedo_index += static_cast<float>(weight) * s.albedo_index;
      total.shade2 += weight * static_cast<double>(lamina::sum(s.albedo_index * s.albedo_index));
    }
    return total;
  }

  /// Adds the node of a range of places, which agree down to a level, and all below it.
  void add(std::size_t from, std::size_t to, int level) {
    const std::size_t index = tree.nodes_.size();
    tree.nodes_.emplace_back();
    tree.shades_.emplace_back();
    const Sum total = sum_of(from, to);
    Node node;
    const auto single = [](const Vec3& v) {
      return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    node.power = total.power;
    node.center = single(total.position / total.weight);
    node.normal = single(total.normal / total.weight);
    double mean_square = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const IrradianceSample<N>& s = samples[order[i]];
      const Vec3f offset = s.position - node.center;
      const float d2 = dot(offset, offset);
      node.radius = std::max(node.radius, std::sqrt(d2));
      mean_square += static_cast<double>(lamina::sum(s.area * s.irradiance)) *
                     static_cast<double>(d2) / total.weight;
    }
    node.mean_square = static_cast<float>(mean_square);
    const BandValues<N> albedo_index = static_cast<float>(1.0 / total.weight) * total.albedo_index;
    const float unlike = 1.0f - std::min(dot(node.normal, node.normal), 1.0f);
    const float shade_variance = std::max(
        static_cast<float>(total.shade2 / total.weight) - lamina::sum(albedo_index * albedo_index),
        0.0f);
    node.size = static_cast<float>(total.area) *
                (1.0f + normal_weight * unlike + albedo_weight * shade_variance);
    if (to - from > 1) add_children(from, to, level);
    node.next = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_[index] = node;
    tree.shades_[index] = albedo_index;
  }

  void add_children(std::size_t from, std::size_t to, int level) {
    // Down to where the samples part; those at the same place are parted by their number.
    while (level > 0 && octant(from, level - 1) == octant(to - 1, level - 1)) --level;
    if (level == 0) {
      const std::size_t middle = from + (to - from) / 2;
      add(from, middle, 0);
      add(middle, to, 0);
      return;
    }
    for (std::size_t begin = from; begin < to;) {
      std::size_t end = begin + 1;
      while (end < to && octant(end, level - 1) == octant(begin, level - 1)) ++end;
      add(begin, end, level - 1);
      begin = end;
    }
  }

  [[nodiscard]] std::uint64_t octant(std::size_t place, int level) const {
    return (codes[place] >> (3 * level)) & 7u;
  }
};

template <int N>
IrradianceTree<N>::IrradianceTree(std::span<const IrradianceSample<N>> samples) {
  if (samples.empty()) return;
  Vec3f low = samples[0].position, high = low;
  for (const auto& s : samples)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], s.position[k]);
      high[k] = std::max(high[k], s.position[k]);
    }
  const float side = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-20f}) * 1.0001f;
  std::vector<std::uint64_t> code_of(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const float at = (samples[i].position[k] - low[k]) / side;
      code |= spread_bits(static_cast<std::uint64_t>(at * static_cast<float>(1 << levels))) << k;
    }
    code_of[i] = code;
  }
  Builder builder{.samples = samples, .codes = {}, .order = {}, .tree = *this};
  builder.order.resize(samples.size());
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  std::ranges::sort(builder.order, [&](std::uint32_t a, std::uint32_t b) {
    return code_of[a] != code_of[b] ? code_of[a] < code_of[b] : a < b;
  });
  for (const std::uint32_t i : builder.order) builder.codes.push_back(code_of[i]);
  nodes_.reserve(2 * samples.size());
  shades_.reserve(2 * samples.size());
  builder.add(0, samples.size(), levels);
  const bool is_shaded = std::ranges::any_of(shades_, [](const BandValues<N>& albedo_index) {
    return lamina::sum(albedo_index * albedo_index) > 0.0f;
  });
  if (!is_shaded) shades_ = {};
}

template class IrradianceTree<4>;
template class IrradianceTree<8>;
template class IrradianceTree<16>;

}  // namespace lamina
