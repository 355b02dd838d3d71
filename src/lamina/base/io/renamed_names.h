// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace lamina {

/// A name that a file or an option had, and the one that it has now.
struct RenamedName {
  std::string_view before, now;
};

/// Keys, values, methods and options (with their dashes), in alphabetical order. One name may have
/// become several: `nearest_name` takes the first that is known where it was used.
inline constexpr auto renamed_names = std::to_array<RenamedName>({
    {"adding_doubling", "radiative_transfer"},
    {"exact", "radiative_transfer"},
    {"exact_profile", "radiative_transfer_profile"},
    {"exact_profile", "radiative_transfer"},
    {"kept", "energy_threshold"},
    {"multipole", "diffusion"},
    {"profile", "probe"},
    {"terms", "interlayer_bounces"},
});

}  // namespace lamina
