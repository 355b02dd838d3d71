// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>

#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina::python {

namespace py = pybind11;

/// Options of photons by the names of the arguments of Python's functions. Ranges have been
/// checked there.
[[nodiscard]] inline MonteCarloOptions photon_options(const py::dict& effort) {
  MonteCarloOptions options;
  options.photons = effort["photons"].cast<std::uint64_t>();
  options.seed = effort["seed"].cast<std::uint64_t>();
  options.relative_error = effort["relative_error"].cast<double>();
  options.seconds = effort["seconds"].cast<double>();
  return options;
}

[[nodiscard]] inline bool are_independent(const py::dict& effort) {
  return effort["independent_bands"].cast<bool>();
}

}  // namespace lamina::python
