// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "lamina/base/core/enum_names.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/layers/optics/medium.h"

namespace lamina {

/// Definition of the color of a translucent half-space. The first reflection is all that comes
/// back without having been below the surface, also from several facets of a rough one.
enum class ColorDefinition {
  openpbr,  ///< light at 0 degrees: what leaves over what gets in; the text of [OpenPBR] 1.1.1
  normal,   ///< light at 0 degrees: what leaves over what arrives, without the first reflection
  diffuse,  ///< light from a uniform sky: the same
  furnace   ///< light from a uniform sky: all that leaves, with the first reflection
};

template <>
inline constexpr auto enum_names<ColorDefinition> =
    std::to_array<EnumName<ColorDefinition>>({{"openpbr", ColorDefinition::openpbr},
                                              {"normal", ColorDefinition::normal},
                                              {"diffuse", ColorDefinition::diffuse},
                                              {"furnace", ColorDefinition::furnace}});

/// A half-space of one medium under vacuum, all but its albedo, and which color of it is meant.
struct HalfSpaceLook {
  double ior = 1.4;    ///< in [1, 1.6]
  double g = 0.0;      ///< of Henyey-Greenstein's phase function, in [-0.3, 0.95]
  Interface top = {};  ///< of any roughness, with all light that meets several facets
  ColorDefinition definition = ColorDefinition::openpbr;
};

/// The numbers that a look may have.
inline constexpr double lowest_look_ior = 1.0, highest_look_ior = 1.6;
inline constexpr double lowest_look_g = -0.3, highest_look_g = 0.95;

/// The color of a half-space for each single-scattering albedo, and back, by radiative transfer.
///
/// Both are read from a table of solutions by adding-doubling that is part of lamina. Over a look
/// of any numbers in their ranges and colors of .01 to .99 the color that an albedo has is off by
/// less than .1 % of it (docs/albedo_inversion.md). Albedo 0 has the darkest color and albedo 1 the
/// brightest one exactly. Made in microseconds; then a color takes tenths of one.
class HalfSpaceColor {
 public:
  /// @throws InvalidInput naming the number that is out of its range.
  explicit HalfSpaceColor(const HalfSpaceLook& look);

  /// The colors that there are, from albedo 0 to 1. White is never reached by `normal` and
  /// `diffuse`, nor black by `furnace`, if the surface reflects.
  [[nodiscard]] double darkest() const { return darkest_; }
  [[nodiscard]] double brightest() const { return brightest_; }
  [[nodiscard]] bool is_reachable(double color) const {
    return darkest_ <= color && color <= brightest_;
  }

  /// @param albedo  of single scattering, in [0, 1]
  [[nodiscard]] double color(double albedo) const;

  /// The albedo that has a color. @throws InvalidInput if none has, saying which ones are reached.
  [[nodiscard]] double albedo(double color) const;

  /// Albedo of the nearest color that is reached.
  [[nodiscard]] double nearest_albedo(double color) const;

 private:
  static constexpr std::size_t pairs = 7;  // of orders

  /// q of the table and its derivative.
  struct Exponent {
    double q, slope;
  };
  [[nodiscard]] Exponent exponent(double s) const;

  double g_, darkest_ = 0.0, brightest_ = 1.0;
  double trapped_ = 0.0;  ///< of diffuse light inside, where a smooth surface would reflect it
  std::array<double, pairs> even_ = {}, odd_ = {};  ///< q by powers of x^2, and x times such
};

/// The color that adding-doubling finds, without the table.
struct SolvedColor {
  double color = 0.0;
  double estimated_error = 0.0;  ///< by two grids
};

/// A millisecond for a smooth surface, half a second for a rough one.
/// @param albedo  of single scattering, in [0, 1]
/// @throws InvalidInput as HalfSpaceColor.
[[nodiscard]] SolvedColor solve_color(const HalfSpaceLook& look, double albedo);

/// Length that is given as the radius of a medium.
enum class RadiusMeaning {
  mean_free_path,          ///< 1 / sigma_t, as OpenPBR has it
  reduced_mean_free_path,  ///< 1 / sigma_t_prime
  diffuse_mean_free_path   ///< 1 / sigma_tr, how far diffused light spreads
};

template <>
inline constexpr auto enum_names<RadiusMeaning> = std::to_array<EnumName<RadiusMeaning>>(
    {{"mean_free_path", RadiusMeaning::mean_free_path},
     {"reduced_mean_free_path", RadiusMeaning::reduced_mean_free_path},
     {"diffuse_mean_free_path", RadiusMeaning::diffuse_mean_free_path}});

/// The medium of an albedo and a radius [mm], with the index and the mean cosine of a look.
/// @throws InvalidInput if the radius is not in (0, 1e9), or a diffuse one and the albedo 1: light
///         that is never absorbed spreads without end.
[[nodiscard]] Medium medium_of(const HalfSpaceLook& look, double albedo, double radius,
                               RadiusMeaning meaning = RadiusMeaning::mean_free_path);

}  // namespace lamina
