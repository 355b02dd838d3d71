// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/estimate.h"

namespace lamina {

/// Equal steps from 0; what lies beyond the last counts in the last bin, as in MCML, so that sums
/// over all bins are totals. 0 bins: not tallied.
struct UniformBins {
  int count = 0;
  double width = 0.0;  ///< > 0 if count > 0
  friend bool operator==(const UniformBins&, const UniformBins&) = default;
};

/// Equal steps of the logarithm. What lies nearer or farther is counted beside the bins.
struct LogBins {
  int count = 0;
  double low = 0.0;   ///< > 0
  double high = 0.0;  ///< > low
  friend bool operator==(const LogBins&, const LogBins&) = default;
};

/// A direction in which next-event estimation looks: the radiance that leaves there.
struct ExitDirection {
  double theta = 0.0;     ///< from the normal of the side that the light leaves on [rad], [0, pi/2)
  double phi = 0.0;       ///< from the plane of incidence, 0 is forward [rad]
  bool is_below = false;  ///< transmitted light
  friend bool operator==(const ExitDirection&, const ExitDirection&) = default;
};

/// Light that log_r leaves out because it is known without photons: what no ground has thrown back,
/// and no rough boundary met, after at most so many reflections inside.
struct KnownLight {
  static constexpr int none = -1, all = 1'000'000;
  int unscattered = none;  ///< most reflections of what never scattered
  int once = none;         ///< and of what a layer scattered once
  friend bool operator==(const KnownLight&, const KnownLight&) = default;
};

/// Tallies besides the totals. Each costs time and memory only if asked for.
struct PhotonTallies {
  UniformBins r;   ///< [mm] R(r), T(r), and with `angles` R(r, angle), T(r, angle)
  int angles = 0;  ///< bins of equal angle over [0, pi/2]: R(angle), T(angle)
  LogBins log_r;   ///< [mm] exit radii on a logarithmic grid
  KnownLight known_above, known_below;  ///< what log_r leaves out on either side
  UniformBins depth;                    ///< [mm] with `r` the absorbed density A(r, z)
  bool fluence = false;                 ///< with `r` and `depth` the fluence phi(r, z)
  int bsdf_cosines = 0;                 ///< cells of equal solid angle: bins of equal cosine ...
  int bsdf_azimuths = 0;                ///< ... times bins of equal azimuth
  bool orders = false;      ///< R and T, their angles and BSDF cells, by scattering order
  UniformBins path_length;  ///< [mm] geometric length inside the stack, and its mean
  bool mean_path_length = false;
  UniformBins time;                 ///< [ps] time of flight inside the stack: R(t), T(t), with `r`
                                    ///< R(r, t), T(r, t), of detectors R(t); its mean, and the
                                    ///< mean path in each layer
  std::vector<double> frequencies;  ///< [MHz] of modulated light: amplitude and phase of R and T,
                                    ///< with `r` over r, and of detectors
  std::vector<double> detectors;    ///< [mm] distances r of ring detectors for R(r)
  double detector_width = 0.0;      ///< [mm] of each ring, > 0 if there are detectors
  std::vector<ExitDirection> directions;  ///< next-event estimation; smooth boundaries only
  friend bool operator==(const PhotonTallies&, const PhotonTallies&) = default;
};

/// Orders of scattering that are told apart: 0 (unscattered), 1 to 10, and the rest.
inline constexpr int photon_orders = 12;

/// Sums of modulated light per place and frequency: of the cosine, of the sine, of their product.
inline constexpr std::size_t modulation_parts = 3;

/// A sum of signed 64-bit numbers that cannot overflow: 128 bits, two's complement.
struct WideSum {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  friend bool operator==(const WideSum&, const WideSum&) = default;
};

/// Adds b to a.
void add(WideSum& a, WideSum b);

/// The number in units of 2^-scale.
[[nodiscard]] double to_double(WideSum sum, int scale);

/// Where each tally stands in the flat list of cells.
struct PhotonLayout {
  // Single cells.
  static constexpr std::size_t specular = 0;          ///< first reflection, where it is random
  static constexpr std::size_t reflected = 1;         ///< diffuse reflectance
  static constexpr std::size_t transmitted = 2;       ///< all of it
  static constexpr std::size_t unscattered_up = 3;    ///< part of `reflected` that never scattered,
                                                      ///< nor at rough boundaries
  static constexpr std::size_t unscattered_down = 4;  ///< part of `transmitted`
  static constexpr std::size_t unfinished = 5;
  static constexpr std::size_t path_up = 6;  ///< weight times path length of reflected light
  static constexpr std::size_t path_down = 7;
  static constexpr std::size_t weighted_path_up = 8;  ///< the same times the weight once more, for
                                                      ///< the error of the mean path
  static constexpr std::size_t weighted_path_down = 9;
  static constexpr std::size_t first_layer = 10;  ///< absorptance of the layers follows
  // First cell of each grid. Grids for transmission follow those for reflection at once.
  std::size_t ra = 0, ra_size = 0;          ///< [side][r][angle]
  std::size_t log_r = 0, log_r_size = 0;    ///< [side][nearer, bins, farther]
  std::size_t bsdf = 0, bsdf_size = 0;      ///< [side][order][cosine][azimuth]
  std::size_t order = 0, order_size = 0;    ///< [side][order][angle]
  std::size_t path = 0, path_size = 0;      ///< [side][bin]
  std::size_t flight = 0, flight_size = 0;  ///< [side][optical path, path in layer ...][weight
                                            ///< times it, the same times the weight once more]
  std::size_t time = 0, time_size = 0;      ///< [side][r][bin]
  std::size_t modulation = 0, modulation_size = 0;  ///< [side][r][frequency][part]
  std::size_t detector = 0;                         ///< [detector]
  std::size_t detector_time = 0;                    ///< [detector][bin]
  std::size_t detector_modulation = 0;              ///< [detector][frequency][part]
  std::size_t direction = 0;                        ///< [direction]
  std::size_t cells = 0;
  std::size_t rz = 0, rz_size = 0;  ///< volume cells: [r][depth] of absorption, fluence
  std::size_t volume_cells = 0;
};

/// @throws InvalidInput naming the grid whose cells cannot be counted, or if the sums of all cells
/// do not fit in 4 GiB.
[[nodiscard]] PhotonLayout make_photon_layout(const PhotonTallies& tallies, std::size_t layers);

/// @throws InvalidInput if the sums of a run and of the batches in flight do not fit in 4 GiB.
void check_memory(const PhotonLayout& layout, std::size_t batches);

/// Raw sums of a run or of a shard of it; add them up with `merge`, read them with `summarize`.
struct PhotonCounts {
  PhotonTallies tallies;
  std::size_t layers = 0;
  double specular = 0.0;             ///< first reflection where it is the same for all photons
  bool has_random_specular = false;  ///< it is drawn photon by photon
  double length_unit = 1.0;          ///< of the sums of paths and fluence, in (0, 1e30] [mm]
  std::string run;  ///< names stack and options: only counts of one run can be merged
  std::uint64_t photons = 0;
  std::uint64_t batches = 0;
  std::uint64_t events = 0;            ///< scatterings and boundaries met
  std::vector<WideSum> first, second;  ///< [cell] sums of each photon's part and of its square
  std::vector<WideSum> volume_first;   ///< [volume cell] sums of each batch's part,
  std::vector<WideSum> volume_second;  ///< and of its square over the photons of the batch
  bool was_stopped = false;            ///< by Ctrl-C or the clock before all photons were spent
};

/// Whether counts that come from a file can be those of a run: their tallies are in range, there is
/// a sum for each cell, and `specular` and `length_unit` are in range.
/// @throws InvalidInput naming what is not as it must be.
void check_counts(const PhotonCounts& counts);

/// The counts of two shards of one run together; exact.
/// @throws InvalidInput if they are not of one run.
[[nodiscard]] PhotonCounts merge_counts(const PhotonCounts& a, const PhotonCounts& b);

/// Reflected and transmitted light of one kind.
struct TwoSided {
  std::vector<Estimate> reflection, transmission;
};

/// Light that arrives modulated in time as exp(i omega t) leaves as amplitude exp(i (omega t -
/// phase)).
struct Modulation {
  Estimate amplitude;  ///< of what leaves, in the unit of what leaves without modulation
  Estimate phase;      ///< by which it lags, in (-pi, pi] [rad]; 0 ± pi where no light left
};

/// Modulation of reflected and transmitted light.
struct TwoSidedModulation {
  std::vector<Modulation> reflection, transmission;
};

/// Fractions of the light that arrives, densities of it, each with its standard error, for which
/// what was never seen counts as in sample_mean. Grids are empty unless asked for.
struct MonteCarloResult {
  std::uint64_t photons = 0;
  std::uint64_t events = 0;
  bool was_stopped = false;
  Estimate specular_reflectance;  ///< first reflection at the top
  Estimate diffuse_reflectance;   ///< everything else that leaves at the top
  Estimate transmittance;         ///< with the unscattered light; what a ground absorbs counts here
  Estimate unscattered_reflectance;    ///< part of diffuse_reflectance
  Estimate unscattered_transmittance;  ///< part of transmittance
  std::vector<Estimate> absorptance;   ///< [layer]
  Estimate unfinished;                 ///< of photons that met max_events

