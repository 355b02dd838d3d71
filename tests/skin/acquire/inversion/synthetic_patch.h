// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "lamina/layers/materials/skin.h"
#include "lamina/skin/acquire/inversion/texels/patch_capture.h"
#include "lamina/skin/patch/skin_patch.h"

namespace lamina {

/// Skin with freckles of pheomelanin, two veins, blotches and a field of carotene, as a function of
/// the place: the same whatever the grid.
class SyntheticSkin {
 public:
  /// melanin, melanin_blend, hemoglobin_epidermis, hemoglobin_dermis, carotene
  static constexpr std::size_t numbers = 5;
  static constexpr std::array<double SkinParameters::*, numbers> members = {
      &SkinParameters::melanin, &SkinParameters::melanin_blend,
      &SkinParameters::hemoglobin_epidermis, &SkinParameters::hemoglobin_dermis,
      &SkinParameters::carotene};

  explicit SyntheticSkin(std::uint64_t seed = 1) : random_(seed) {
    for (std::size_t n = 0; n < numbers; ++n)
      for (int i = 0; i < wave_count; ++i) {
        const double angle = uniform(0.0, two_pi);
        const double k = two_pi / wavelengths[n] * uniform(0.5, 1.3);
        waves_[n].push_back({k * std::cos(angle), k * std::sin(angle), uniform(0.0, two_pi)});
      }
    for (int i = 0; i < 26; ++i)
      freckles_.push_back({uniform(-5.5, 5.5), uniform(-5.5, 5.5), uniform(0.12, 0.45),
                           uniform(0.3, 1.0), uniform(0.0, std::numbers::pi), uniform(1.0, 1.6)});
  }

  /// [number] at a place [mm]
  [[nodiscard]] std::array<double, numbers> at(double x, double y) const {
    double freckle = 0.0;
    for (const Freckle& f : freckles_) {
      const double c = std::cos(f.angle), s = std::sin(f.angle);
      const double u = (x - f.x) * c + (y - f.y) * s, v = (y - f.y) * c - (x - f.x) * s;
      const double from_edge = std::hypot(u / f.stretch, v * f.stretch) - f.radius;
      freckle = std::max(freckle, f.strength / (1.0 + std::exp(from_edge / 0.06)));
    }
    const auto bell = [](double from_middle) { return std::exp(-0.5 * from_middle * from_middle); };
    double vein = bell((y - 0.35 * x - 0.8 * std::sin(0.8 * x) + 0.6) / 0.45);
    if (y > -0.2 * x) vein = std::max(vein, 0.6 * bell((x + 1.8 + 0.4 * std::sin(y)) / 0.25));
    return {0.012 * std::exp(0.15 * wave(0, x, y)) + 0.035 * freckle,
            std::clamp(0.70 - 0.35 * freckle + 0.05 * wave(1, x, y), 0.05, 0.95),
            0.0022 * std::exp(0.35 * wave(2, x, y)),
            0.009 * std::exp(0.25 * wave(3, x, y)) + 0.022 * vein,
            0.0030 * std::exp(0.25 * wave(4, x, y))};
  }

 private:
  static constexpr double two_pi = 2.0 * std::numbers::pi;
  static constexpr int wave_count = 24;
  static constexpr std::array<double, numbers> wavelengths = {1.2, 4.0, 2.5, 3.0, 5.0};  // [mm]
  struct Wave {
    double kx, ky, phase;
  };
  struct Freckle {
    double x, y, radius, strength, angle, stretch;
  };
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  [[nodiscard]] double wave(std::size_t n, double x, double y) const {
    double sum = 0.0;
    for (const Wave& w : waves_[n]) sum += std::cos(w.kx * x + w.ky * y + w.phase);
    return sum / std::sqrt(0.5 * wave_count);
  }

