// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lamina {

/// A number that was measured by random sampling.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;  ///< of the value, one standard deviation
};

}  // namespace lamina
