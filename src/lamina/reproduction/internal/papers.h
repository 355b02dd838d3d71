// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace lamina::detail {

struct Paper {
  std::string_view name, title, subject;
};

/// By year.
inline constexpr std::array<Paper, 5> papers = {{
    {"hanrahan_krueger_1993", "Hanrahan & Krueger 1993", "Reflection from layered surfaces"},
    {"xu_sun_2008", "Xu & Sun 2008", "Transmission through rough surfaces"},
    {"hery_2003", "Hery 2003", "A BSSRDF in production"},
    {"donner_jensen_2005", "Donner & Jensen 2005", "Multipoles and layers"},
    {"donner_2008", "Donner et al. 2008", "Heterogeneous skin"},
}};

}  // namespace lamina::detail
