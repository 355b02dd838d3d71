// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/lookup/internal/node_blend.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/skin/lookup/internal/node_blend.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
// Functions of Highway's own, which come after it.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void blend_eight_nodes(const std::array<const float*, 8>& nodes,
                       const std::array<float, 8>& weights, lookup_detail::NodeBlend& result) {
  const hn::CappedTag<float, lookup_detail::node_numbers> d;
  for (std::size_t i = 0; i < lookup_detail::node_numbers; i += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      sum = hn::MulAdd(hn::Set(d, weights[n]), hn::LoadU(d, nodes[n] + i), sum);
    hn::StoreU(sum, d, result.sums.data() + i);
    hn::StoreU(hn::Exp(d, sum), d, result.exponentials.data() + i);
  }
}

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {

HWY_EXPORT(blend_eight_nodes);

void lookup_detail::blend_nodes(const std::array<const float*, 8>& nodes,
                                const std::array<float, 8>& weights, NodeBlend& blend) {
  HWY_DYNAMIC_DISPATCH(blend_eight_nodes)(nodes, weights, blend);
}

}  // namespace lamina
#endif
