// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/small_matrix.h"
#include "lamina/skin/acquire/inversion/texels/inversion_tables.h"
#include "lamina/skin/acquire/inversion/texels/skin_at_texel.h"

namespace lamina::detail {

/// Reflectance of uniform skin in each image of a capture, as a share of the light. One for each
/// thread.
class LocalModel {
 public:
  LocalModel(const PatchCapture& capture, const InversionTables& tables)
      : capture_(&capture),
        tables_(&tables),
        skin_(tables.numbers, tables.model.skin),
        reflectance(capture.images.size()),
        by_number(capture.images.size()) {}

  /// Fills `reflectance` and `by_number`.
  void predict(std::span<const double> coordinates);

 private:
  const PatchCapture* capture_;
  const InversionTables* tables_;
  SkinAtTexel skin_;

 public:
  std::vector<double> reflectance;      ///< [image]
  std::vector<TexelNumbers> by_number;  ///< [image], by coordinates
};

/// Data of one texel: [image] of each, weights are 1 / deviation, or 0.
struct TexelData {
  std::vector<double> measured, weight, level;  ///< level: light that arrives there
};

/// Coordinates of least squares of one texel as if its surroundings were like it, with the prior.
///
/// @param start  coordinates
[[nodiscard]] TexelNumbers fit_texel(LocalModel& model, const TexelData& data,
                                     const InversionTables& tables, std::span<const double> start,
                                     double robust_limit);

/// Covariance of the coordinates: the inverse of the matrix of second derivatives there.
[[nodiscard]] TexelMatrix texel_covariance(LocalModel& model, const TexelData& data,
                                           const InversionTables& tables,
                                           std::span<const double> coordinates,
                                           double robust_limit);

}  // namespace lamina::detail
