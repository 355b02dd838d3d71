// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace lamina {

/// No profile is handed to users that may be wrong by over a fifth on average.
///
/// @param mean_errors  [band], estimated, relative, weighted by flux.
/// @param way_out      what takes such a stack, as in "lamina photons".
/// @throws InvalidInput naming the band, its error and the way out.
void refuse_doubtful(std::span<const double> mean_errors, const std::string& way_out);

}  // namespace lamina
