// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lamina {

/// The known name that a misspelled one most likely stands for. If the name is an old one
/// (renamed_names.h), that is the new one, where it is known. Otherwise the fewest insertions,
/// deletions, replacements and exchanges of neighbours turn one into the other. If every known name
/// differs in more than a third of its letters (in more than one for short names), the shortest
/// that contains the whole of the given name; absent if none does.
[[nodiscard]] std::optional<std::string_view> nearest_name(std::string_view name,
                                                           std::span<const std::string_view> known);

/// The end of an error message: `; did you mean "sigma_a"?`, or nothing if no name is near.
[[nodiscard]] std::string did_you_mean(std::string_view name,
                                       std::span<const std::string_view> known);

}  // namespace lamina
