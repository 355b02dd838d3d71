// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/reflectance/skin_reflectance_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/absorbing_sheet.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina {
namespace {

// Points along each coordinate, for one wavelength and for any.
constexpr ChebyshevTable::Counts band_counts = {14, 9, 11}, all_counts = {24, 11, 13};
constexpr int mean_cosines = 3;
constexpr int grid_nodes = 10;  // of the first segment: totals to 2e-4 of themselves
constexpr double least_wavelength = 350.0, largest_wavelength = 1000.0;  // [nm] of skin_spectrum
constexpr double least_scattering = 1e-3;                                // epidermis sigma_s' d

// Coordinates in which the logarithm of the reflectance is nearly a polynomial: absorption of a
// slab counts linearly while it is little and by its logarithm where it is much; that of a
// half-space by its square root.
constexpr double slab_scale = 0.1, half_space_scale = 0.15;
std::array<double, 3> coordinates(const std::array<double, 3>& place) {
  return {std::log(place[0] + slab_scale), std::log(place[1]),
          std::log(std::sqrt(place[2]) + half_space_scale)};
}
/// The place at coordinates.
std::array<double, 3> place_at(const std::array<double, 3>& coordinate) {
  const double root = std::max(0.0, std::exp(coordinate[2]) - half_space_scale);
  return {std::max(0.0, std::exp(coordinate[0]) - slab_scale), std::exp(coordinate[1]),
          root * root};
}
/// Derivatives of coordinates by place. That of the third is infinite without absorption; there it
/// is taken at a little.
std::array<double, 3> coordinate_derivatives(const std::array<double, 3>& place) {
  const double root = std::sqrt(std::max(place[2], 1e-10));
  return {1.0 / (place[0] + slab_scale), 1.0 / place[1], 0.5 / (root * (root + half_space_scale))};
}

/// Of a mixture, that of a share of 0 to 1.
template <class Compute>
std::array<double, 2> extremes(const SkinRange& range, Compute compute) {
  std::array<double, 2> found = {1e300, -1e300};
  for (int corner = 0; corner < 16; ++corner) {
    const bool is_high = corner & 1;
    SkinParameters skin = is_high ? range.high : range.low;
    skin.melanin_blend = (corner & 2 ? range.high : range.low).melanin_blend;
    skin.saturation_epidermis = (corner & 4 ? range.high : range.low).saturation_epidermis;
    skin.saturation_dermis = (corner & 8 ? range.high : range.low).saturation_dermis;
    const double value = compute(skin);
    found = {std::min(found[0], value), std::max(found[1], value)};
  }
  return found;
}

void check(const SkinRange& range) {
  for (const SkinParameterRange& each : skin_parameter_ranges()) {
    const double low = range.low.*each.value, high = range.high.*each.value;
    if (!(each.low <= low && low <= high && (high <= each.high || std::isinf(high))))
      throw InvalidInput("range of " + std::string(each.name) + ": must lie within [" +
                         number_text(each.low) + ", " + number_text(each.high) + "], but is [" +
                         number_text(low) + ", " + number_text(high) + "]");
  }
  if (std::isfinite(range.low.dermis_thickness))
    throw InvalidInput("dermis_thickness: must be infinite for a table of reflectance, but is " +
                       number_text(range.low.dermis_thickness) + " mm");
  if (range.low.junction_absorption != range.high.junction_absorption)
    throw InvalidInput("junction_absorption: must be fixed for a table of reflectance");
}

/// Indices and mean cosine of skin, the sheet between its layers without thickness.
/// @param place  the thickness of the epidermis is 1 mm
LayerStack stack_at(const std::array<double, 3>& place, const LayerStack& skin, double sheet) {
  std::vector<Layer> layers(skin.layers().begin(), skin.layers().end());
  const double forward = 1.0 - layers[0].medium.g;
  layers[0].medium.sigma_a = place[0];
  layers[0].medium.sigma_s = place[1] / forward;
  layers[0].thickness = 1.0;
  layers.back().medium.sigma_s = 0.5 * place[1] / forward;
  layers.back().medium.sigma_a = place[2] * 0.5 * place[1];
  if (layers.size() == 3)
    layers[1] = absorbing_sheet(sheet / std::numbers::ln10, layers[1].medium.ior);
  return LayerStack(std::move(layers), skin.ior_above(), skin.ior_below());
}

/// What adding-doubling makes of a box of places, with mean cosine and sheet of a wavelength.
struct Solutions {
  double wavelength = 0.0;  ///< [nm]
  double sheet = 0.0;       ///< as in stack_at
  ChebyshevTable::Box box = {};
  ChebyshevTable::Counts counts = {};
  std::vector<double> values = {};  ///< logarithm of what comes out

