// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lamina/base/core/enum_names.h"

namespace lamina {

/// Reference that a reading of a sphere is compared with.
enum class SphereMethod {
  substitution,  ///< the reference, which was in the sample's port before: the sphere has changed
  comparison     ///< a second beam in the same sphere, as of spectrometers with two beams
};

template <>
inline constexpr auto enum_names<SphereMethod> = std::to_array<EnumName<SphereMethod>>(
    {{"substitution", SphereMethod::substitution}, {"comparison", SphereMethod::comparison}});

/// An integrating sphere with a sample in one of its ports, which a beam from outside lights
/// directly. Ports are round and flat, and given by their diameter.
struct IntegratingSphere {
  double diameter = 150.0;            ///< inside [mm], > 0
  double sample_port = 20.0;          ///< [mm], > 0
  double detector_port = 10.0;        ///< [mm], > 0
  double entrance_port = 0.0;         ///< of the beam, open [mm]; 0 if it enters by the sample port
  double open_port = 0.0;             ///< another open one, as for the mirror reflection [mm]
  double wall_reflectance = 0.98;     ///< in (0, 1)
  double detector_reflectance = 0.0;  ///< of what fills its port, in [0, 1)
  /// In (0, 1]. Of the reference for reflectance; for transmittance of what is opposite to the
  /// sample, where the beam arrives that nothing scatters.
  double standard_reflectance = 0.99;
  bool has_baffle = true;  ///< sample and detector do not see each other
  SphereMethod method = SphereMethod::substitution;
};

/// @throws InvalidInput naming the number, the rule that it breaks and its value.
void check_sphere(const IntegratingSphere& sphere);

/// Light that a beam sends into the sphere at the sample, as fractions of it.
struct SampleLight {
  double scattered = 0.0;  ///< from the sample's face to all sides
  double straight = 0.0;   ///< as a beam onto the wall: mirrored, or let through unscattered
};

/// A reading, as a fraction: 1 would be a sample that sends all light of the beam into the sphere.
/// And its derivatives.
struct SphereReading {
  double value = 0.0;
  double by_scattered = 0.0, by_straight = 0.0, by_diffuse_reflectance = 0.0;
};

/// Reading of a sphere over the lit side: its reference is a standard in the sample's port.
///
/// @param reflected            what the sample reflects within the port
/// @param diffuse_reflectance  of the sample for diffuse light of the sphere that fills its port
///
/// Holds for a wall that scatters as Lambert's law has it, whose light is the same everywhere, and
/// a sample whose scattered light does, too. Flat ports see all of the sphere but themselves; the
/// formulas of [Pickering1993] and [Prahl2011] take them for parts of the wall, which differs by
/// the port's share of the sphere.
///
/// Source: balance of the light in the sphere, docs/fit_method.md; [Goebel1967], [Pickering1993].
[[nodiscard]] SphereReading reflectance_reading(const IntegratingSphere& sphere,
                                                const SampleLight& reflected,
                                                double diffuse_reflectance);

/// Reading of a sphere behind the sample: its reference is the beam through the empty port.
///
/// @param transmitted          what the sample lets through within the port
/// @param diffuse_reflectance  of the side that looks into the sphere
[[nodiscard]] SphereReading transmittance_reading(const IntegratingSphere& sphere,
                                                  const SampleLight& transmitted,
                                                  double diffuse_reflectance);

}  // namespace lamina
