// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "lamina/base/io/disk_cache.h"
#include "lamina/solve/scattering/transport_profile/thickness_profiles.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {

/// `transfer_profile`, solved only if the cache does not have it, and kept there.
///
/// A profile is found by all that it follows from: the layers, radii and options to the last bit,
/// and the source code of the solver. So a cache never needs to be emptied.
///
/// @param cache  may be absent; `user_cache()` is the user's.
/// @throws InvalidInput, Interrupted as `transfer_profile`.
struct CachedTransferProfile {
  TransferProfile result;
  bool was_cached = false;
};
[[nodiscard]] CachedTransferProfile cached_transfer_profile(
    const std::optional<DiskCache>& cache, std::span<const LayerStack> stacks,
    const RadialGrid& radii = {}, const TransferProfileOptions& options = {});

/// `thickness_profiles`, likewise.
[[nodiscard]] ThicknessProfiles cached_thickness_profiles(const std::optional<DiskCache>& cache,
                                                          std::span<const LayerStack> half_spaces,
                                                          const ThicknessRange& range,
                                                          const RadialGrid& radii = {},
                                                          const Progress& progress = {});

}  // namespace lamina
