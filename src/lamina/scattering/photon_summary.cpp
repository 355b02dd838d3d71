// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/scattering/photon_scene.h"
#include "lamina/scattering/photon_tallies.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

/// Reads cells as means over photons.
class Reader {
 public:
  explicit Reader(const PhotonCounts& counts)
      : counts_(counts), n_(static_cast<double>(std::max<std::uint64_t>(counts.photons, 1))) {}

  /// Mean over photons of the sum of some cells, each photon being counted in one of them at most.
  [[nodiscard]] Estimate mean(std::size_t first, std::size_t count = 1, std::size_t stride = 1,
                              double scale = 1.0) const {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      sum += to_double(counts_.first[first + i * stride], photon::cell_scale);
      squares += to_double(counts_.second[first + i * stride], photon::cell_scale);
    }
    const double value = sum / n_;
    return {scale * value, scale * error(value, squares / n_, n_)};
  }

  /// Mean over photons of a volume cell, whose error is known from the batches.
  [[nodiscard]] Estimate volume_mean(std::size_t cell, double scale) const {
    const double sum = to_double(counts_.volume_first[cell], photon::volume_scale);
    const double squares = to_double(counts_.volume_second[cell], photon::volume_square_scale);
    const auto b = static_cast<double>(std::max<std::uint64_t>(counts_.batches, 1));
    // Batches have equal sizes but for the last, which weighs as if it had.
    const double error_of_sum = b * error(sum / b, squares / b, b);
    return {scale * sum / n_, scale * error_of_sum / n_};
  }

  [[nodiscard]] double photons() const { return n_; }

 private:
  /// Standard error of the mean of n samples of this mean and mean square.
  static double error(double mean, double mean_square, double n) {
    return n > 1.0 ? std::sqrt(std::max(0.0, mean_square - mean * mean) / (n - 1.0)) : 0.0;
  }

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

/// Mean of w L over the light of one side, per weight: a ratio, whose error takes both as
/// independent, which overstates it a little.
Estimate mean_path(const Reader& reader, std::size_t path, std::size_t light, double unit) {
  const Estimate sum = reader.mean(path), weight = reader.mean(light);
  if (!(weight.value > 0.0)) return {};
  const double value = unit * sum.value / weight.value;
  const double relative = std::hypot(sum.standard_error / std::max(sum.value, 1e-300),
                                     weight.standard_error / weight.value);
  return {value, value * relative};
}

void read_lengths(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                  MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const double unit = std::ldexp(counts.length_unit, photon::path_scale);
  result.mean_path_reflected =
      mean_path(reader, PhotonLayout::path_up, PhotonLayout::reflected, unit);
  result.mean_path_transmitted =
      mean_path(reader, PhotonLayout::path_down, PhotonLayout::transmitted, unit);
  for (std::size_t side = 0; side < 2; ++side) {
    auto& out = side == 0 ? result.path_length.reflection : result.path_length.transmission;
    for (std::size_t i = 0; i < layout.path_size; ++i)
      out.push_back(
          reader.mean(layout.path + side * layout.path_size + i, 1, 1, 1.0 / t.path_length.width));
  }
}

void read_radii(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const double step = std::log(t.log_r.high / t.log_r.low) / std::max(t.log_r.count, 1);
  for (std::size_t side = 0; side < 2; ++side) {
    auto& out = side == 0 ? result.log_radial.reflection : result.log_radial.transmission;
    for (std::size_t i = 0; i < layout.log_r_size; ++i) {
      const double low = t.log_r.low * std::exp(step * static_cast<double>(i));
      const double high = low * std::exp(step);
      out.push_back(reader.mean(layout.log_r + side * layout.log_r_size + i, 1, 1,
                                1.0 / (pi * (high * high - low * low))));
    }
  }
  for (std::size_t i = 0; i < t.detectors.size(); ++i) {
    const double low = std::max(0.0, t.detectors[i] - 0.5 * t.detector_width);
    const double high = t.detectors[i] + 0.5 * t.detector_width;
    result.detectors.push_back(
        reader.mean(layout.detector + i, 1, 1, 1.0 / (pi * (high * high - low * low))));
  }
  for (std::size_t i = 0; i < t.directions.size(); ++i)
    result.directions.push_back(
        reader.mean(layout.direction + i, 1, 1, std::ldexp(1.0, photon::direction_scale)));
}

void read_volume(const PhotonCounts& counts, const Reader& reader, const PhotonLayout& layout,
                 MonteCarloResult& result) {
  const PhotonTallies& t = counts.tallies;
  const double fluence_unit =
      std::ldexp(counts.length_unit, photon::volume_scale - photon::fluence_scale);
  for (std::size_t cell = 0; cell < layout.volume_cells; ++cell) {
    const bool is_fluence = cell >= layout.rz_size;
    const auto ring =
        static_cast<int>((cell % layout.rz_size) / static_cast<std::size_t>(t.depth.count));
    const double volume = ring_area(t.r, ring) * t.depth.width;
    auto& out = is_fluence ? result.fluence : result.absorption;
    out.push_back(reader.volume_mean(cell, (is_fluence ? fluence_unit : 1.0) / volume));
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
  result.specular_reflectance = reader.mean(PhotonLayout::specular);
  result.specular_reflectance.value += counts.specular;
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
  read_radii(counts, reader, layout, result);
  if (layout.volume_cells > 0) read_volume(counts, reader, layout, result);
  return result;
}

}  // namespace lamina
