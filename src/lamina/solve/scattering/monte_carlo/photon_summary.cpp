// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_scene.h"
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"

namespace lamina {
namespace {

using std::numbers::pi;

/// What squares below the resolution of the fixed point can have lost, of n samples of this sum.
double lost_squares(double n, double sum) {
  const double half = std::ldexp(0.5, -photon::cell_scale);
  return std::min(n * half, std::abs(sum) * std::sqrt(half));
}

/// CellSums over photons of what they left in some cells together, of which each met one at most.
struct CellSums {
  double first = 0.0, second = 0.0;
};

/// How many photons of equal weights have these sums.
double photons_of(const CellSums& weights) {
  return weights.second > 0.0 ? std::max(1.0, weights.first * weights.first / weights.second) : 1.0;
}

/// Squares of what k photons differ by, with those that few of them hide.
/// @param whole  what one more would differ by if nothing were known of it
double with_one_more(double squares, double whole, double k) {
  return std::max(0.0, squares) * (1.0 + 1.0 / k) + (whole / k) * (whole / k);
}

/// Reads cells as means over photons.
class Reader {
 public:
  explicit Reader(const PhotonCounts& counts)
      : counts_(counts), n_(static_cast<double>(counts.photons)) {}

  [[nodiscard]] CellSums sums(std::size_t first, std::size_t count = 1,
                              std::size_t stride = 1) const {
    CellSums sums;
    for (std::size_t i = 0; i < count; ++i) {
      sums.first += to_double(counts_.first[first + i * stride], photon::cell_scale);
      sums.second += to_double(counts_.second[first + i * stride], photon::cell_scale);
    }
    sums.second += lost_squares(n_, sums.first);
    return sums;
  }

  /// Their mean. @param largest  what a photon leaves there at most.
  [[nodiscard]] Estimate mean(std::size_t first, std::size_t count = 1, std::size_t stride = 1,
                              double scale = 1.0, double largest = 1.0) const {
    const CellSums of = sums(first, count, stride);
    const Estimate mean = sample_mean(n_, of.first, of.second, largest);
    return {scale * mean.value, scale * mean.standard_error};
  }

  /// Amplitude and phase from the three sums of modulated light in some places together. Errors
  /// are those of the two-dimensional mean, along it as if one more photon had left, and across.
  [[nodiscard]] Modulation modulation(std::size_t first, std::size_t count, std::size_t stride,
                                      double scale) const {
    const CellSums c = sums(first, count, stride), s = sums(first + 1, count, stride);
    const double product = sums(first + 2, count, stride).first;
    const double length = std::hypot(c.first, s.first), squares = c.second + s.second;
    if (!(n_ > 0.0) || !(length > 0.0)) return {{0.0, scale / std::max(n_, 1.0)}, {0.0, pi}};
    const double one_more = std::pow(std::min(1.0, squares / length), 2.0);
    const double cc = c.second - c.first * c.first / n_, ss = s.second - s.first * s.first / n_,
                 cs = product - c.first * s.first / n_;
    const double x = c.first / length, y = s.first / length;
    const double phase = std::atan2(s.first, c.first);
    const double along = std::max(0.0, x * x * cc + y * y * ss + 2.0 * x * y * cs) + one_more,
                 across = with_one_more(y * y * cc + x * x * ss - 2.0 * x * y * cs,
                                        std::sqrt(one_more) * std::abs(phase),
                                        photons_of({length, squares}));
    return {{scale * length / n_, scale * std::sqrt(along) / n_},
            {phase, std::min(pi, std::sqrt(across) / length)}};
  }

  /// Mean over photons of a volume cell, whose error is known from the batches, which hold several
  /// parts of a photon. A single batch tells nothing: as if each photon had left all or nothing.
  /// As in sample_mean, one more is added like those that there were, of their weight where all
  /// came by chance, variance over mean; where there were none, of the largest.
  /// @param largest  what a photon leaves there at most.
  [[nodiscard]] Estimate volume_mean(std::size_t cell, double scale, double largest) const {
    const double sum = to_double(counts_.volume_first[cell], photon::volume_scale);
    const double squares = to_double(counts_.volume_second[cell], photon::volume_square_scale);
    const auto b = static_cast<double>(counts_.batches);
    const double variance =
        b > 1.0 ? std::max(0.0, n_ * squares - sum * sum) / (b - 1.0) : std::abs(sum) * largest;
    const double one_more = sum != 0.0 ? std::min(variance / std::abs(sum), largest) : largest;
    const double per_photon = scale / std::max(n_, 1.0);
    return {per_photon * sum, per_photon * std::sqrt(variance + one_more * one_more)};
  }

