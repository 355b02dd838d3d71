// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "lamina/solve/integrating_sphere/integrating_sphere.h"

namespace lamina::fit_detail {

/// A data file of Prahl's program iad (.rxt): how was measured, and a table of it.
struct IadFile {
  int spheres = 0;                 ///< 0: the readings are totals; 1: of one sphere at a time
  double beam_diameter = 0.0;      ///< [mm]
  IntegratingSphere above, below;  ///< method and baffle are not in the file
  /// Table as CSV with the line numbers of the file: wavelength_nm if it has some, reflectance,
  /// transmittance, unscattered_transmittance, and for each row that has its own r_w, t_w, r_std.
  std::string table;
};

/// Reads one. M_R = r_std (R - R_0) / (R_std - R_0) and M_T = (T - T_dark) / (T_0 - T_dark) are
/// what reflectance_reading and transmittance_reading predict.
///
/// @param name  of the file, for messages
/// @throws InvalidInput naming file and line; for two spheres at once, which are not modelled, and
///         for a number that is 0, which iad takes for one that was not measured, among others that
///         were.
///
/// Source: [Prahl2011], "The data file".
[[nodiscard]] IadFile read_iad_file(std::string_view text, const std::string& name);

}  // namespace lamina::fit_detail
