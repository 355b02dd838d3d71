// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/half_space_color.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/solve/albedo_inversion/internal/color_table.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

void require_range(const char* name, double value, double low, double high) {
  if (!(low <= value && value <= high))
    throw InvalidInput(std::string(name) + ": must be in [" + number_text(low) + ", " +
                       number_text(high) + "], but is " + number_text(value));
}

void check(const HalfSpaceLook& look) {
  require_range("ior", look.ior, lowest_look_ior, highest_look_ior);
  require_range("g", look.g, lowest_look_g, highest_look_g);
  require_range("roughness", look.top.roughness, 0.0, 1.0);
}

bool is_in_diffuse_light(ColorDefinition definition) {
  return definition == ColorDefinition::diffuse || definition == ColorDefinition::furnace;
}

using Orders = std::array<double, detail::s_orders>;

/// Powers of x in Chebyshev polynomials, [order][power].
constexpr std::array<Orders, detail::s_orders> chebyshev_powers() {
  std::array<Orders, detail::s_orders> powers = {};
  powers[0][0] = powers[1][1] = 1.0;
  for (std::size_t n = 2; n < powers.size(); ++n)  // T_n = 2 x T_(n-1) - T_(n-2)
    for (std::size_t k = 0; k <= n; ++k)
      powers[n][k] = (k > 0 ? 2.0 * powers[n - 1][k - 1] : 0.0) - powers[n - 2][k];
  return powers;
}

/// A sum of Chebyshev polynomials by powers of x. They are few enough that no digits are lost.
Orders in_powers(const Orders& chebyshev) {
  constexpr std::array<Orders, detail::s_orders> powers = chebyshev_powers();
  Orders sum = {};
  for (std::size_t n = 0; n < chebyshev.size(); ++n)
    for (std::size_t k = n % 2; k <= n; k += 2) sum[k] += chebyshev[n] * powers[n][k];
  return sum;
}

/// Four digits, rounded into the range of colors.
std::string limit_text(double limit, bool is_high) {
  const double digits = 1e4;
  return number_text((is_high ? std::floor(limit * digits) : std::ceil(limit * digits)) / digits);
}

}  // namespace

HalfSpaceColor::HalfSpaceColor(const HalfSpaceLook& look) : g_(look.g) {
  check(look);
  const bool is_diffuse = is_in_diffuse_light(look.definition);
  const detail::ColorCoefficients found =
      detail::color_coefficients(look.ior, look.g, look.top, is_diffuse);
  const auto powers = in_powers(found.q);
  static_assert(2 * pairs == powers.size());
  for (std::size_t k = 0; k < powers.size(); ++k) (k % 2 == 0 ? even_ : odd_)[k / 2] = powers[k];
  trapped_ = fresnel_diffuse(1.0 / look.ior);
  const bool is_smooth = is_specular(make_rough_interface<double>(look.top, 1.0, look.ior));
  const double mirrored = is_diffuse ? fresnel_diffuse(look.ior) : fresnel(1.0, look.ior);
  const double first_reflection = is_smooth ? mirrored : std::max(found.first_reflection, 0.0);
  if (look.definition == ColorDefinition::furnace) darkest_ = first_reflection;
  if (look.definition == ColorDefinition::normal || look.definition == ColorDefinition::diffuse)
    brightest_ = 1.0 - first_reflection;
}

HalfSpaceColor::Exponent HalfSpaceColor::exponent(double s) const {
  const double x = detail::s_coordinate(s), x2 = x * x;
  double even = 0.0, odd = 0.0, even_slope = 0.0, odd_slope = 0.0;  // over x2
  for (std::size_t k = pairs; k-- > 0;) {
    even_slope = even_slope * x2 + even;
    odd_slope = odd_slope * x2 + odd;
    even = even * x2 + even_[k];
    odd = odd * x2 + odd_[k];
  }
  return {even + x * odd, 2.0 * (2.0 * x * even_slope + odd + 2.0 * x2 * odd_slope)};
}

double HalfSpaceColor::color(double albedo) const {
  assert(0.0 <= albedo && albedo <= 1.0);
  const double s = std::sqrt((1.0 - albedo) / (1.0 - albedo * g_));
  return darkest_ + (brightest_ - darkest_) * (1.0 - s) * std::exp(s * exponent(s).q);
}

double HalfSpaceColor::albedo(double color) const {
  if (!is_reachable(color))
    throw InvalidInput("must be in [" + limit_text(darkest_, false) + ", " +
                       limit_text(brightest_, true) +
                       "], which is all that this surface reaches, but is " + number_text(color));
  return nearest_albedo(color);
}