  std::mt19937_64 random_;
  std::array<std::vector<Wave>, numbers> waves_;
  std::vector<Freckle> freckles_;
};

/// How a synthetic patch is photographed: 10 mm of skin, of which a window is lit.
struct SyntheticSetup {
  int size = 96;         ///< texels of a side, a multiple of 16
  double window = 7.5;   ///< [mm]; 0: all is lit
  int tape = 2;          ///< texels at the edge of the window that are not known
  double noise = 0.005;  ///< of each image, relative to its mean; 0: deviations are those of .005
  std::vector<double> wavelengths = {400.0, 420.0, 480.0, 520.0, 580.0, 700.0};
  std::vector<std::vector<double>> sensors = {};  ///< [image]; empty: one for each wavelength
  std::vector<double> strips = {};  ///< periods of further lights [mm]; 0 is the window as it is
  SkinParameters skin = with_constants({}, SkinConstants::paper);
  OperatorTotals totals = OperatorTotals::radiative_transfer_profile;
  bool is_finer = true;  ///< rendered on twice as fine a grid, with more bounces
  std::uint64_t seed = 1;
  std::optional<DiskCache> cache = {};
};

struct SyntheticPatch {
  PatchCapture capture;
  std::array<Plane, SyntheticSkin::numbers> truth;  ///< mean of each texel
  std::vector<Plane> clean;                         ///< [image] without noise
};

inline SyntheticPatch make_synthetic_patch(const SyntheticSetup& setup) {
  constexpr double side = 10.0;  // [mm]
  const int n = setup.size, factor = setup.is_finer ? 2 : 1;
  const int fine = factor * n;
  const double step = side / (factor * n);
  const SyntheticSkin skin(setup.seed);
  const std::vector<double> periods = setup.strips.empty() ? std::vector{0.0} : setup.strips;

  SkinPatch patch{.width = fine, .height = fine, .mm_per_texel = step};
  patch.bands = BandSet(setup.wavelengths);
  patch.skin.skin = setup.skin;
  patch.totals = setup.totals;
  patch.transport.interlayer_bounces = setup.is_finer ? 6 : 3;
  for (const SkinParameterRange& range : skin_parameter_ranges())
    if (std::ranges::find(SyntheticSkin::members, range.value) != SyntheticSkin::members.end())
      patch.skin.maps.push_back({.name = std::string(range.name),
                                 .parameter = range.value,
                                 .values = make_image(fine, fine, {"Y"})});
  const auto place = [&](int i) { return (i + 0.5) * step - 0.5 * side; };
  for (int y = 0; y < fine; ++y)
    for (int x = 0; x < fine; ++x) {
      const auto values = skin.at(place(x), place(y));
      for (SkinMap& map : patch.skin.maps) {
        const auto number = std::ranges::find(SyntheticSkin::members, map.parameter);
        *map.values.at(x, y) = static_cast<float>(
            values[static_cast<std::size_t>(number - SyntheticSkin::members.begin())]);
      }
    }
  const auto is_in_window = [&](double x, double y) {
    return setup.window == 0.0 || std::max(std::abs(x), std::abs(y)) < 0.5 * setup.window;
  };
  const auto light_at = [&](double period, double x, double y) {
    if (!is_in_window(x, y)) return 0.0f;
    return period > 0.0 && std::fmod(x + 10.0 * period, period) > 0.5 * period ? 0.0f : 1.0f;
  };
  /// Means over the texels of the capture.
  const auto coarse = [&](const auto& value_at) {
    Plane plane = make_plane(n, n);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        double sum = 0.0;
        for (int s = 0; s < factor * factor; ++s)
          sum += static_cast<double>(value_at(factor * x + s % factor, factor * y + s / factor));
        plane.values[static_cast<std::size_t>(y * n + x)] =
            static_cast<float>(sum / (factor * factor));
      }
    return plane;
  };

  SyntheticPatch result;
  PatchCapture& capture = result.capture;
  capture = {.width = n, .height = n, .mm_per_texel = side / n, .wavelengths = setup.wavelengths};
  for (std::size_t k = 0; k < SyntheticSkin::numbers; ++k)
    result.truth[k] = coarse([&](int x, int y) { return skin.at(place(x), place(y))[k]; });
  std::vector<std::vector<double>> sensors = setup.sensors;
  for (std::size_t w = 0; setup.sensors.empty() && w < setup.wavelengths.size(); ++w) {
    sensors.emplace_back(setup.wavelengths.size(), 0.0);
    sensors.back()[w] = 1.0;
  }
  std::mt19937_64 random(setup.seed + 17);
  std::normal_distribution<double> normal;
  for (std::size_t l = 0; l < periods.size(); ++l) {
    patch.light = make_image(fine, fine, {"Y"});
    for (int y = 0; y < fine; ++y)
      for (int x = 0; x < fine; ++x)
        *patch.light.at(x, y) = light_at(periods[l], place(x), place(y));
    const Image out = render_skin_patch(patch, setup.cache).image;
    capture.lights.push_back(coarse([&](int x, int y) { return *patch.light.at(x, y); }));
    for (const std::vector<double>& sensor : sensors) {
      const Plane clean = coarse([&](int x, int y) {
        double sum = 0.0;
        for (std::size_t w = 0; w < sensor.size(); ++w)
          sum += sensor[w] * static_cast<double>(out.at(x, y)[w]);
        return sum;
      });
      PatchImage image{.reflected = clean,
                       .deviation = make_plane(n, n, std::numeric_limits<float>::infinity()),
                       .sensor = sensor,
                       .light = l};
      const auto is_known = [&](int t) {
        const double h = side / n;
        const double x = (t % n + 0.5) * h - 0.5 * side, y = (t / n + 0.5) * h - 0.5 * side;
        const double edge = setup.window == 0.0 ? 0.5 * side : 0.5 * setup.window - setup.tape * h;
        return std::max(std::abs(x), std::abs(y)) < edge;
      };
      double sum = 0.0, count = 0.0;
      for (int t = 0; t < n * n; ++t)
        if (is_known(t))
          sum += static_cast<double>(clean.values[static_cast<std::size_t>(t)]), ++count;
      const double mean = sum / count;
      for (int t = 0; t < n * n; ++t) {
        const auto at = static_cast<std::size_t>(t);
        image.reflected.values[at] += static_cast<float>(setup.noise * mean * normal(random));
        if (is_known(t))
          image.deviation.values[at] =
              static_cast<float>((setup.noise > 0.0 ? setup.noise : 0.005) * mean);
      }
      capture.images.push_back(std::move(image));
      result.clean.push_back(clean);
    }
  }
  return result;
}

/// How far a map is from the truth over the texels that all images know.
struct MapError {
  double relative = 0.0;  ///< root of the mean square, over the mean of the truth
  double correlation = 0.0;
};

template <class Found, class True>
MapError map_error(const PatchCapture& capture, const Found& found, const True& wanted) {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0, square = 0;
  for (std::size_t t = 0; t < capture.images[0].deviation.values.size(); ++t) {
    if (std::isinf(capture.images[0].deviation.values[t])) continue;
    const double x = found(t), y = wanted(t);
    n += 1, a += x, b += y, aa += x * x, bb += y * y, ab += x * y, square += (x - y) * (x - y);
  }
  return {std::sqrt(square / n) / (b / n),
          (ab - a * b / n) / std::sqrt((aa - a * a / n) * (bb - b * b / n))};
}

}  // namespace lamina
