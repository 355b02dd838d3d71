// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/plot/html_page.h"
#include "lamina/skin/fit/measurement_fit.h"

// Tables of the page of a fit, as HTML.

namespace lamina::cli {

using HtmlColumns = std::vector<HtmlColumn>;
using HtmlRows = std::vector<std::vector<std::string>>;  ///< [row][column] HTML

/// A path in a file, as such.
[[nodiscard]] std::string path_html(std::string_view path);

/// A value with its errors above and below, or a word on why it has none.
[[nodiscard]] std::string value_html(const FittedParameter& fitted);

/// The numbers that were found.
[[nodiscard]] std::string found_html(const Measurement& measurement, const MeasurementFit& fit);

/// Tables of the measured values, and how they were measured.
[[nodiscard]] std::string measured_html(const Measurement& measurement, const MeasurementFit& fit);

/// Tables of free and fixed parameters, and of the layers that were found.
[[nodiscard]] std::string assumed_html(const Measurement& measurement, const MeasurementFit& fit);

/// Every measured number beside what the fit predicts.
[[nodiscard]] std::string points_html(const Measurement& measurement, const MeasurementFit& fit);

}  // namespace lamina::cli
