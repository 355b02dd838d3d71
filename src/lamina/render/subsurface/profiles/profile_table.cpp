// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/profile_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

using std::numbers::pi;

/// One band of a profile, between its radii a straight line in log-log, flat below the first.
class Curve {
 public:
  Curve(const Profile& profile, std::size_t band, bool is_transmittance)
      : profile_(profile), band_(band), is_transmittance_(is_transmittance) {}

  [[nodiscard]] double operator()(double r) const {
    const auto& radii = profile_.r;
    if (r <= radii.front()) return node(0);
    if (r >= radii.back()) return node(radii.size() - 1);
    const auto i = static_cast<std::size_t>(std::upper_bound(radii.begin(), radii.end(), r) -
                                            radii.begin() - 1);
    const double f = std::log(r / radii[i]) / std::log(radii[i + 1] / radii[i]);
    const double a = node(i), b = node(i + 1);
    return a > 0.0 && b > 0.0 ? a * std::pow(b / a, f) : a + f * (b - a);
  }

 private:
  [[nodiscard]] double node(std::size_t i) const {
    const double value =
        is_transmittance_ ? profile_.transmittance_at(i, band_) : profile_.reflectance_at(i, band_);
    return value > 0.0 ? value : 0.0;  // the ringing of a transform, far below its peak
  }
  const Profile& profile_;
  std::size_t band_;
  bool is_transmittance_;
};

/// Integral over a ring of a function that is linear in the logarithm of the radius.
double ring_integral(double r0, double r1, double f0, double f1) {
  // Substituting r = r0 e^(t L): 2 pi times the integral of f r^2 L dt, by parts.
  const double L = std::log(r1 / r0), a = r0 * r0, b = r1 * r1;
  const double flat = 0.5 * (b - a);                    // integral of r^2 L dt
  const double rising = 0.5 * b - (b - a) / (4.0 * L);  // of t r^2 L dt
  return 2.0 * pi * (f0 * (flat - rising) + f1 * rising);
}

/// Linear between the nodes before and after a place.
template <int N>
BandValues<N> value_at_place(const std::vector<BandValues<N>>& nodes, float place) {
  const auto i = static_cast<std::size_t>(place);
  const float f = place - static_cast<float>(i);
  return (1.0f - f) * nodes[i] + f * nodes[i + 1];
}

}  // namespace

RadiusGrid make_radius_grid(const std::vector<Profile>& profiles, double kept) {
  double reach = 0.0;
  for (const Profile& profile : profiles)
    for (std::size_t band = 0; band < profile.bands; ++band)
      for (const bool is_transmittance : {false, true}) {
        const Curve curve(profile, band, is_transmittance);
        const auto& r = profile.r;
        std::vector<double> within = {pi * r[0] * r[0] * curve(r[0])};
        for (std::size_t i = 1; i < r.size(); ++i)
          within.push_back(within.back() +
                           ring_integral(r[i - 1], r[i], curve(r[i - 1]), curve(r[i])));
        double all = within.back();
        if (!is_transmittance && profile.per == ProfilePer::entered_flux)
          all = std::max(all, profile.total_reflectance[band]);
        if (!(all > 1e-6)) continue;
        std::size_t i = 0;
        while (i + 1 < r.size() && within[i] < kept * all) ++i;
        reach = std::max(reach, r[i]);
      }
  if (!(reach > 0.0)) reach = 1.0;  // black
  return {
      .first = static_cast<float>(1e-5 * reach), .last = static_cast<float>(reach), .count = 512};
}

