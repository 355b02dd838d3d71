// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lamina/base/core/parallel.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"
#include "lamina/scene/surface/texture.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr std::size_t nodes = 25;                 // of melanin and of blood in the table of looks
constexpr std::size_t saturations = 5, reds = 9;  // of what makes it redder, see make_redder
constexpr std::size_t solved = 8;                 // absorptions of each layer that are solved

/// Range of the logarithm of what is sought.
struct Range {
  double low, high;
  [[nodiscard]] double at(double share) const { return std::exp(low + share * (high - low)); }
  [[nodiscard]] double share_of(double value) const {
    return (std::log(value) - low) / (high - low);
  }
  void include(double logarithm) {
    low = std::min(low, logarithm);
    high = std::max(high, logarithm);
  }
};
const Range melanin_range{std::log(0.002), std::log(0.45)};
const Range blood_range{std::log(0.0008), std::log(0.09)};
constexpr double lowest_saturation = 0.4, most_blood_in_epidermis = 0.03;

/// Weights of looks: a wrong hue is seen sooner than a wrong brightness. Oxygen is hardly seen at
/// all, so the usual one is kept where another is not asked for.
constexpr double weight_of_hue = 2.0, weight_of_red = 0.03;

/// The third of what is sought, a place in [0, reds - 1]: the oxygen of the blood, and where that
/// is full and skin is redder still, as lips are, blood close below the surface.
void make_redder(double place, SkinParameters& skin) {
  constexpr double full = saturations - 1;
  skin.saturation_dermis = skin.saturation_epidermis =
      lowest_saturation + (1.0 - lowest_saturation) * std::min(place / full, 1.0);
  skin.hemoglobin_epidermis += (most_blood_in_epidermis - skin.hemoglobin_epidermis) *
                               std::max(place - full, 0.0) / (reds - saturations);
}

double log_luminance(double r, double g, double b) {
  return std::log(std::max(0.2126 * r + 0.7152 * g + 0.0722 * b, 1e-4));
}
double log_ratio(double a, double b) { return std::log(std::max(a, 1e-4) / std::max(b, 1e-4)); }

/// Place of a value among `solved` even steps, and Lagrange's weights of the four around it.
struct Cubic {
  std::size_t first;
  std::array<double, 4> share;
};
Cubic cubic(double share) {
  const double last = solved - 1, place = std::clamp(share, 0.0, 1.0) * last;
  const double first = std::clamp(std::floor(place) - 1.0, 0.0, last - 3.0), u = place - first;
  return {static_cast<std::size_t>(first),
          {(u - 1) * (u - 2) * (u - 3) / -6, u * (u - 2) * (u - 3) / 2, u * (u - 1) * (u - 3) / -2,
           u * (u - 1) * (u - 2) / 6}};
}

/// Reflectance of skin in one band for the absorptions of its layers, by adding-doubling.
class BandReflectance {
 public:
  BandReflectance(const SkinParameters& skin, double wavelength)
      : spectrum_(skin_spectrum(wavelength)) {
    // Absorption is linear in melanin, and in blood of a given saturation.
    epidermis_ = dermis_ = {std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity()};
    for (const double share : {0.0, 1.0})
      for (std::size_t red = 0; red < reds; ++red) {
        SkinParameters end = skin;
        end.melanin = melanin_range.at(share);
        end.hemoglobin_dermis = blood_range.at(share);
        make_redder(static_cast<double>(red), end);
        epidermis_.include(std::log(epidermis_absorption(end, spectrum_)));
        dermis_.include(std::log(dermis_absorption(end, spectrum_)));
      }
    const LayerStack of_skin = skin_layer_stack(skin, wavelength);
    for (std::size_t i = 0; i < solved; ++i)
      for (std::size_t j = 0; j < solved; ++j) {
        std::vector<Layer> layers(of_skin.layers().begin(), of_skin.layers().end());
        const double more =
            epidermis_.at(static_cast<double>(i) / (solved - 1)) - layers.front().medium.sigma_a;
        for (std::size_t l = 0; l + 1 < layers.size(); ++l) layers[l].medium.sigma_a += more;
        layers.back().medium.sigma_a = dermis_.at(static_cast<double>(j) / (solved - 1));
        const LayerStack stack(layers, 1.0, layers.back().medium.ior);
        log_reflectance_[i][j] = std::log(
            adding_doubling(stack, {}, {.accuracy = 1e-3}).totals.diffuse_reflectance + 1e-9);
      }
  }

