// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lamina::input_detail {

/// The commands that take a kind of lamina's files, as messages end about a file that is given to
/// another one: `: a material, which lamina slab, ... take`; empty for a kind that there is not.
[[nodiscard]] std::string use_of_kind(std::string_view kind);

}  // namespace lamina::input_detail
