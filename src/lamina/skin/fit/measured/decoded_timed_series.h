// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "lamina/skin/fit/measured/decoded_series.h"

namespace lamina::fit_detail {

/// Whether a kind is over time, or over the frequency of modulation.
[[nodiscard]] bool is_timed(MeasurementKind kind);

/// Whether only entries of such kinds have a column.
[[nodiscard]] bool is_timed_column(std::string_view column);

/// Number of unknown factors of a series in all its bands.
[[nodiscard]] std::size_t count_unknown_factors(const MeasuredSeries& series);

/// An entry of such a kind. @throws InvalidInput naming file, line and field, or column.
[[nodiscard]] DecodedSeries decode_timed_series(const JsonInput& value, MeasurementKind kind);

}  // namespace lamina::fit_detail
