// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reflectance/skin_reflectance_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/optics/absorbing_sheet.h"
#include "lamina/optics/fresnel.h"
#include "lamina/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina {
namespace {

constexpr std::array<int, 3> orders = {14, 9, 11};  // Chebyshev points along each coordinate
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

/// T_n(x) and, if asked for, T_n'(x), n = 0 .. count - 1.
void chebyshev(double x, int count, double* values, double* derivatives) {
  double second_kind = 0.0, last_second_kind = 0.0;  // U_{n-1}(x), U_{n-2}(x)
  for (int n = 0; n < count; ++n) {
    values[n] = n == 0 ? 1.0 : n == 1 ? x : 2.0 * x * values[n - 1] - values[n - 2];
    if (n == 1) second_kind = 1.0;
    if (n > 1)
      last_second_kind = std::exchange(second_kind, 2.0 * x * second_kind - last_second_kind);
    if (derivatives) derivatives[n] = n * second_kind;
  }
}

double chebyshev_point(int i, int count) { return std::cos(std::numbers::pi * (i + 0.5) / count); }

/// Values at Chebyshev points of one dimension become coefficients, in place.
void to_coefficients(std::vector<double>& values, std::size_t stride, std::size_t count) {
  std::vector<double> old(count);
  for (std::size_t start = 0; start < values.size(); ++start) {
    if (start / stride % count != 0) continue;
    for (std::size_t i = 0; i < count; ++i) old[i] = values[start + i * stride];
    for (std::size_t n = 0; n < count; ++n) {
      double sum = 0.0;
      for (std::size_t i = 0; i < count; ++i)
        sum += old[i] * std::cos(std::numbers::pi * static_cast<double>(n) *
                                 (static_cast<double>(i) + 0.5) / static_cast<double>(count));
      values[start + n * stride] = sum * (n == 0 ? 1.0 : 2.0) / static_cast<double>(count);
    }
  }
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

}  // namespace

SkinReflectanceTable::Place SkinReflectanceTable::place(const Band& band,
                                                        const SkinParameters& skin) {
  double scattering = skin.scattering_scale * band.scattering;
  if (skin.scattering_power != 0.0) scattering *= std::exp(skin.scattering_power * band.log_ratio);
  return {epidermis_absorption(skin, band.spectrum) * skin.epidermis_thickness,
          std::max(scattering * skin.epidermis_thickness, least_scattering),
          dermis_absorption(skin, band.spectrum) / (0.5 * scattering)};
}

void SkinReflectanceTable::fill(Band& band, Incidence incidence, const SkinParameters& skin) const {
  const LayerStack like = skin_layer_stack(skin, band.wavelength);
  const double sheet = 0.5 * junction_absorbance(skin, band.wavelength);
  std::vector<GridDirection> beams;
  if (!incidence.is_diffuse) beams.push_back(direction_in(1.0, incidence.theta));
  const auto at = [&](int i, int j, int k) {
    const std::array<int, 3> index = {i, j, k};
    Place coordinate;
    for (std::size_t d = 0; d < dimensions; ++d)
      coordinate[d] = 0.5 * (band.low[d] + band.high[d]) +
                      0.5 * (band.high[d] - band.low[d]) * chebyshev_point(index[d], orders[d]);
    return detail::make_grid_stack(stack_at(place_at(coordinate), like, sheet), grid_nodes, beams);
  };
  const auto dermis_of = [&](int k) {  // of any size: a half-space has none
    const detail::GridStack stack = at(0, 0, k);
    return detail::layer_operators(stack.layers.back(), 0);
  };
  std::vector<detail::LayerOperators> dermis;
  for (int k = 0; k < orders[2]; ++k) dermis.push_back(dermis_of(k));
  band.coefficients.resize(static_cast<std::size_t>(orders[0] * orders[1] * orders[2]));
  for (int j = 0; j < orders[1]; ++j)
    for (int i = 0; i < orders[0]; ++i) {
      const detail::GridStack stack = at(i, j, 0);
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
      for (int k = 0; k < orders[2]; ++k) {
        layers.back() = dermis[static_cast<std::size_t>(k)];
        const detail::StackOperators operators = detail::stack_operators(stack, 0, smooth, layers);
        const std::vector<double> up = detail::product(operators.reflection, down);
        double sum = 0.0;
        for (std::size_t node = 0; node < up.size(); ++node)
          sum += std::sqrt(stack.grid.etendue[node]) *
                 (up[node] - operators.first_reflection(node, node) * down[node]);
        band.coefficients[static_cast<std::size_t>((k * orders[1] + j) * orders[0] + i)] =
            std::log(sum);
      }
    }
  std::size_t stride = 1;
  for (const int count : orders) {
    to_coefficients(band.coefficients, stride, static_cast<std::size_t>(count));
    stride *= static_cast<std::size_t>(count);
  }
}

SkinReflectanceTable::SkinReflectanceTable(std::vector<double> wavelengths, Incidence incidence,
                                           const SkinRange& range, const Progress& progress)
    : wavelengths_(std::move(wavelengths)) {
  check(range);
  for (const double nm : wavelengths_)
    if (!(least_wavelength <= nm && nm <= largest_wavelength))
      throw InvalidInput("wavelength: must lie in [350, 1000] nm, but is " + number_text(nm));
  for (const double nm : wavelengths_) {
    Band& band = bands_.emplace_back();
    band.wavelength = nm;
    band.spectrum = skin_spectrum(nm);
    SkinParameters plain;
    plain.scattering_scale = 1.0;
    plain.scattering_power = 0.0;
    band.scattering = epidermis_scattering(plain, nm);
    plain.scattering_power = 1.0;
    band.log_ratio = std::log(epidermis_scattering(plain, nm) / band.scattering);
    const auto scattering = [&](const SkinParameters& skin) {
      return epidermis_scattering(skin, nm);
    };
    const std::array<double, 2> s = extremes(range, scattering);
    const std::array<double, 2> d = {range.low.epidermis_thickness, range.high.epidermis_thickness};
    const std::array<double, 2> a = extremes(range, [&](const SkinParameters& skin) {
      return epidermis_absorption(skin, band.spectrum);
    });
    const std::array<double, 2> b = extremes(
        range, [&](const SkinParameters& skin) { return dermis_absorption(skin, band.spectrum); });
    band.low =
        coordinates({a[0] * d[0], std::max(s[0] * d[0], least_scattering), 2.0 * b[0] / s[1]});
    band.high =
        coordinates({a[1] * d[1], std::max(s[1] * d[1], least_scattering), 2.0 * b[1] / s[0]});
    for (std::size_t i = 0; i < dimensions; ++i) {  // so that nothing is divided by no width
      band.low[i] -= 1e-6;
      band.high[i] += 1e-6;
    }
  }
  parallel_for(
      bands_.size(), [&](std::size_t b) { fill(bands_[b], incidence, range.low); }, progress);
  const double ior = skin_layer_stack(range.low, 500.0).layers()[0].medium.ior;
  specular_ = incidence.is_diffuse ? fresnel_diffuse(ior) : fresnel(std::cos(incidence.theta), ior);
}

double SkinReflectanceTable::log_reflectance(const Band& band, const Place& at,
                                             Place* derivatives) {
  const Place coordinate = coordinates(at);
  std::array<std::array<double, 16>, dimensions> value, slope;
  Place inside = {1.0, 1.0, 1.0}, width;
  for (std::size_t d = 0; d < dimensions; ++d) {
    width[d] = 0.5 * (band.high[d] - band.low[d]);
    const double x = (coordinate[d] - band.low[d]) / width[d] - 1.0;
    if (std::abs(x) > 1.0) inside[d] = 0.0;
    chebyshev(std::clamp(x, -1.0, 1.0), orders[d], value[d].data(),
              derivatives ? slope[d].data() : nullptr);
  }
  double sum = 0.0;
  Place by = {};
  const double* c = band.coefficients.data();
  for (int k = 0; k < orders[2]; ++k) {
    double plane = 0.0, plane_by_0 = 0.0, plane_by_1 = 0.0;
    for (int j = 0; j < orders[1]; ++j, c += orders[0]) {
      double row = 0.0, row_by_0 = 0.0;
      for (int i = 0; i < orders[0]; ++i) row += c[i] * value[0][i];
      if (derivatives)
        for (int i = 0; i < orders[0]; ++i) row_by_0 += c[i] * slope[0][i];
      plane += row * value[1][j];
      if (!derivatives) continue;
      plane_by_0 += row_by_0 * value[1][j];
      plane_by_1 += row * slope[1][j];
    }
    sum += plane * value[2][k];
    if (!derivatives) continue;
    by[0] += plane_by_0 * value[2][k];
    by[1] += plane_by_1 * value[2][k];
    by[2] += plane * slope[2][k];
  }
  if (derivatives) {
    const Place chain = coordinate_derivatives(at);
    for (std::size_t d = 0; d < dimensions; ++d)
      (*derivatives)[d] = by[d] / width[d] * chain[d] * inside[d];
  }
  return sum;
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
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    const Band& band = bands_[b];
    Place by;
    const double value = std::exp(log_reflectance(band, place(band, skin), &by));
    result.push_back(value);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      // The place is a polynomial of low degree in each number, or a power: its difference is exact
      // to 1e-10.
      SkinParameters more = skin, less = skin;
      const double step = 1e-5 * std::max(std::abs(skin.*numbers[n]), 1e-3);
      more.*numbers[n] += step;
      less.*numbers[n] -= step;
      const Place above = place(band, more), below = place(band, less);
      double sum = 0.0;
      for (std::size_t d = 0; d < dimensions; ++d)
        sum += by[d] * (above[d] - below[d]) / (2.0 * step);
      derivatives(b, n) = value * sum;
    }
  }
  return result;
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
