// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/photon_formats.h"

#include <algorithm>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina::detail {

std::vector<std::string> notes_of_photons(const std::string& program, const ExportInput& input) {
  std::vector<std::string> notes;
  const auto any_stack = [&](const auto& holds) {
    return std::ranges::any_of(input.stacks, holds);
  };
  if (any_stack([](const LayerStack& stack) { return !is_smooth(stack); }))
    notes.push_back("boundaries are smooth in " + program + "; those of the material are rough");
  if (any_stack([](const LayerStack& stack) {
        return std::ranges::any_of(stack.layers(), [](const Layer& layer) {
          return layer.medium.sigma_s > 0.0 &&
                 !std::holds_alternative<HenyeyGreenstein>(phase_function(layer));
        });
      }))
    notes.push_back(program +
                    " scatters by Henyey and Greenstein's function; where the material does by "
                    "another, g is its mean cosine");
  if (any_stack([](const LayerStack& stack) { return stack.ground().reflectance > 0.0; }))
    notes.push_back("there is no ground that reflects in " + program +
                    "; light that reaches it leaves");
  if (input.material.oiliness > 0.0) notes.emplace_back("the oily coat is left out");
  return notes;
}

std::vector<ChannelMisfit> beam_misfits(const ExportInput& input,
                                        std::span<const LayerStack> written) {
  std::vector<ChannelMisfit> misfits;
  const auto wanted = adding_doubling(input.stacks), obtained = adding_doubling(written);
  for (std::size_t b = 0; b < written.size(); ++b) {
    const SlabTotals &from = wanted[b].totals, &to = obtained[b].totals;
    misfits.push_back({.channel = band_name(input.material.bands, b),
                       .reflectance = {from.diffuse_reflectance, to.diffuse_reflectance, {}}});
    if (!is_semi_infinite(input.stacks[b]))
      misfits.back().transmittance = LightMisfit{from.transmittance, to.transmittance, {}};
  }
  return misfits;
}

}  // namespace lamina::detail