 private:
  const PhotonCounts& counts_;
  double n_;
};

/// Area of ring i [mm²]; the last one has no end but is given its width, as in MCML.
double ring_area(const UniformBins& r, int i) { return pi * r.width * r.width * (2.0 * i + 1.0); }

/// Solid angle of the polar angles of bin i times the cosine in its middle [sr], as in MCML.
double projected_angle(int angles, int i) {
  const double width = 0.5 * pi / angles;
  const double low = i * width, high = low + width;
  return pi * (std::sin(high) * std::sin(high) - std::sin(low) * std::sin(low));
}

double solid_angle(int angles, int i) {
  const double width = 0.5 * pi / angles;
  return 2.0 * pi * (std::cos(i * width) - std::cos((i + 1) * width));
}

void read_radial_angular(const PhotonCounts& counts, const Reader& reader,
                         const PhotonLayout& layout, MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const int radii = std::max(t.r.count, 1), angles = std::max(t.angles, 1);
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t base = layout.ra + side * layout.ra_size;
    const auto pick = [&](TwoSided& both) -> std::vector<Estimate>& {
      return side == 0 ? both.reflection : both.transmission;
    };
    for (int i = 0; i < t.r.count; ++i) {
      const std::size_t row = base + static_cast<std::size_t>(i * angles);
      pick(result.radial)
          .push_back(
              reader.mean(row, static_cast<std::size_t>(angles), 1, 1.0 / ring_area(t.r, i)));
      for (int j = 0; j < t.angles; ++j)
        pick(result.radial_angular)
            .push_back(reader.mean(row + static_cast<std::size_t>(j), 1, 1,
                                   1.0 / (ring_area(t.r, i) * projected_angle(t.angles, j))));
    }
    for (int j = 0; j < t.angles; ++j)
      pick(result.angular)
          .push_back(reader.mean(base + static_cast<std::size_t>(j),
                                 static_cast<std::size_t>(radii), static_cast<std::size_t>(angles),
                                 1.0 / solid_angle(t.angles, j)));
  }
}

void read_orders(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                 MonteCarloResult& result) {
  const int angles = std::max(counts.tallies.angles, 1);
  for (std::size_t side = 0; side < 2; ++side) {
    auto& fractions = side == 0 ? result.by_order.reflection : result.by_order.transmission;
    auto& angular =
        side == 0 ? result.angular_by_order.reflection : result.angular_by_order.transmission;
    for (int order = 0; order < photon_orders; ++order) {
      const std::size_t row =
          layout.order + side * layout.order_size + static_cast<std::size_t>(order * angles);
      fractions.push_back(reader.mean(row, static_cast<std::size_t>(angles)));
      for (int j = 0; j < counts.tallies.angles; ++j)
        angular.push_back(
            reader.mean(row + static_cast<std::size_t>(j), 1, 1, 1.0 / solid_angle(angles, j)));
    }
  }
}

void read_bsdf(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
               MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const int azimuths = std::max(t.bsdf_azimuths, 1);
  const auto cells = static_cast<std::size_t>(t.bsdf_cosines * azimuths);
  for (std::size_t side = 0; side < 2; ++side) {
    auto& total = side == 0 ? result.bsdf.reflection : result.bsdf.transmission;
    auto& orders = side == 0 ? result.bsdf_by_order.reflection : result.bsdf_by_order.transmission;
    // Radiance is flux per solid angle and cosine; the cosine is that of the middle of the cell.
    const auto scale = [&](std::size_t cell) {
      const double row = static_cast<double>(cell / static_cast<std::size_t>(azimuths));
      const double mu = (row + 0.5) / t.bsdf_cosines;
      return t.bsdf_cosines * azimuths / (2.0 * pi * mu);
    };
    const std::size_t base = layout.bsdf + side * layout.bsdf_size;
    const std::size_t planes = t.orders ? std::size_t{photon_orders} : 1;
    for (std::size_t i = 0; i < cells; ++i)
      total.push_back(reader.mean(base + i, planes, cells, scale(i)));
    if (!t.orders) continue;
    for (std::size_t plane = 0; plane < planes; ++plane)
      for (std::size_t i = 0; i < cells; ++i)
        orders.push_back(reader.mean(base + plane * cells + i, 1, 1, scale(i)));
  }
}

/// Mean path of the light of one side, each photon by its weight: a ratio R of two means, of w L
/// and of w, whose errors are correlated. To first order its variance is that of w L - R w. Of k
/// photons it counts as that of k - 1 differences, and one more is off by R / k.
Estimate mean_path(const Reader& reader, std::size_t path, std::size_t light,
                   std::size_t weighted_path, double unit) {
  const CellSums paths = reader.sums(path), weights = reader.sums(light);
  if (!(weights.first > 0.0)) return {};
  const double ratio = paths.first / weights.first;
  const double scatter = paths.second - 2.0 * ratio * reader.sums(weighted_path).first +
                         ratio * ratio * weights.second;
  return {unit * ratio, unit *
                            std::sqrt(with_one_more(scatter, ratio * weights.second / weights.first,
                                                    photons_of(weights))) /
                            weights.first};
}

void read_lengths(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                  MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const double unit = std::ldexp(counts.length_unit, photon::path_scale);
  result.mean_path_reflected = mean_path(reader, PhotonLayout::path_up, PhotonLayout::reflected,
                                         PhotonLayout::weighted_path_up, unit);
  result.mean_path_transmitted =
      mean_path(reader, PhotonLayout::path_down, PhotonLayout::transmitted,
                PhotonLayout::weighted_path_down, unit);
  for (std::size_t side = 0; side < 2; ++side) {
    auto& out = side == 0 ? result.path_length.reflection : result.path_length.transmission;
    for (std::size_t i = 0; i < layout.path_size; ++i)
      out.push_back(
          reader.mean(layout.path + side * layout.path_size + i, 1, 1, 1.0 / t.path_length.width));
  }
}

/// Mean time of flight and mean paths in the layers, the light over time.
void read_flight(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                 MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const double unit = std::ldexp(counts.length_unit, photon::path_scale);
  const auto times = static_cast<std::size_t>(t.time.count);
  const auto rings = static_cast<std::size_t>(std::max(t.r.count, 1));
  for (std::size_t side = 0; side < 2; ++side) {
    const auto mean_of = [&](std::size_t path, double in_unit) {
      const std::size_t cell = photon::flight_cell(layout, side, path);
      return mean_path(reader, cell,
                       side == 0 ? PhotonLayout::reflected : PhotonLayout::transmitted, cell + 1,
                       in_unit);
    };
    (side == 0 ? result.mean_time_reflected : result.mean_time_transmitted) =
        mean_of(0, unit / speed_of_light);
    const auto pick = [&](TwoSided& both) -> std::vector<Estimate>& {
      return side == 0 ? both.reflection : both.transmission;
    };
    for (std::size_t layer = 0; layer < counts.layers; ++layer)
      pick(result.mean_layer_path).push_back(mean_of(1 + layer, unit));
    const std::size_t first = layout.time + side * layout.time_size;
    for (std::size_t i = 0; i < times; ++i)
      pick(result.time).push_back(reader.mean(first + i, rings, times, 1.0 / t.time.width));
    for (std::size_t cell = 0; t.r.count > 0 && cell < rings * times; ++cell)
      pick(result.radial_time)
          .push_back(
              reader.mean(first + cell, 1, 1,
                          1.0 / (t.time.width * ring_area(t.r, static_cast<int>(cell / times)))));
  }
}

void read_modulation(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                     MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const std::size_t parts = t.frequencies.size() * modulation_parts;
  const auto rings = static_cast<std::size_t>(std::max(t.r.count, 1));
  for (std::size_t side = 0; side < 2; ++side) {
    const auto pick = [&](TwoSidedModulation& both) -> std::vector<Modulation>& {
      return side == 0 ? both.reflection : both.transmission;
    };
    const std::size_t first = layout.modulation + side * layout.modulation_size;
    for (std::size_t f = 0; f < parts; f += modulation_parts)
      pick(result.modulation).push_back(reader.modulation(first + f, rings, parts, 1.0));
    for (std::size_t cell = 0; t.r.count > 0 && cell < rings * parts; cell += modulation_parts)
      pick(result.radial_modulation)
          .push_back(reader.modulation(first + cell, 1, 1,
                                       1.0 / ring_area(t.r, static_cast<int>(cell / parts))));
  }
}

/// Of the ring that a detector sees [mm²].
double detector_area(const PhotonTallies& t, std::size_t i) {
  const double r = t.detectors[i], half = 0.5 * t.detector_width;
  return r < half ? pi * (r + half) * (r + half) : 4.0 * pi * r * half;
}

void read_detectors(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                    MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const auto times = static_cast<std::size_t>(t.time.count);
  const std::size_t parts = t.frequencies.size() * modulation_parts;
  for (std::size_t i = 0; i < t.detectors.size(); ++i) {
    const double scale = 1.0 / detector_area(t, i);
    result.detectors.push_back(reader.mean(layout.detector + i, 1, 1, scale));
    for (std::size_t k = 0; k < times; ++k)
      result.detector_time.push_back(
          reader.mean(layout.detector_time + i * times + k, 1, 1, scale / t.time.width));
    for (std::size_t k = 0; k < parts; k += modulation_parts)
      result.detector_modulation.push_back(
          reader.modulation(layout.detector_modulation + i * parts + k, 1, 1, scale));
  }
}

void read_radii(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const double step = std::log(t.log_r.high / t.log_r.low) / std::max(t.log_r.count, 1);
  for (std::size_t side = 0; side < 2 && layout.log_r_size > 0; ++side) {
    auto& out = side == 0 ? result.log_radial.reflection : result.log_radial.transmission;
    auto& outside =
        side == 0 ? result.log_radial_outside.reflection : result.log_radial_outside.transmission;
    const std::size_t nearer = layout.log_r + side * layout.log_r_size;
    for (std::size_t i = 0; i + 2 < layout.log_r_size; ++i) {
      const double low = t.log_r.low * std::exp(step * static_cast<double>(i));
      out.push_back(
          reader.mean(nearer + 1 + i, 1, 1, 1.0 / (pi * low * low * std::expm1(2.0 * step))));
    }
    outside = {reader.mean(nearer), reader.mean(nearer + layout.log_r_size - 1)};
  }
  for (std::size_t i = 0; i < t.directions.size(); ++i)
    result.directions.push_back(reader.mean(layout.direction + i, 1, 1,
                                            std::ldexp(1.0, photon::direction_scale),
                                            std::ldexp(1.0, -photon::direction_scale)));  // 1/sr
}

void read_volume(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                 MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  // The fluence is counted in units of length, in fewer digits.
  const double fluence_digits = std::ldexp(1.0, photon::fluence_scale - photon::volume_scale);
  for (std::size_t cell = 0; cell < layout.volume_cells; ++cell) {
    const bool is_fluence = cell >= layout.rz_size;
    const auto ring =
        static_cast<int>((cell % layout.rz_size) / static_cast<std::size_t>(t.depth.count));
    const double volume = ring_area(t.r, ring) * t.depth.width;
    auto& out = is_fluence ? result.fluence : result.absorption;
    out.push_back(
        is_fluence
            ? reader.volume_mean(cell, counts.length_unit / fluence_digits / volume, fluence_digits)
            : reader.volume_mean(cell, 1.0 / volume, 1.0));
  }
}

}  // namespace

