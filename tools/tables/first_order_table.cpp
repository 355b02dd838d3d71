// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints docs/layered_bsdf.md's table of the first order: light scattered once by photon Monte
// Carlo against the closed forms, in cells of direction and as flux, in standard errors.
//
//   first_order_table [PHOTONS] > table.md
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "literal/first_order_cases.h"

int main(int argc, char** argv) {
  using namespace lamina;
  const std::uint64_t photons = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000'000;
  std::printf("Photons: %llu per case, seed 5; 12 cosines by 8 azimuths on each side.\n\n",
              static_cast<unsigned long long>(photons));
  std::puts(
      "| case | cells | mean error of a cell | worst cell [s.e.] | flux [s.e.] | χ² / cells |");
  std::puts("|---|---|---|---|---|---|");
  double chi2 = 0.0;
  int cells = 0;
  for (const auto& one : reference::first_order_cases()) {
    const auto found = reference::compare_first_order(one, photons, 12, 8);
    std::printf("| %s | %d | %.2g | %.1f | %.1f | %.2f |\n", one.name.c_str(), found.cells,
                found.relative_error, found.worst, found.worst_flux, found.chi2 / found.cells);
    std::fflush(stdout);
    chi2 += found.chi2;
    cells += found.cells;
  }
  std::printf("\nχ² over all: %.1f over %d cells, expected %d ± %.0f.\n", chi2, cells, cells,
              std::sqrt(2.0 * cells));
}