  [[nodiscard]] std::array<double, 3> place(std::size_t i, std::size_t j, std::size_t k) const {
    const std::array<std::size_t, 3> index = {i, j, k};
    std::array<double, 3> coordinate;
    for (std::size_t d = 0; d < index.size(); ++d)
      coordinate[d] = ChebyshevTable::points(box.low[d], box.high[d], counts[d])[index[d]];
    return place_at(coordinate);
  }
  [[nodiscard]] ChebyshevTable table() const { return {box, counts, values}; }
};

/// Fills the solutions of a row of epidermises of one scattering, j.
void solve_row(Solutions& solutions, std::size_t j, const LayerStack& like,
               const std::vector<GridDirection>& beams, const Incidence& incidence,
               const std::vector<detail::LayerOperators>& dermis) {
  const auto count = [&](std::size_t d) { return static_cast<std::size_t>(solutions.counts[d]); };
  for (std::size_t i = 0; i < count(0); ++i) {
    const detail::GridStack stack = detail::make_grid_stack(
        stack_at(solutions.place(i, j, 0), like, solutions.sheet), grid_nodes, beams);
    std::vector<detail::LayerOperators> layers;
    for (std::size_t l = 0; l + 1 < stack.layers.size(); ++l)
      layers.push_back(detail::layer_operators(stack.layers[l], 0));
    layers.emplace_back();
    std::vector<double> down(active_count(stack.grid, 1.0), 0.0);
    double all = 0.0;
    for (std::size_t node = 0; node < down.size(); ++node) all += stack.grid.etendue[node];
    if (incidence.is_diffuse)
      for (std::size_t node = 0; node < down.size(); ++node)
        down[node] = std::sqrt(stack.grid.etendue[node]) / all;
    else
      down[stack.grid.extra[0]] = 1.0 / std::sqrt(stack.grid.etendue[stack.grid.extra[0]]);
    const detail::RoughBoundaries smooth(stack.interfaces.size());
    for (std::size_t k = 0; k < count(2); ++k) {
      layers.back() = dermis[k];
      const detail::StackOperators operators = detail::stack_operators(stack, 0, smooth, layers);
      const std::vector<double> up = detail::product(operators.reflection, down);
      double sum = 0.0;
      for (std::size_t node = 0; node < up.size(); ++node)
        sum += std::sqrt(stack.grid.etendue[node]) *
               (up[node] - operators.first_reflection(node, node) * down[node]);
      solutions.values[(k * count(1) + j) * count(0) + i] = std::log(sum);
    }
  }
}

/// Fills all values. @param skin  whose indices and layers they have
void solve(std::vector<Solutions>& all, const Incidence& incidence, const SkinParameters& skin,
           const Progress& progress) {
  std::vector<GridDirection> beams;
  if (!incidence.is_diffuse) beams.push_back(direction_in(1.0, incidence.theta));
  std::vector<LayerStack> like;
  std::vector<std::vector<detail::LayerOperators>> dermis(all.size());
  std::vector<std::array<std::size_t, 2>> rows;
  for (std::size_t s = 0; s < all.size(); ++s) {
    like.push_back(skin_layer_stack(skin, all[s].wavelength));
    const ChebyshevTable::Counts& counts = all[s].counts;
    all[s].values.resize(static_cast<std::size_t>(counts[0] * counts[1] * counts[2]));
    for (std::size_t j = 0; j < static_cast<std::size_t>(counts[1]); ++j) rows.push_back({s, j});
  }
  parallel_for(all.size(), [&](std::size_t s) {  // of any size: a half-space has none
    for (std::size_t k = 0; k < static_cast<std::size_t>(all[s].counts[2]); ++k) {
      const detail::GridStack stack = detail::make_grid_stack(
          stack_at(all[s].place(0, 0, k), like[s], all[s].sheet), grid_nodes, beams);
      dermis[s].push_back(detail::layer_operators(stack.layers.back(), 0));
    }
  });
  parallel_for(
      rows.size(),
      [&](std::size_t r) {
        const auto [s, j] = rows[r];
        solve_row(all[s], j, like[s], beams, incidence, dermis[s]);
      },
      progress);
}

ChebyshevTable::Box hull(std::span<const ChebyshevTable::Box> boxes) {
  ChebyshevTable::Box all = boxes[0];
  for (const ChebyshevTable::Box& box : boxes)
    for (std::size_t d = 0; d < box.low.size(); ++d) {
      all.low[d] = std::min(all.low[d], box.low[d]);
      all.high[d] = std::max(all.high[d], box.high[d]);
    }
  return all;
}

/// Weights of values at nodes in that of the polynomial through them.
std::vector<double> lagrange(std::span<const double> nodes, double at) {
  std::vector<double> weights;
  for (const double node : nodes) {
    double weight = 1.0;
    for (const double other : nodes)
      if (other != node) weight *= (at - other) / (node - other);
    weights.push_back(weight);
  }
  return weights;
}

}  // namespace