double HalfSpaceColor::nearest_albedo(double color) const {
  const double share = (color - darkest_) / (brightest_ - darkest_);
  if (!(share > 0.0)) return 0.0;
  if (share >= 1.0) return 1.0;
  // [VanDeHulst1980]'s fit, of what would leave if the surface let it, is near enough for Newton's
  // steps on the logarithm; a bracket holds them.
  const double inside = share / (1.0 - trapped_ + trapped_ * share);
  const double wanted = std::log(share);
  double s =
      4.09712 + 4.20863 * inside - std::sqrt(9.59217 + inside * (41.6808 + inside * 17.7126));
  double bright = 0.0, dark = 1.0;
  s = std::clamp(s, 1e-9, 1.0 - 1e-9);
  for (int step = 0; step < 60; ++step) {
    const auto [q, slope] = exponent(s);
    const double excess = std::log(1.0 - s) + s * q - wanted;
    (excess > 0.0 ? bright : dark) = s;
    const double newton = s - excess / (q + s * slope - 1.0 / (1.0 - s));
    const double next = bright < newton && newton < dark ? newton : 0.5 * (bright + dark);
    const bool is_near = std::abs(next - s) < 1e-6 * (1.0 - s);  // what is left is its square
    s = next;
    if (is_near) break;
  }
  return (1.0 - s * s) / (1.0 - g_ * s * s);
}

namespace {

/// On one grid of directions.
double color_on_grid(const HalfSpaceLook& look, double albedo, int nodes) {
  const LayerStack stack(
      {{.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = look.g, .ior = look.ior},
        .top = look.top}},
      1.0, look.ior);
  const SlabTotals totals =
      adding_doubling_on_grid(stack, {.is_diffuse = is_in_diffuse_light(look.definition)}, nodes)
          .totals;
  switch (look.definition) {
    case ColorDefinition::openpbr:
      return totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
    case ColorDefinition::furnace:
      return totals.diffuse_reflectance + totals.specular_reflectance;
    case ColorDefinition::normal:
    case ColorDefinition::diffuse:
      break;
  }
  return totals.diffuse_reflectance;
}

/// The same; where grids do not resolve how little rough surfaces refract, the difference that
/// roughness makes is in proportion to ior - 1, and taken from an index that they do resolve.
double bridged_color(const HalfSpaceLook& look, double albedo, int nodes) {
  const double resolved = 1.0 + 0.006 * look.top.roughness;
  if (look.ior == 1.0 || look.ior >= resolved) return color_on_grid(look, albedo, nodes);
  HalfSpaceLook smooth = look, rough_there = look, smooth_there = look;
  smooth.top.roughness = smooth_there.top.roughness = 0.0;
  rough_there.ior = smooth_there.ior = resolved;
  return color_on_grid(smooth, albedo, nodes) + (look.ior - 1.0) / (resolved - 1.0) *
                                                    (color_on_grid(rough_there, albedo, nodes) -
                                                     color_on_grid(smooth_there, albedo, nodes));
}

}  // namespace

SolvedColor solve_color(const HalfSpaceLook& look, double albedo) {
  check(look);
  require_range("albedo", albedo, 0.0, 1.0);
  const double coarse = bridged_color(look, albedo, 40), fine = bridged_color(look, albedo, 56);
  return {fine, std::abs(fine - coarse)};
}

Medium medium_of(const HalfSpaceLook& look, double albedo, double radius, RadiusMeaning meaning) {
  assert(0.0 <= albedo && albedo <= 1.0);
  if (!(0.0 < radius && radius < 1e9))
    throw InvalidInput("radius: must be in (0, 1e9) mm, but is " + number_text(radius));
  double paths = 1.0;  // the radius in mean free paths
  if (meaning == RadiusMeaning::reduced_mean_free_path) paths = 1.0 / (1.0 - albedo * look.g);
  if (meaning == RadiusMeaning::diffuse_mean_free_path) {
    if (albedo == 1.0)
      throw InvalidInput(
          "radius: must not be a diffuse mean free path where the color is the brightest one, "
          "whose light is never absorbed and spreads without end");
    paths = 1.0 / std::sqrt(3.0 * (1.0 - albedo) * (1.0 - albedo * look.g));
  }
  const double sigma_t = paths / radius;
  return {.sigma_a = (1.0 - albedo) * sigma_t,
          .sigma_s = albedo * sigma_t,
          .g = look.g,
          .ior = look.ior};
}

}  // namespace lamina