template <int N>
ProfileTable<N>::ProfileTable(const Profile& profile, const RadiusGrid& grid,
                              const BandValues<N>& per_entered)
    : log2_first_(std::log2(grid.first)),
      nodes_per_octave_(static_cast<float>(grid.count - 1) / std::log2(grid.last / grid.first)) {
  const auto count = static_cast<std::size_t>(grid.count);
  for (std::size_t i = 0; i < count; ++i)
    radii_.push_back(std::exp2(log2_first_ + static_cast<float>(i) / nodes_per_octave_));
  reflectance_.resize(count);
  transmittance_.resize(count);
  std::vector<double> mass(count, 0.0), mass_passing(count, 0.0);
  for (std::size_t b = 0; b < profile.bands; ++b) {
    const int band = static_cast<int>(b);
    for (const bool is_transmittance : {false, true}) {
      const Curve curve(profile, b, is_transmittance);
      auto& table = is_transmittance ? transmittance_ : reflectance_;
      std::vector<double> value;
      for (const float r : radii_)
        value.push_back(static_cast<double>(per_entered[band]) * curve(static_cast<double>(r)));
      const auto cell = [&](std::size_t i) {
        const auto r = static_cast<double>(radii_[i]);
        if (i == 0) return pi * r * r * value[0];
        return ring_integral(static_cast<double>(radii_[i - 1]), r, value[i - 1], value[i]);
      };
      double total = 0.0;
      for (std::size_t i = 0; i < count; ++i) total += cell(i);
      double scale = 1.0;
      if (!is_transmittance && profile.per == ProfilePer::entered_flux && total > 0.0)
        scale = std::clamp(profile.total_reflectance[b] / total, 0.9, 1.1);
      std::vector<double> mass_of_band;
      for (std::size_t i = 0; i < count; ++i) {
        table[i][band] = static_cast<float>(scale * value[i]);
        mass_of_band.push_back(scale * cell(i));
        mass[i] += mass_of_band.back();
        if (is_transmittance) mass_passing[i] += mass_of_band.back();
      }
      if (!is_transmittance) of_band_.push_back(make_density(mass_of_band));
      (is_transmittance ? total_transmittance_ : total_reflectance_)[band] =
          static_cast<float>(scale * total);
    }
  }
  all_ = make_density(mass);
  passing_ = make_density(mass_passing);
}

template <int N>
typename ProfileTable<N>::Density ProfileTable<N>::make_density(
    const std::vector<double>& mass) const {
  double all = 0.0, running = 0.0;
  for (const double m : mass) all += m;
  Density density;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const auto r = static_cast<double>(radii_[i]);
    const double r_before = i > 0 ? static_cast<double>(radii_[i - 1]) : 0.0;
    const double share = all > 0.0 ? mass[i] / all : 1.0 / static_cast<double>(mass.size());
    running += share;
    density.per_area.push_back(static_cast<float>(share / (pi * (r * r - r_before * r_before))));
    density.cumulative.push_back(static_cast<float>(running));
  }
  density.cumulative.back() = 1.0f;
  return density;
}

template <int N>
float ProfileTable<N>::place(float r) const {
  const float at = (std::log2(std::max(r, radii_.front())) - log2_first_) * nodes_per_octave_;
  return std::clamp(at, 0.0f, static_cast<float>(radii_.size() - 1) * 0.999999f);
}

template <int N>
BandValues<N> ProfileTable<N>::reflectance_profile(float r) const {
  return value_at_place(reflectance_, place(r));
}

template <int N>
float ProfileTable<N>::reflectance_profile(float r, int band) const {
  const float at = place(r);
  const auto i = static_cast<std::size_t>(at);
  const float low = reflectance_[i][band], high = reflectance_[i + 1][band];
  return low + (at - static_cast<float>(i)) * (high - low);
}

template <int N>
BandValues<N> ProfileTable<N>::transmittance_profile(float r) const {
  return value_at_place(transmittance_, place(r));
}

template <int N>
float ProfileTable<N>::radius_in(std::size_t ring, float f) const {
  const float r0 = ring > 0 ? radii_[ring - 1] : 0.0f, r1 = radii_[ring];
  return std::sqrt(r0 * r0 + f * (r1 * r1 - r0 * r0));
}

template <int N>
float ProfileTable<N>::sample_radius(float u) const {
  const auto& ends = all_.cumulative;
  const auto at = std::upper_bound(ends.begin(), ends.end() - 1, u);
  const auto i = static_cast<std::size_t>(at - ends.begin());
  const float low = i > 0 ? ends[i - 1] : 0.0f;
  return radius_in(i, std::clamp((u - low) / std::max(ends[i] - low, 1e-12f), 0.0f, 1.0f));
}

template <int N>
std::size_t ProfileTable<N>::ring(float r) const {
  if (r <= radii_.front()) return 0;
  if (r >= radii_.back()) return radii_.size();
  // The logarithm may land one ring off where r lies on an edge; the densities meet there.
  return std::min(static_cast<std::size_t>(place(r)) + 1, radii_.size() - 1);
}

template class ProfileTable<4>;
template class ProfileTable<8>;
template class ProfileTable<16>;

}  // namespace lamina