  [[nodiscard]] double at(const SkinParameters& skin) const {
    const Cubic i = cubic(epidermis_.share_of(epidermis_absorption(skin, spectrum_)));
    const Cubic j = cubic(dermis_.share_of(dermis_absorption(skin, spectrum_)));
    double sum = 0.0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        sum += i.share[a] * j.share[b] * log_reflectance_[i.first + a][j.first + b];
    return std::exp(sum);
  }

 private:
  SkinSpectrum spectrum_;
  Range epidermis_{}, dermis_{};
  std::array<std::array<double, solved>, solved> log_reflectance_{};
};

/// The three numbers that are sought, as places in the table.
using Places = std::array<double, 3>;
constexpr Places ends = {nodes - 1, nodes - 1, reds - 1};

double place_of_saturation(double saturation) {
  return std::clamp((saturation - lowest_saturation) / (1.0 - lowest_saturation), 0.0, 1.0) *
         (saturations - 1);
}

}  // namespace

SkinOfColor::SkinOfColor(const SkinParameters& base) : base_(base), looks_(nodes * nodes * reds) {
  const BandSet bands = default_spectral_bands();
  const BandWeights weights = make_skin_band_weights(bands, base);
  std::vector<std::optional<BandReflectance>> reflectance(bands.size());
  parallel_for(bands.size(),
               [&](std::size_t b) { reflectance[b].emplace(base, bands.wavelengths()[b]); });
  parallel_for(looks_.size(), [&](std::size_t k) {
    const auto share = [](std::size_t i, std::size_t count) {
      return static_cast<double>(i) / static_cast<double>(count - 1);
    };
    SkinParameters skin = base;
    skin.melanin = melanin_range.at(share(k / nodes % nodes, nodes));
    skin.hemoglobin_dermis = blood_range.at(share(k % nodes, nodes));
    make_redder(static_cast<double>(k / (nodes * nodes)), skin);
    std::array<double, 3> color{};
    for (std::size_t b = 0; b < bands.size(); ++b)
      for (std::size_t c = 0; c < 3; ++c) color[c] += weights[b][c] * reflectance[b]->at(skin);
    looks_[k] = {log_luminance(color[0], color[1], color[2]),
                 weight_of_hue * log_ratio(color[0], color[1]),
                 weight_of_hue * log_ratio(color[2], color[1])};
  });
}

Vec3 SkinOfColor::look_at(const Places& places) const {
  std::array<std::size_t, 3> low{};
  Places high_share{};
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = std::min(static_cast<std::size_t>(places[d]), static_cast<std::size_t>(ends[d]) - 1);
    high_share[d] = places[d] - static_cast<double>(low[d]);
  }
  Vec3 look{};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double share = 1.0;
    std::array<std::size_t, 3> at{};
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t up = corner >> d & 1;
      at[d] = low[d] + up;
      share *= up == 1 ? high_share[d] : 1.0 - high_share[d];
    }
    look = look + share * looks_[(at[2] * nodes + at[0]) * nodes + at[1]];
  }
  return look;
}