SkinReflectanceTable::Place SkinReflectanceTable::place(const Band& band,
                                                        const SkinParameters& skin) {
  double scattering = skin.scattering_scale * band.scattering;
  if (skin.scattering_power != 0.0) scattering *= std::exp(skin.scattering_power * band.log_ratio);
  return {epidermis_absorption(skin, band.spectrum) * skin.epidermis_thickness,
          std::max(scattering * skin.epidermis_thickness, least_scattering),
          dermis_absorption(skin, band.spectrum) / (0.5 * scattering)};
}

SkinReflectanceTable::Band SkinReflectanceTable::make_band(double wavelength) {
  Band band{.wavelength = wavelength, .spectrum = skin_spectrum(wavelength)};
  SkinParameters plain;
  plain.scattering_scale = 1.0;
  plain.scattering_power = 0.0;
  band.scattering = epidermis_scattering(plain, wavelength);
  plain.scattering_power = 1.0;
  band.log_ratio = std::log(epidermis_scattering(plain, wavelength) / band.scattering);
  return band;
}

ChebyshevTable::Box SkinReflectanceTable::box_of(const Band& band, const SkinRange& range) {
  const auto s = extremes(range, [&](const SkinParameters& skin) {
    return epidermis_scattering(skin, band.wavelength);
  });
  const auto a = extremes(
      range, [&](const SkinParameters& skin) { return epidermis_absorption(skin, band.spectrum); });
  const auto b = extremes(
      range, [&](const SkinParameters& skin) { return dermis_absorption(skin, band.spectrum); });
  const std::array d = {range.low.epidermis_thickness, range.high.epidermis_thickness};
  const auto corner = [&](std::size_t side) {
    return coordinates({a[side] * d[side], std::max(s[side] * d[side], least_scattering),
                        2.0 * b[side] / s[1 - side]});
  };
  return {corner(0), corner(1)};
}

double SkinReflectanceTable::log_reflectance(const Band& band, const Place& at,
                                             Place* derivatives) {
  const double value = band.table.at(coordinates(at), derivatives);
  if (derivatives) {
    const Place chain = coordinate_derivatives(at);
    for (std::size_t d = 0; d < chain.size(); ++d) (*derivatives)[d] *= chain[d];
  }
  return value;
}

