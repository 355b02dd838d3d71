// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/internal/file_kinds.h"

#include <algorithm>
#include <array>

namespace lamina::input_detail {
namespace {

struct FileKind {
  std::string_view kind, use;
};

constexpr auto file_kinds = std::to_array<FileKind>({
    {"capture", "a capture, which lamina acquire takes"},
    {"export", "what lamina export wrote for another program"},
    {"job", "a job, which lamina submit and status take"},
    {"maps", "a recipe of maps, which lamina maps takes"},
    {"material",
     "a material, which lamina slab, profile, bsdf, photons, export and materials take"},
    {"measurement", "a measurement, which lamina fit takes"},
    {"patch", "a patch of skin, which lamina patch takes"},
    {"population", "a population of skin, which measurements and lamina edit take"},
    {"reproduction", "a figure to reproduce, which lamina reproduce takes"},
    {"scene", "a scene, which lamina render and info take"},
});

}  // namespace

std::string use_of_kind(std::string_view kind) {
  const auto found = std::ranges::find(file_kinds, kind, &FileKind::kind);
  return found == file_kinds.end() ? "" : ": " + std::string(found->use);
}

}  // namespace lamina::input_detail
