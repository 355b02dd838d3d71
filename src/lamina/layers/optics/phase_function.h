// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>
#include <vector>

namespace lamina {

/// Scattering with a given mean cosine. Source: [HenyeyGreenstein1941] Eq. 2.
struct HenyeyGreenstein {
  double g = 0.0;  ///< mean cosine, in (-1, 1); 0 is isotropic
  friend bool operator==(const HenyeyGreenstein&, const HenyeyGreenstein&) = default;
};

/// Scattering by particles much smaller than the wavelength. Source: [Chandrasekhar1960] §3,
/// Eq. 29.
struct Rayleigh {
  friend bool operator==(const Rayleigh&, const Rayleigh&) = default;
};

/// Several kinds of particles in one medium; each weight is the kind's share of sigma_s.
struct PhaseMixture {
  struct Lobe {
    double weight = 1.0;  ///< > 0; the weights of a mixture sum to 1
    std::variant<HenyeyGreenstein, Rayleigh> phase;
    friend bool operator==(const Lobe&, const Lobe&) = default;
  };
  std::vector<Lobe> lobes;  ///< at least one
  friend bool operator==(const PhaseMixture&, const PhaseMixture&) = default;
};

/// All phase functions that the solvers know.
using PhaseFunction = std::variant<HenyeyGreenstein, Rayleigh, PhaseMixture>;

/// Density over the sphere of directions [1/sr] at the cosine of the scattering angle in [-1, 1];
/// 1 is straight on. Integrates to 1.
[[nodiscard]] double evaluate(const PhaseFunction& phase, double cos_theta);

/// Mean cosine of the scattering angle.
[[nodiscard]] double mean_cosine(const PhaseFunction& phase);

/// Mean of the Legendre polynomial P_l over the scattering angle; l >= 0. For Henyey-Greenstein
/// g^l.
[[nodiscard]] double legendre_moment(const PhaseFunction& phase, int l);

/// Cosine of a scattering angle drawn from the phase function.
///
/// @param u1, u2  uniform in [0, 1); u2 chooses between the lobes of a mixture.
[[nodiscard]] double sample_cos_theta(const PhaseFunction& phase, double u1, double u2);

}  // namespace lamina
