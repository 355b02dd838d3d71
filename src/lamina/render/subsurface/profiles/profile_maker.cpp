// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/profile_maker.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/symmetric_slab.h"
#include "lamina/scene/description/skin_totals.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/dipole_profile.h"
#include "lamina/solve/scattering/transport_profile/half_space_table.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"

namespace lamina {
namespace {

constexpr double profile_accuracy = 0.02;

/// Roughness of a top up to which a smooth one stands in for it:
/// test ProfileMaker.SmoothTopsStandInForRoughOnes.
constexpr double roughest_stand_in = 0.4;

/// The part of diffuse light that enters, [band].
std::vector<double> entering(std::span<const LayerStack> bands) {
  std::vector<double> parts;
  for (const LayerStack& band : bands)
    parts.push_back(1.0 - diffuse_reflectance_outside(band.layers()[0].top, band.ior_above(),
                                                      band.layers()[0].medium.ior));
  return parts;
}

std::vector<LayerStack> with_smooth_bottoms(std::span<const LayerStack> bands) {
  std::vector<LayerStack> stacks;
  for (const LayerStack& band : bands) stacks.push_back(with_smooth_bottom(band));
  return stacks;
}

/// Layers with smooth ends and, for a rough top, a higher index above, which lets light out and in
/// within a wider cone, as facets do, and more so the darker the first layer is. Profiles per
/// entered flux are those under the rough top within 1 % in the mean at a roughness of .2 and 3 %
/// at .4, at an index of 1.33 1.4 and 3.4 %; with the index above as it is 2 to 5 and 4 to 12 %:
/// test ProfileMaker.SmoothTopsStandInForRoughOnes.
LayerStack with_stand_in_top(const LayerStack& stack) {
  LayerStack smooth = with_smooth_ends(stack);
  const double roughness = stack.layers().front().top.roughness;
  if (roughness == 0.0 || stack.layers().front().medium.ior <= stack.ior_above()) return smooth;
  const Medium& first = stack.layers().front().medium;
  const double scattered = first.sigma_s * (1.0 - first.g);
  const double albedo = scattered / (scattered + first.sigma_a);
  const double above =
      stack.ior_above() * (1.0 + 0.1 * std::pow(roughness, 1.45) * (3.0 - 2.0 * albedo));
  return LayerStack({smooth.layers().begin(), smooth.layers().end()}, above, smooth.ior_below(),
                    smooth.ground());
}

/// Tables that cover all bands, each as often as it is needed.
struct BandTables {
  std::vector<std::unique_ptr<HalfSpaceTable>> tables;
  std::vector<const HalfSpaceTable*> of_band;  ///< [band]
};

BandTables make_tables(std::span<const LayerStack> bands, const Progress& progress) {
  BandTables made;
  for (const LayerStack& band : bands) {
    const auto covers = [&](const auto& table) { return table->covers(band); };
    auto found = std::ranges::find_if(made.tables, covers);
    if (found == made.tables.end()) {
      made.tables.push_back(std::make_unique<HalfSpaceTable>(band, user_cache(), progress));
      found = made.tables.end() - 1;
    }
    made.of_band.push_back(found->get());
  }
  return made;
}

}  // namespace

std::optional<std::string> transfer_refusal(const Material& material) {
  try {
    const std::vector<LayerStack> bands = with_smooth_bottoms(layer_stacks(material));
    require_transfer_profile(bands);
    if (!is_semi_infinite(bands.front())) return std::nullopt;
    std::vector<LayerStack> slabs;  // of a usual thickness
    for (const LayerStack& band : bands)
      slabs.push_back(make_slab(band, 3.0 * thickness_of_upper_layers(band) + 1.0));
    require_transfer_profile(slabs);
  } catch (const InvalidInput& refusal) {
    return refusal.what();
  }
  return std::nullopt;
}

Profile diffuse_transfer_profile(std::span<const LayerStack> bands,
                                 const std::optional<DiskCache>& cache, const Progress& progress) {
  const auto [transfer, was_cached] =
      cached_transfer_profile(cache, with_smooth_bottoms(bands), {},
                              {.accuracy = profile_accuracy,
                               .error = ProfileError::mean,
                               .illumination = Illumination::diffuse,
                               .progress = progress});
  return per_entered_flux(transfer.profile, entering(bands));
}

Profile diffusion_profile(const Material& material) {
  return make_diffusion_profile(layer_stacks(material)).profile;
}

ProfileMaker::ProfileMaker(const RenderSettings& settings, Progress progress)
    : settings_(settings), progress_(std::move(progress)) {}

ProfileMaker::Source ProfileMaker::source(const Material& material) const {
  const Source asked = profile_of(settings_);
  const bool may_change = asked == Source::radiative_transfer && !settings_.profile;
  return may_change && (material.is_by_diffusion || transfer_refusal(material)) ? Source::diffusion
                                                                                : asked;
}

Profile ProfileMaker::operator()(const Material& material,
                                 std::span<const LayerStack> bands) const {
  const Source from = source(material);
  if (auto alone = together(material, bands, {.thickest = 0.0}))
    return std::move(alone->half_space);
  if (from == Source::radiative_transfer)
    return diffuse_transfer_profile(bands, user_cache(), progress_);
  Profile profile =
      from == Source::dipole ? make_dipole_profile(bands) : make_diffusion_profile(bands).profile;
  return takes_material_totals(material, settings_)
             ? with_material_totals(std::move(profile), bands)
             : profile;
}

std::optional<ProfileMaker::ByThickness> ProfileMaker::together(
    const Material& material, std::span<const LayerStack> bands,
    const ThicknessRange& range) const {
  const bool has_stand_in = std::ranges::all_of(bands, [](const LayerStack& band) {
    return band.layers().front().top.roughness <= roughest_stand_in;
  });
  if (source(material) != Source::radiative_transfer || !has_stand_in) return std::nullopt;
  std::vector<LayerStack> smooth;
  for (const LayerStack& band : bands) smooth.push_back(with_stand_in_top(band));
  if (!takes_thickness_profiles(smooth)) return std::nullopt;
  ThicknessProfiles made = cached_thickness_profiles(user_cache(), smooth, range, {}, progress_);
  const std::vector<double> entered = entering(smooth);
  const auto per_entered = [&](Profile& profile) {
    return per_entered_flux(std::move(profile), entered);
  };
  ByThickness result{.thickness = std::move(made.thickness),
                     .slabs = {},
                     .half_space = per_entered(made.half_space)};
  for (Profile& slab : made.slabs) result.slabs.push_back(per_entered(slab));
  return result;
}

ProfileMaker::SlabThicknesses ProfileMaker::slab_thicknesses(const LayerStack& half_space) {
  return {.thinnest = std::max(2.5 * thickness_of_upper_layers(half_space), 0.05),
          .thickest = ThicknessRange{}.thickest};
}

ProfileMaker::ByThickness ProfileMaker::by_thickness(const Material& material,
                                                     std::span<const LayerStack> bands,
                                                     double thinnest_place) const {
  const auto [thinnest, thickest] = slab_thicknesses(bands.front());
  // The first slab is thinner than what was seen by a step: places between those may be.
  const double outer = 2.0 * thickness_of_upper_layers(bands.front());
  double inner = thinnest - outer;
  while (outer + 2.0 * inner < std::min(thinnest_place, thickest)) inner *= std::numbers::sqrt2;
  const ThicknessRange range{.thinnest = outer + inner,
                             .thickest = thinnest_place < thickest ? thickest : 0.0};
  if (auto all = together(material, bands, range)) return std::move(*all);
  ByThickness result;
  for (; outer + inner < range.thickest; inner *= std::numbers::sqrt2) {
    std::vector<LayerStack> slab;
    for (const LayerStack& band : bands) slab.push_back(slab_with_inner_thickness(band, inner));
    result.slabs.push_back((*this)(material, slab));
    result.thickness.push_back(outer + inner);
    if (std::ranges::max(result.slabs.back().total_transmittance) < range.least_transmittance)
      break;
  }
  result.half_space = (*this)(material, bands);
  return result;
}

ProfileMaker::OfAnyAbsorption ProfileMaker::of_any_absorption(
    const Material& material, std::span<const LayerStack> bands) const {
  if (source(material) != Source::radiative_transfer ||
      !std::ranges::all_of(bands, HalfSpaceTable::is_for))
    return
        [*this, material](std::span<const LayerStack> layers) { return (*this)(material, layers); };
  const auto tables = std::make_shared<const BandTables>(make_tables(bands, progress_));
  return [tables](std::span<const LayerStack> layers) {
    return per_entered_flux(HalfSpaceTable::profile(tables->of_band, layers), entering(layers));
  };
}

}  // namespace lamina
