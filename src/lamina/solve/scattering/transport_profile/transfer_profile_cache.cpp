// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/transfer_profile_cache.h"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lamina/base/io/packed_values.h"
#include "transfer_profile_fingerprint.h"

// Structures are taken apart by structured bindings: a new member does not compile until it is
// written here, too.
namespace lamina {
namespace {

void put(PackedWriter& writer, const HenyeyGreenstein& phase) {
  writer.put('h');
  writer.put(phase.g);
}
void put(PackedWriter& writer, const Rayleigh&) { writer.put('r'); }
void put(PackedWriter& writer, const PhaseMixture& mixture) {
  writer.put('m');
  writer.put(mixture.lobes.size());
  for (const auto& [weight, phase] : mixture.lobes) {
    writer.put(weight);
    std::visit([&](const auto& lobe) { put(writer, lobe); }, phase);
  }
}

void put(PackedWriter& writer, const Interface& boundary) {
  const auto& [roughness, distribution] = boundary;
  writer.put(roughness);
  writer.put(distribution);
}

void put(PackedWriter& writer, const LayerStack& stack) {
  writer.put(stack.ior_above());
  writer.put(stack.ior_below());
  const auto& [ground_top, ground_reflectance] = stack.ground();
  put(writer, ground_top);
  writer.put(ground_reflectance);
  writer.put(stack.layers().size());
  for (const Layer& layer : stack.layers()) {
    const auto& [medium, thickness, top, phase] = layer;
    const auto& [sigma_a, sigma_s, g, ior] = medium;
    for (const double value : {sigma_a, sigma_s, g, ior, thickness}) writer.put(value);
    put(writer, top);
    std::visit([&](const auto& kind) { put(writer, kind); }, phase_function(layer));
  }
}

void put(PackedWriter& writer, const RadialGrid& radii) {
  const auto& [first, last, size] = radii;
  writer.put(first);
  writer.put(last);
  writer.put(size);
}

std::string key_of(std::span<const LayerStack> stacks, const RadialGrid& radii,
                   const TransferProfileOptions& options) {
  PackedWriter writer;
  writer.put_text("transfer profile, format 3, solver " LAMINA_TRANSFER_PROFILE_FINGERPRINT);
  put(writer, radii);
  const auto& [accuracy, error, r_lowest, r_highest, illumination, is_from_below, progress] =
      options;
  for (const double value : {accuracy, r_lowest, r_highest}) writer.put(value);
  writer.put(error);
  writer.put(illumination);
  writer.put(is_from_below);
  writer.put(stacks.size());
  for (const LayerStack& stack : stacks) put(writer, stack);
  return std::move(writer).bytes();
}

std::string key_of(std::span<const LayerStack> half_spaces, const ThicknessRange& range,
                   const RadialGrid& radii) {
  PackedWriter writer;
  writer.put_text("thickness profiles, format 1, solver " LAMINA_TRANSFER_PROFILE_FINGERPRINT);
  put(writer, radii);
  const auto& [thinnest, thickest, least_transmittance] = range;
  for (const double value : {thinnest, thickest, least_transmittance}) writer.put(value);
  writer.put(half_spaces.size());
  for (const LayerStack& stack : half_spaces) put(writer, stack);
  return std::move(writer).bytes();
}

/// Calls `act` for every member of a profile, for writing as for reading.
template <class Profile, class Act>
void for_each_member_of(Profile& profile, const Act& act) {
  auto& [per, bands, r, reflectance, transmittance, total_reflectance, total_transmittance] =
      profile;
  act(per), act(bands), act(r), act(reflectance), act(transmittance);
  act(total_reflectance), act(total_transmittance);
}

/// Calls `act` for every member of a result.
template <class Result, class Act>
void for_each_member(Result& result, const Act& act) {
  auto& [profile, relative_error, transmittance_error, estimated_error, mean_error, nodes, modes,
         photons, is_accurate] = result;
  for_each_member_of(profile, act);
  act(relative_error), act(transmittance_error), act(estimated_error), act(mean_error), act(nodes),
      act(modes), act(photons), act(is_accurate);
}

std::string packed(const TransferProfile& result) {
  PackedWriter writer;
  for_each_member(result, [&](const auto& member) { writer.put(member); });
  return std::move(writer).bytes();
}

std::optional<TransferProfile> unpacked(std::string_view bytes) {
  PackedReader reader(bytes);
  TransferProfile result;
  for_each_member(result, [&](auto& member) { reader.get(member); });
  return reader.is_done() ? std::optional(std::move(result)) : std::nullopt;
}

std::string packed(const ThicknessProfiles& result) {
  PackedWriter writer;
  const auto write = [&](const auto& member) { writer.put(member); };
  const auto& [half_space, slabs, thickness] = result;
  writer.put(thickness);
  for_each_member_of(half_space, write);
  for (const Profile& slab : slabs) for_each_member_of(slab, write);
  return std::move(writer).bytes();
}

std::optional<ThicknessProfiles> unpacked_thickness_profiles(std::string_view bytes) {
  PackedReader reader(bytes);
  const auto read = [&](auto& member) { reader.get(member); };
  ThicknessProfiles result;
  reader.get(result.thickness);
  for_each_member_of(result.half_space, read);
  result.slabs.resize(result.thickness.size());
  for (Profile& slab : result.slabs) for_each_member_of(slab, read);
  return reader.is_done() ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace

CachedTransferProfile cached_transfer_profile(const std::optional<DiskCache>& cache,
                                              std::span<const LayerStack> stacks,
                                              const RadialGrid& radii,
                                              const TransferProfileOptions& options) {
  if (!cache) return {transfer_profile(stacks, radii, options)};
  const std::string key = key_of(stacks, radii, options);
  if (const auto bytes = load_cached(*cache, key))
    if (auto result = unpacked(*bytes)) return {std::move(*result), true};
  TransferProfile result = transfer_profile(stacks, radii, options);
  save_cached(*cache, key, packed(result));
  return {std::move(result)};
}

ThicknessProfiles cached_thickness_profiles(const std::optional<DiskCache>& cache,
                                            std::span<const LayerStack> half_spaces,
                                            const ThicknessRange& range, const RadialGrid& radii,
                                            const Progress& progress) {
  if (!cache) return thickness_profiles(half_spaces, range, radii, progress);
  const std::string key = key_of(half_spaces, range, radii);
  if (const auto bytes = load_cached(*cache, key))
    if (auto result = unpacked_thickness_profiles(*bytes)) return std::move(*result);
  ThicknessProfiles result = thickness_profiles(half_spaces, range, radii, progress);
  save_cached(*cache, key, packed(result));
  return result;
}

}  // namespace lamina
