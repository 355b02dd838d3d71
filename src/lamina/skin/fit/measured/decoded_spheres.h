// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "lamina/base/io/json_input.h"
#include "lamina/skin/fit/measured/measured_table.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina::fit_detail {

/// The keys of an entry of totals that decode_spheres reads.
inline constexpr std::array<std::string_view, 3> sphere_keys = {
    "reflectance_sphere", "transmittance_sphere", "beam_diameter_mm"};

/// Gives the points of an entry their spheres, and the entry its beam.
///
/// @param series  with all points, whose bands are their rows
/// @throws InvalidInput naming file, line and field.
void decode_spheres(const JsonObject& entry, std::size_t rows, MeasuredSeries& series);

/// The keys of an entry that say of a file of iad what is not in it.
inline constexpr std::array<std::string_view, 2> iad_keys = {"method", "baffle"};

/// Takes the spheres and the beam of a series from a file of iad.
void take_iad_spheres(const JsonObject& entry, const MeasuredTable& table, MeasuredSeries& series);

}  // namespace lamina::fit_detail
