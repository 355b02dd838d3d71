// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/integrating_sphere/integrating_sphere.h"

#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

/// Ports may take so much of the sphere, where more would be no sphere.
constexpr double largest_port_share = 0.5;

/// Of the sphere's surface: the cap that a flat port cuts off.
double port_share(double port, double sphere) {
  const double sine = port / sphere;
  return 0.5 * (1.0 - std::sqrt(1.0 - sine * sine));
}

/// Shares of the surface.
struct SphereShares {
  double sample, detector, open, wall;
};

SphereShares sphere_shares(const IntegratingSphere& sphere) {
  const auto share = [&](double port) { return port_share(port, sphere.diameter); };
  SphereShares shares{.sample = share(sphere.sample_port),
                      .detector = share(sphere.detector_port),
                      .open = share(sphere.entrance_port) + share(sphere.open_port),
                      .wall = 1.0};
  shares.wall -= shares.sample + shares.detector + shares.open;
  return shares;
}

/// A number and its derivative by the reflectance of what fills the sample's port.
struct ByReflectance {
  double value, slope;
};

/// How much light of the wall there is for what the wall emits: 1 / (1 - what comes back of it).
ByReflectance sphere_gain(const IntegratingSphere& sphere, const SphereShares& shares,
                          double reflectance) {
  // Without baffle a flat port of share a gets a of the wall's light and of that of other ports,
  // but none of its own, which is denser by 1 / (1 - a).
  const auto flat = [](double share, double r) { return 1.0 - share * (1.0 - r); };
  // With it the light of sample and detector meets the wall, or an open port.
  const auto kept = [&](double share) { return 1.0 - shares.open / (1.0 - share); };
  const double wall = sphere.wall_reflectance, r = reflectance, r_d = sphere.detector_reflectance;
  const auto [a_s, a_d, a_o, a_w] = shares;
  double back = 0.0, slope = 0.0;
  if (sphere.has_baffle) {
    back = wall * (a_w + r * a_s * kept(a_s) + r_d * a_d * kept(a_d));
    slope = wall * a_s * kept(a_s);
  } else {
    back = wall * a_w + r * a_s / flat(a_s, r) + r_d * a_d / flat(a_d, r_d);
    slope = a_s * (1.0 - a_s) / (flat(a_s, r) * flat(a_s, r));
  }
  const double gain = 1.0 / (1.0 - back);
  return {gain, gain * gain * slope};
}

/// How much light of the wall the light that a flat port scatters is worth, at once.
ByReflectance first_light(const IntegratingSphere& sphere, const SphereShares& shares,
                          double reflectance) {
  const double a_s = shares.sample;
  if (sphere.has_baffle) return {sphere.wall_reflectance * (1.0 - shares.open / (1.0 - a_s)), 0.0};
  const double first = 1.0 / (1.0 - a_s * (1.0 - reflectance));
  return {first, -a_s * first * first};
}

/// @param mirror     reflectance of where straight light arrives
/// @param reference  the signal that counts as 1, over the gain
/// @param reference_reflectance  of what is in the port then
SphereReading reading(const IntegratingSphere& sphere, const SphereShares& shares,
                      const SampleLight& light, double reflectance, double mirror, double reference,
                      double reference_reflectance) {
  ByReflectance gain{1.0, 0.0};
  if (sphere.method == SphereMethod::substitution) {
    gain = sphere_gain(sphere, shares, reflectance);
    reference *= sphere_gain(sphere, shares, reference_reflectance).value;
  }
  const ByReflectance first = first_light(sphere, shares, reflectance);
  const double signal = mirror * light.straight + first.value * light.scattered;
  return {.value = gain.value * signal / reference,
          .by_scattered = gain.value * first.value / reference,
          .by_straight = gain.value * mirror / reference,
          .by_diffuse_reflectance =
              (gain.slope * signal + gain.value * first.slope * light.scattered) / reference};
}

}  // namespace

void check_sphere(const IntegratingSphere& sphere) {
  const auto require = [](bool holds, const std::string& rule, double given) {
    if (!holds) throw InvalidInput(rule + ", but is " + number_text(given));
  };
  const auto require_port = [&](const std::string& name, double port, bool may_be_missing) {
    require(may_be_missing ? port >= 0.0 : port > 0.0,
            name + (may_be_missing ? " must be >= 0 [mm]" : " must be > 0 [mm]"), port);
    require(port < sphere.diameter,
            name + " must be smaller than the sphere, " + number_text(sphere.diameter) + " mm",
            port);
  };
  require(std::isfinite(sphere.diameter) && sphere.diameter > 0.0, "diameter must be > 0 [mm]",
          sphere.diameter);
  require_port("sample_port", sphere.sample_port, false);
  require_port("detector_port", sphere.detector_port, false);
  require_port("entrance_port", sphere.entrance_port, true);
  require_port("open_port", sphere.open_port, true);
  const double ports = 1.0 - sphere_shares(sphere).wall;
  require(
      ports <= largest_port_share,
      "the share of the sphere that its ports take must be <= " + number_text(largest_port_share),
      ports);
  require(0.0 < sphere.wall_reflectance && sphere.wall_reflectance < 1.0,
          "wall_reflectance must lie in (0, 1)", sphere.wall_reflectance);
  require(0.0 <= sphere.detector_reflectance && sphere.detector_reflectance < 1.0,
          "detector_reflectance must lie in [0, 1)", sphere.detector_reflectance);
  require(0.0 < sphere.standard_reflectance && sphere.standard_reflectance <= 1.0,
          "standard_reflectance must lie in (0, 1]", sphere.standard_reflectance);
}

SphereReading reflectance_reading(const IntegratingSphere& sphere, const SampleLight& reflected,
                                  double diffuse_reflectance) {
  const SphereShares shares = sphere_shares(sphere);
  const double standard = sphere.standard_reflectance;
  // The standard's signal is divided by its reflectance, so that 1 is a perfect one.
  return reading(sphere, shares, reflected, diffuse_reflectance, sphere.wall_reflectance,
                 first_light(sphere, shares, standard).value, standard);
}

SphereReading transmittance_reading(const IntegratingSphere& sphere, const SampleLight& transmitted,
                                    double diffuse_reflectance) {
  const double opposite = sphere.standard_reflectance;
  return reading(sphere, sphere_shares(sphere), transmitted, diffuse_reflectance, opposite,
                 opposite, 0.0);
}

}  // namespace lamina