// The node that looks most like it, then steps of Gauss and Newton along what is not at the end of
// its range, only taken where they bring the look nearer.
SkinOfColor::Value SkinOfColor::at(const Vec3f& reflectance) const {
  const auto r = static_cast<double>(reflectance.x), g = static_cast<double>(reflectance.y),
             b = static_cast<double>(reflectance.z);
  const Vec3 wanted{log_luminance(r, g, b), weight_of_hue * log_ratio(r, g),
                    weight_of_hue * log_ratio(b, g)};
  const double usual = place_of_saturation(base_.saturation_dermis);
  const auto cost = [&](const Places& places) {
    const Vec3 miss = look_at(places) - wanted;
    const double unusual = weight_of_red * (places[2] - usual);
    return dot(miss, miss) + unusual * unusual;
  };
  const auto nearest_red = static_cast<std::size_t>(std::lround(usual));
  const std::span<const Vec3> usual_looks(&looks_[nearest_red * nodes * nodes], nodes * nodes);
  Places best{0.0, 0.0, usual};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < nodes; i += 3)
    for (std::size_t j = 0; j < nodes; j += 3) {
      const Vec3 miss = usual_looks[i * nodes + j] - wanted;
      if (const double c = dot(miss, miss); c < least)
        least = c, best = {static_cast<double>(i), static_cast<double>(j), usual};
    }
  least = cost(best);
  for (int step = 0; step < 12; ++step) {
    constexpr double h = 0.5;  // [node]: across the kinks between cells
    const Vec3 missing = wanted - look_at(best);
    std::array<Vec3, 3> slope{};
    Vec3 downhill{};
    for (std::size_t d = 0; d < 3; ++d) {
      Places below = best, above = best;
      below[d] = std::max(best[d] - h, 0.0), above[d] = std::min(best[d] + h, ends[d]);
      slope[d] = (look_at(above) - look_at(below)) / (above[d] - below[d]);
      downhill[static_cast<int>(d)] = dot(slope[d], missing);
    }
    downhill.z += weight_of_red * weight_of_red * (usual - best[2]);
    std::array<Vec3, 3> normal{};
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t e = 0; e < 3; ++e) normal[d][static_cast<int>(e)] = dot(slope[d], slope[e]);
      normal[d][static_cast<int>(d)] += d == 2 ? weight_of_red * weight_of_red : 1e-9;
    }
    for (std::size_t d = 0; d < 3; ++d) {
      const double down = downhill[static_cast<int>(d)];
      if (!((best[d] <= 0.0 && down < 0.0) || (best[d] >= ends[d] && down > 0.0))) continue;
      for (std::size_t e = 0; e < 3; ++e)
        normal[d][static_cast<int>(e)] = normal[e][static_cast<int>(d)] = d == e ? 1.0 : 0.0;
      downhill[static_cast<int>(d)] = 0.0;
    }
    const double determinant = dot(normal[0], cross(normal[1], normal[2]));
    const Vec3 move =
        Vec3{dot(downhill, cross(normal[1], normal[2])), dot(normal[0], cross(downhill, normal[2])),
             dot(normal[0], cross(normal[1], downhill))} /
        determinant;
    const double before = least;
    for (double share = 1.0; share > 1e-2 && least >= before; share *= 0.5) {
      Places there{};
      for (std::size_t d = 0; d < 3; ++d)
        there[d] = std::clamp(best[d] + share * move[static_cast<int>(d)], 0.0, ends[d]);
      if (const double c = cost(there); c < least) least = c, best = there;
    }
    if (!(least < before - 1e-7)) break;
  }
  const Vec3 miss = look_at(best) - wanted;
  SkinParameters skin = base_;
  skin.melanin = melanin_range.at(best[0] / ends[0]);
  skin.hemoglobin_dermis = blood_range.at(best[1] / ends[1]);
  make_redder(best[2], skin);
  return {skin, std::sqrt(miss.x * miss.x +
                          (miss.y * miss.y + miss.z * miss.z) / (weight_of_hue * weight_of_hue))};
}

ColorMatch match_exposure(const SkinOfColor& table, std::span<const Vec3f> colors) {
  const auto match = [&](double exposure) {
    std::vector<double> errors(colors.size());
    parallel_for(colors.size(), [&](std::size_t i) {
      errors[i] = table.at(static_cast<float>(exposure) * colors[i]).error;
    });
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::ranges::nth_element(errors, middle);
    return ColorMatch{.exposure = exposure, .error = *middle};
  };
  ColorMatch best = match(1.0);
  for (double stops = -3.0; stops < 1.01; stops += 0.125) {
    const ColorMatch other = match(std::exp2(stops));
    if (other.error < best.error) best = other;
  }
  return best;
}

}  // namespace lamina
