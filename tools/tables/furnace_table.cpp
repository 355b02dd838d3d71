// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints docs/rough_surfaces.md's white furnace of the rough dielectric with all orders of
// scattering: the light that evaluation returns for a unit flux, from four angles and their mean,
// whose standard error is about the one asked for.
//
//   furnace_table [STANDARD_ERROR] > table.md
#include <array>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "layers/optics/facet_furnace.h"

int main(int argc, char** argv) {
  using namespace lamina;
  const double wanted = argc > 1 ? std::atof(argv[1]) : 4e-4;
  if (!(wanted > 0.0)) {
    std::fprintf(stderr, "furnace_table: STANDARD_ERROR must be > 0, but is %s\n", argv[1]);
    return 2;
  }
  constexpr std::array<double, 4> thetas = {0.0, 30.0, 60.0, 85.0};
  std::printf("| s | eta |");
  for (const double theta : thetas) std::printf(" %g° |", theta);
  std::printf(" mean |\n|---|---|---|---|---|---|---|\n");
  double chi_square = 0.0;
  std::uint64_t stream = 0;
  for (const double s : {0.5, 1.0, 2.0, 3.0, 6.0, 10.0})
    for (const double eta : {1.4, 1.0 / 1.4}) {
      std::printf("| %g | %.3g |", s, eta);
      double mean = 0.0, variance = 0.0;
      for (const double theta : thetas) {
        const double t = theta * std::numbers::pi / 180.0;
        const Vec3 wi{std::sin(t), 0.0, std::cos(t)};
        const RoughInterface<double> interface { {.alpha = 2.0 / s}, eta };
        Random random = make_random(1, ++stream);
        // A first run says how many walks it takes.
        const FacetFurnace first = facet_furnace(interface, wi, 20'000, random);
        const double ratio = first.higher.standard_error / (2.0 * wanted);
        const int walks = static_cast<int>(20'000 * std::max(1.0, 1.1 * ratio * ratio));
        const FacetFurnace furnace = facet_furnace(interface, wi, walks, random);
        const double error = furnace.higher.standard_error;
        std::printf(" %.5f ± %.5f |", furnace.total(), error);
        std::fflush(stdout);
        mean += furnace.total() / 4.0;
        variance += error * error / 16.0;
        const double deviation = (furnace.total() - 1.0) / std::hypot(error, 1e-4);
        chi_square += deviation * deviation;
      }
      std::printf(" %.5f ± %.5f |\n", mean, std::sqrt(variance));
    }
  std::printf("\nchi-square %.1f over %d numbers\n", chi_square, static_cast<int>(stream));
}