  TwoSided radial;              ///< [r] [1/mm²]
  TwoSided angular;             ///< [angle] [1/sr]
  TwoSided radial_angular;      ///< [r][angle] [1/(mm² sr)]
  TwoSided log_radial;          ///< [bin] [1/mm²]
  TwoSided log_radial_outside;  ///< [nearer, farther] fractions of the light beside the bins
  TwoSided bsdf;                ///< [cosine][azimuth] [1/sr]; unscattered light is left out, what
                                ///< rough boundaries scatter is not, at first contact too
  TwoSided bsdf_by_order;       ///< [order][cosine][azimuth] [1/sr]
  TwoSided by_order;            ///< [order] fraction of the light
  TwoSided angular_by_order;    ///< [order][angle] [1/sr]
  Estimate mean_path_reflected, mean_path_transmitted;  ///< [mm]; 0 ± 0 where no light left
  TwoSided path_length;                                 ///< [bin] [1/mm] density over path length
  Estimate mean_time_reflected, mean_time_transmitted;  ///< of flight [ps]; 0 ± 0 as above
  TwoSided mean_layer_path;              ///< [layer] mean path in each [mm], of the same light
  TwoSided time;                         ///< [bin] [1/ps]
  TwoSided radial_time;                  ///< [r][bin] [1/(mm² ps)]
  TwoSidedModulation modulation;         ///< [frequency] [1]
  TwoSidedModulation radial_modulation;  ///< [r][frequency] [1/mm²]
  std::vector<Estimate> detectors;       ///< [detector] [1/mm²]
  std::vector<Estimate> detector_time;   ///< [detector][bin] [1/(mm² ps)]
  std::vector<Modulation> detector_modulation;  ///< [detector][frequency] [1/mm²]
  std::vector<Estimate> directions;             ///< [direction] BRDF or BTDF [1/sr]
  std::vector<Estimate> absorption;             ///< [r][depth] [1/mm³]
  std::vector<Estimate> fluence;                ///< [r][depth] [1/mm²]; 0 in clear layers
};

[[nodiscard]] MonteCarloResult summarize(const PhotonCounts& counts);

}  // namespace lamina
