// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/exchange/export_format.h"

// The functions of the table of formats, one file each.

namespace lamina::detail {

[[nodiscard]] ExportedMaterial write_blender(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_gaussians(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_gltf(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_mcml(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_mcx(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_mitsuba3(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_mixture(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_openpbr(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_pbrt(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_table(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_arnold(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_renderman(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_unity_hdrp(const ExportInput& input);
[[nodiscard]] ExportedMaterial write_unreal(const ExportInput& input);

}  // namespace lamina::detail