SkinReflectanceTable::SkinReflectanceTable(std::vector<double> wavelengths, Incidence incidence,
                                           const SkinRange& range, const Progress& progress)
    : wavelengths_(std::move(wavelengths)) {
  check(range);
  for (const double nm : wavelengths_)
    if (!(least_wavelength <= nm && nm <= largest_wavelength))
      throw InvalidInput("wavelength: must lie in [350, 1000] nm, but is " + number_text(nm));
  if (wavelengths_.empty()) throw InvalidInput("wavelengths: must be given");
  std::vector<ChebyshevTable::Box> boxes;
  for (const double nm : wavelengths_) {
    bands_.push_back(make_band(nm));
    boxes.push_back(box_of(bands_.back(), range));
  }
  const auto sheet_at = [&](double nm) { return 0.5 * junction_absorbance(range.low, nm); };
  const bool has_one_sheet = std::ranges::all_of(
      wavelengths_, [&](double nm) { return sheet_at(nm) == sheet_at(wavelengths_[0]); });
  std::vector<Solutions> solutions;
  if (wavelengths_.size() <= mean_cosines || !has_one_sheet) {
    for (std::size_t b = 0; b < bands_.size(); ++b)
      solutions.push_back({wavelengths_[b], sheet_at(wavelengths_[b]), boxes[b], band_counts});
    solve(solutions, incidence, range.low, progress);
    for (std::size_t b = 0; b < bands_.size(); ++b) bands_[b].table = solutions[b].table();
  } else {
    // Apart from the place, wavelengths differ in the mean cosine alone, and at one reduced
    // scattering that does little: a parabola through three of them.
    const auto [first, last] = std::ranges::minmax(wavelengths_);
    const std::vector<double> nodes = ChebyshevTable::points(first, last, mean_cosines);
    const ChebyshevTable::Box all = hull(boxes);
    for (const double nm : nodes) solutions.push_back({nm, sheet_at(first), all, all_counts});
    solve(solutions, incidence, range.low, progress);
    std::vector<ChebyshevTable> tables;
    for (const Solutions& each : solutions) tables.push_back(each.table());
    for (std::size_t b = 0; b < bands_.size(); ++b)
      bands_[b].table = ChebyshevTable::mixed(tables, lagrange(nodes, wavelengths_[b]))
                            .over(boxes[b], band_counts);
  }
  specular_ = skin_specular_reflectance(range.low, incidence);
}

std::vector<double> SkinReflectanceTable::reflectance(const SkinParameters& skin) const {
  std::vector<double> result;
  for (const Band& band : bands_)
    result.push_back(std::exp(log_reflectance(band, place(band, skin), nullptr)));
  return result;
}

std::vector<double> SkinReflectanceTable::reflectance(
    const SkinParameters& skin, std::span<double SkinParameters::*const> numbers,
    DenseMatrix& derivatives) const {
  derivatives = DenseMatrix(bands_.size(), numbers.size());
  std::vector<double> result;
  for (std::size_t b = 0; b < bands_.size(); ++b)
    result.push_back(reflectance_at(b, skin, numbers, derivatives.row(b)));
  return result;
}

double SkinReflectanceTable::reflectance_at(std::size_t wavelength, const SkinParameters& skin,
                                            std::span<double SkinParameters::*const> numbers,
                                            std::span<double> derivatives) const {
  const Band& band = bands_[wavelength];
  if (numbers.empty()) return std::exp(log_reflectance(band, place(band, skin), nullptr));
  Place by;
  const double value = std::exp(log_reflectance(band, place(band, skin), &by));
  SkinParameters moved = skin;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    // The place is a polynomial of low degree in each number, or a power: its difference is exact
    // to 1e-10.
    double& number = moved.*numbers[n];
    const double step = 1e-5 * std::max(std::abs(number), 1e-3);
    number = skin.*numbers[n] + step;
    const Place above = place(band, moved);
    number = skin.*numbers[n] - step;
    const Place below = place(band, moved);
    number = skin.*numbers[n];
    double sum = 0.0;
    for (std::size_t d = 0; d < by.size(); ++d) sum += by[d] * (above[d] - below[d]) / (2.0 * step);
    derivatives[n] = value * sum;
  }
  return value;
}

double skin_specular_reflectance(const SkinParameters& skin, const Incidence& incidence) {
  const double ior = skin_layer_stack(skin, 500.0).layers()[0].medium.ior;
  return incidence.is_diffuse ? fresnel_diffuse(ior) : fresnel(std::cos(incidence.theta), ior);
}

SkinRange skin_fit_range(const SkinParameters& skin) {
  SkinRange range{.low = skin, .high = skin};
  const auto set = [&](double SkinParameters::*number, double low, double high) {
    range.low.*number = low;
    range.high.*number = high;
  };
  set(&SkinParameters::melanin, 0.0, 0.5);
  set(&SkinParameters::melanin_blend, 0.0, 1.0);
  set(&SkinParameters::hemoglobin_epidermis, 0.0, 0.05);
  set(&SkinParameters::hemoglobin_dermis, 0.0, 0.1);
  set(&SkinParameters::carotene, 0.0, 0.05);
  set(&SkinParameters::saturation_epidermis, 0.0, 1.0);
  set(&SkinParameters::saturation_dermis, 0.0, 1.0);
  set(&SkinParameters::baseline_scale, 0.0, 2.0);
  set(&SkinParameters::scattering_scale, 0.3, 3.0);
  return range;
}

}  // namespace lamina
