// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {

/// One run of an MCML input file, in MCML's units: cm and 1/cm.
struct McmlRun {
  struct Layer {
    double n = 1.0;    ///< refractive index
    double mua = 0.0;  ///< absorption coefficient [1/cm]
    double mus = 0.0;  ///< scattering coefficient [1/cm]
    double g = 0.0;    ///< in (-1, 1], where 1 does not turn light; MCML itself refuses g < 0
    double d = 0.0;    ///< thickness [cm]; 1e7 and more at the bottom means without end
  };
  std::string output_file;
  std::uint64_t photons = 0;
  double dz = 0.0, dr = 0.0;   ///< bin widths [cm]
  int nz = 0, nr = 0, na = 0;  ///< numbers of bins
  double n_above = 1.0;
  std::vector<Layer> layers;
  double n_below = 1.0;
  int line = 0;  ///< on which the run starts
};

/// Reads the text of an MCML 1.x input file (.mci): the version, the number of runs, the runs. A
/// `#` starts a comment; words after the numbers of a line and all after the last run are passed
/// over, as MCML does. The format of an output file may be missing, lines may end as on old Macs.
///
/// @param name  the file, as messages name it.
/// @throws InvalidInput `FILE:LINE: FIELD must ..., but is ...`.
///
/// Source: [Wang1995] §5.1.
[[nodiscard]] std::vector<McmlRun> parse_mcml(std::string_view text, const std::string& name);

/// @throws FileError if the file cannot be read; InvalidInput as parse_mcml.
[[nodiscard]] std::vector<McmlRun> load_mcml(const std::filesystem::path& file,
                                             MemoryBudget memory = {});

/// The layers of a run, in mm.
[[nodiscard]] LayerStack layer_stack(const McmlRun& run);

/// Options to count as MCML does: its photons, its grids, its specular reflectance of a clear first
/// layer.
[[nodiscard]] MonteCarloOptions monte_carlo_options(const McmlRun& run);

}  // namespace lamina
