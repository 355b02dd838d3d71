// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/core/shard.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// Where on the surface light arrives; its direction is the Incidence. All beams are centred on the
/// axis r = 0 and carry unit flux.
struct Beam {
  enum class Shape {
    pencil,    ///< one point
    gaussian,  ///< irradiance falls as exp(-2 r^2 / radius^2)
    flat       ///< equal irradiance out to the radius
  };
  Shape shape = Shape::pencil;
  double radius = 0.0;  ///< [mm], > 0 unless a pencil
};

template <>
inline constexpr auto enum_names<Beam::Shape> =
    std::to_array<EnumName<Beam::Shape>>({{"pencil", Beam::Shape::pencil},
                                          {"gaussian", Beam::Shape::gaussian},
                                          {"flat", Beam::Shape::flat}});

struct MonteCarloOptions {
  std::uint64_t photons = 1'000'000;  ///< of the whole run, all shards together; in [1, 1e15]
  std::uint64_t seed = 0;
  Incidence incidence;
  Beam beam;
  PhotonTallies tallies;

  /// If > 0, stops as soon as the standard errors of diffuse reflectance and of transmittance are
  /// below this fraction of their values (what is below 1e-4 by two standard errors is not waited
  /// for), and `photons` is the most that are spent. Looked at when the number of photons has
  /// doubled.
  double relative_error = 0.0;

  /// If > 0, stops after this wall-clock time. What is then finished depends on the machine.
  double seconds = 0.0;

  Shard shard;  ///< of the batches of photons: those whose number is its index modulo its count

  /// A photon that has met so many scatterers and boundaries is given up and counted as unfinished.
  std::uint32_t max_events = 500'000;

  /// Photons of less weight play Russian roulette: they die or go on with twice that weight. The
  /// default is where error times computing time is least; MCML's is 1e-4. In (0, 0.5].
  double roulette_weight = 0.1;

  /// Whether light enters as in MCML: the first layer that interacts with the deterministic
  /// transmittance of a clear first layer, whose interreflections then count as specular. Needs
  /// normal incidence and smooth boundaries.
  bool clear_top_is_specular = false;

  Progress progress;  ///< asked after every batch; may stop the run, which keeps what it has

  /// If not empty: is given, about every half minute and when the run is stopped, counts that
  /// continue_photons goes on from.
  std::function<void(const PhotonCounts&)> keep;
};

/// Follows photons through a stack of layers.
///
/// The result depends on the stack and the options alone, not on the number of threads; with equal
/// options the counts of all shards add up to those of the single run, bit for bit. Photons travel
/// in single precision on SIMD lanes (AVX-512, AVX2, SSE4, ... as the machine has), their sums are
/// kept in 128-bit fixed point.
///
/// Each photon loses the fraction 1 - albedo of its weight at every event and meets Russian
/// roulette at low weight; at a boundary it is reflected or refracted as a whole, with Fresnel's
/// probability. The estimates are unbiased.
///
/// Source: [HanrahanKrueger1993] Figure 7, [Wang1995].
/// @throws InvalidInput if an option is out of range, or if the grids would not fit in memory.
[[nodiscard]] PhotonCounts count_photons(const LayerStack& stack, const MonteCarloOptions& options);

/// Goes on from the counts of a run with equal options that was stopped. The end is bit for bit
/// that of a run that was not.
/// @throws InvalidInput also if the counts are of another run, or of more batches than this one
/// has.
[[nodiscard]] PhotonCounts continue_photons(const LayerStack& stack,
                                            const MonteCarloOptions& options, PhotonCounts counts);

/// Fractions with standard errors, from the counts of count_photons.
[[nodiscard]] MonteCarloResult trace_photons(const LayerStack& stack,
                                             const MonteCarloOptions& options);

/// The SIMD instruction sets that trace_photons can use on this machine, best first, such as
/// "AVX3".
[[nodiscard]] std::vector<const char*> photon_targets();

}  // namespace lamina
