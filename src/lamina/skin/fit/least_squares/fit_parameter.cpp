// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/fit_parameter.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

constexpr double least_logit_share = 1e-6;

}  // namespace

double fit_coordinate(const FitParameter& parameter, double value) {
  switch (parameter.scale) {
    case FitScale::logarithmic:
      return std::log(value + parameter.offset);
    case FitScale::logit: {
      const double share = std::clamp((value - parameter.low) / (parameter.high - parameter.low),
                                      least_logit_share, 1.0 - least_logit_share);
      return std::log(share / (1.0 - share));
    }
    case FitScale::linear:
      break;
  }
  return value;
}

double fit_value(const FitParameter& parameter, double coordinate) {
  switch (parameter.scale) {
    case FitScale::logarithmic:
      return std::clamp(std::exp(coordinate) - parameter.offset, parameter.low, parameter.high);
    case FitScale::logit:
      return parameter.low + (parameter.high - parameter.low) / (1.0 + std::exp(-coordinate));
    case FitScale::linear:
      break;
  }
  return coordinate;
}

double fit_value_derivative(const FitParameter& parameter, double coordinate) {
  switch (parameter.scale) {
    case FitScale::logarithmic:
      return std::exp(coordinate);
    case FitScale::logit: {
      const double share = 1.0 / (1.0 + std::exp(-coordinate));
      return (parameter.high - parameter.low) * share * (1.0 - share);
    }
    case FitScale::linear:
      break;
  }
  return 1.0;
}

void check_fit_parameter(const FitParameter& parameter) {
  const auto require = [&](bool holds, const std::string& rule, double given) {
    if (!holds) throw InvalidInput(parameter.name + ": " + rule + ", but is " + number_text(given));
  };
  const auto& [name, start, low, high, scale, prior, offset] = parameter;
  require(low < high, "low must be less than high, " + number_text(high), low);
  if (scale == FitScale::logarithmic)
    require(low + offset > 0.0,
            offset == 0.0 ? "low must be > 0 on a logarithmic scale" : "low must be > -offset",
            low);
  require(std::isfinite(offset) && offset >= 0.0, "offset must be >= 0", offset);
  if (scale == FitScale::logit) {
    require(std::isfinite(low), "low must be finite on a logit scale", low);
    require(std::isfinite(high), "high must be finite on a logit scale", high);
  }
  const std::string range = "must lie in [" + number_text(low) + ", " + number_text(high) + "]";
  require(std::isfinite(start) && low <= start && start <= high, "start " + range, start);
  if (!prior) return;
  require(std::isfinite(prior->mean) && low <= prior->mean && prior->mean <= high,
          "mean of the prior " + range, prior->mean);
  require(std::isfinite(prior->standard_deviation) && prior->standard_deviation > 0.0,
          "standard deviation of the prior must be > 0", prior->standard_deviation);
}

}  // namespace lamina
