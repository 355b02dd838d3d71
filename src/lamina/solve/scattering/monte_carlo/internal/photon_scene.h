// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_exit_view.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina::photon {

/// Stack and light as the kernel needs them: flat tables in single precision.
struct Scene {
  // [layer]
  std::vector<float> mfp;        ///< mean free path [mm]; clear layers: 1e30
  std::vector<float> thickness;  ///< [mm]
  std::vector<float> albedo;
  std::vector<float> g;
  std::vector<float> top;  ///< depth of the upper boundary [mm]
  std::vector<float> ior;
  // [2 * layer + is_down]: the boundary that light in a layer meets
  std::vector<float> eta;  ///< index here over index beyond
  std::vector<std::int32_t> is_rough;
  std::vector<Interface> interfaces;  ///< [boundary] layer i's upper boundary is i
  std::vector<float> ior_sides;  ///< [boundary + is_below]: index above boundary i, below it i+1
  int layers = 0;

  // Phase functions that are not one Henyey-Greenstein lobe: [layer * lobes + lobe]
  int lobes = 0;                ///< 0: all layers are Henyey-Greenstein
  std::vector<float> lobe_end;  ///< cumulative fraction, the last is 2
  std::vector<float> lobe_g;    ///< 2 stands for Rayleigh
  bool has_rough = false;
  float ground = 0.0f;  ///< reflectance of a Lambertian ground

  // Light.
  Incidence incidence;
  Beam beam;
  bool enters_at_random = false;  ///< diffuse light or rough top: each photon meets the surface
  float x = 0.0f, ux = 0.0f, uz = 1.0f, z = 0.0f;  ///< inside, if it does not
  float weight = 1.0f;
  int first_layer = 0;
  double specular = 0.0;

  std::vector<ExitView> views;  ///< [direction] for next-event estimation

  std::uint64_t seed = 0;    ///< hashed
  double length_unit = 1.0;  ///< longest finite mean free path, or the thickness if less [mm]
  std::uint32_t max_events = 0;
  float roulette_weight = 0.1f;
};

/// @throws InvalidInput if the options do not fit the stack.
[[nodiscard]] Scene make_scene(const LayerStack& stack, const MonteCarloOptions& options);

/// Sums of one batch of photons, in fixed point.
struct BatchSums {
  struct Cell {
    std::int64_t first = 0;   ///< sum of parts, in units of 2^-cell_scale
    std::int64_t second = 0;  ///< sum of their squares
  };
  std::vector<Cell> cells;
  std::vector<std::int64_t> volume;  ///< in units of 2^-volume_scale
  std::uint64_t events = 0;
};

inline constexpr int cell_scale = 40;
inline constexpr int volume_scale = 44;
inline constexpr int volume_square_scale = 60;
inline constexpr std::uint64_t largest_batch = 1u << 17;  ///< sums then stay below 2^62

/// Tallies as the kernel needs them.
struct TallyPlan {
  PhotonLayout layout;
  PhotonTallies tallies;
  float inverse_dr = 0.0f, inverse_dz = 0.0f, inverse_da = 0.0f, inverse_dl = 0.0f;
  float log_low = 0.0f, inverse_dlog = 0.0f;
  float inverse_dt = 0.0f;
  bool needs_path = false;
  bool needs_flight = false;       ///< photons know their path in each layer
  bool needs_reflections = false;  ///< photons count them
  bool has_rare_exits = false;     ///< tallies of exits besides r and angle
  float path_unit = 1.0f;          ///< paths are counted in 65536 units of length [1/mm]
  float fluence_unit = 1.0f;  ///< fixed point of the fluence, which keeps its sums small [1/mm]
};

/// Where the path of a layer, or of the optical path in place of one, is summed up.
[[nodiscard]] inline std::size_t flight_cell(const PhotonLayout& layout, std::size_t side,
                                             std::size_t path) {
  return layout.flight + side * layout.flight_size + 2 * path;
}

/// Radiance in exit directions is counted in units of 2^direction_scale, as it may be large.
inline constexpr int direction_scale = 6;
inline constexpr int path_scale = 16;
inline constexpr int fluence_scale = 30;

/// @param length_unit  of the sums of paths and fluence [mm]: that of the Scene.
[[nodiscard]] TallyPlan make_tally_plan(const PhotonTallies& tallies, std::size_t layers,
                                        double length_unit);

/// @throws InvalidInput naming the tally that makes no sense.
void check_tallies(const PhotonTallies& tallies);

/// Follows the photons [first, first + count), count <= largest_batch, with the best instruction
/// set of this machine. Adds to `sums`, whose sizes are those of the layout.
void trace_batch(const Scene& scene, const TallyPlan& plan, std::uint64_t first,
                 std::uint64_t count, BatchSums& sums);

}  // namespace lamina::photon
