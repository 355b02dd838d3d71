// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/solve/scattering/monte_carlo/mcml_input.h"
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"

namespace lamina {

/// A result as the text of an MCML 1.x output file (.mco): the same sections, comments, order,
/// units (cm) and number formats, so that what reads MCML's files reads it.
///
/// @param run      as it was read.
/// @param result   of tracing layer_stack(run) with monte_carlo_options(run).
/// @param seconds  computing time, for the comment that states it.
///
/// Rd_ra and Tt_ra divide by the solid angle times the cosine in its middle, as MCML does; the
/// fields of MonteCarloResult by their exact integral.
///
/// Source: [Wang1995] §5.2.
[[nodiscard]] std::string format_mcml(const McmlRun& run, const MonteCarloResult& result,
                                      double seconds);

}  // namespace lamina