MonteCarloResult summarize(const PhotonCounts& counts) {
  const Reader reader(counts);
  const PhotonLayout layout = make_photon_layout(counts.tallies, counts.layers);
  MonteCarloResult result;
  result.photons = counts.photons;
  result.events = counts.events;
  result.was_stopped = counts.was_stopped;
  result.specular_reflectance = counts.has_random_specular ? reader.mean(PhotonLayout::specular)
                                                           : Estimate{counts.specular, 0.0};
  result.diffuse_reflectance = reader.mean(PhotonLayout::reflected);
  result.transmittance = reader.mean(PhotonLayout::transmitted);
  result.unscattered_reflectance = reader.mean(PhotonLayout::unscattered_up);
  result.unscattered_transmittance = reader.mean(PhotonLayout::unscattered_down);
  result.unfinished = reader.mean(PhotonLayout::unfinished);
  for (std::size_t i = 0; i < counts.layers; ++i)
    result.absorptance.push_back(reader.mean(PhotonLayout::first_layer + i));
  if (layout.ra_size > 0) read_radial_angular(counts, reader, layout, result);
  if (layout.order_size > 0) read_orders(counts, reader, layout, result);
  if (layout.bsdf_size > 0) read_bsdf(counts, reader, layout, result);
  if (counts.tallies.mean_path_length || layout.path_size > 0)
    read_lengths(counts, reader, layout, result);
  if (layout.flight_size > 0) read_flight(counts, reader, layout, result);
  if (layout.modulation_size > 0) read_modulation(counts, reader, layout, result);
  read_detectors(counts, reader, layout, result);
  read_radii(counts, reader, layout, result);
  if (layout.volume_cells > 0) read_volume(counts, reader, layout, result);
  return result;
}

}  // namespace lamina
