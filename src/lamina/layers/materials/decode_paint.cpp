// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/materials/pigments.h"
#include "lamina/layers/optics/mie.h"

namespace lamina::material_file {
namespace {

constexpr double smallest_radius = 1e-6, largest_radius = 0.01;  // [mm]
constexpr double largest_grain = 0.1;                            // [mm], of a spread of radii

/// The largest radius that mie_bulk looks at [mm].
double largest_of(const Particles& particles) {
  const double sigma = particles.sigma_log_radius;
  return particles.median_radius * std::exp(2.5 * sigma * sigma + 6.0 * sigma);
}

/// Particles of one kind with their index in each band.
struct DecodedPigment {
  std::string name;
  Particles particles;  ///< but for the index
  std::vector<std::complex<double>> ior;
};

const Pigment& known_pigment(const JsonInput& name) {
  std::vector<std::string_view> names;
  for (const Pigment& pigment : pigments()) names.push_back(pigment.name);
  return pigments()[name.choice(names)];
}

/// The index of particles that are not known by name: "ior" and, where they absorb, "k".
std::vector<std::complex<double>> own_ior(const JsonObject& object, const Context& context) {
  const std::vector<double> n = decode_ior(object.required("ior"), context);
  std::vector<double> k(context.bands, 0.0);
  if (const auto given = object.optional("k"))
    k = decode_numbers(*given, closed_interval(0.0, 10.0), context);
  std::vector<std::complex<double>> ior;
  for (std::size_t band = 0; band < context.bands; ++band) ior.emplace_back(n[band], k[band]);
  return ior;
}

DecodedPigment decode_pigment(const JsonInput& value, std::size_t index, const Context& context) {
  const JsonObject object = value.object(
      {"name", "pigment", "ior", "k", "median_radius", "sigma_log_radius", "fraction"});
  DecodedPigment decoded;
  Particles& particles = decoded.particles;
  if (const auto known = object.optional("pigment")) {
    const Pigment& pigment = known_pigment(*known);
    for (const char* key : {"ior", "k"})
      if (const auto given = object.optional(key))
        given->fail("must be missing, because \"pigment\" says which index");
    decoded.name = pigment.name;
    particles.median_radius = pigment.median_radius;
    particles.sigma_log_radius = pigment.sigma_log_radius;
    for (const double wavelength : context.wavelengths)
      decoded.ior.push_back(pigment.ior(wavelength));
  } else {
    if (!object.has("ior"))
      value.fail("requires \"pigment\", a pigment that lamina knows, or its \"ior\"");
    decoded.ior = own_ior(object, context);
    (void)object.required("median_radius");
    particles.sigma_log_radius = 0.0;
  }
  if (const auto name = object.optional("name")) decoded.name = name->string();
  if (const auto radius = object.optional("median_radius"))
    particles.median_radius = plain_length(*radius, smallest_radius, largest_radius, context);
  if (const auto spread = object.optional("sigma_log_radius"))
    particles.sigma_log_radius = plain_number(*spread, closed_interval(0.0, 1.5));
  if (largest_of(particles) > largest_grain)
    value.fail("sigma_log_radius is too large for this median_radius: grains of more than 0.1 mm");
  particles.volume_fraction =
      mappable_number(object.required("fraction"),
                      {.of = MappableNumber::Of::fraction,
                       .part = index,
                       .name = "paint.pigments[" + std::to_string(index) + "].fraction",
                       .low = 0.0,
                       .high = 0.6},
                      context);
  return decoded;
}

/// The pigment as a part of a mixture; its coefficients are those of a volume full of it.
MixturePart mixture_part(const DecodedPigment& pigment, const std::vector<double>& binder_ior,
                         const Context& context) {
  MixturePart part{.name = pigment.name, .fraction = pigment.particles.volume_fraction};
  for (std::size_t band = 0; band < context.bands; ++band) {
    Particles particles = pigment.particles;
    particles.volume_fraction = 1.0;  // coefficients are proportional to it
    particles.ior = pigment.ior[band];
    const MieBulk bulk = mie_bulk(particles, binder_ior[band], context.wavelengths[band]);
    part.sigma_a.push_back(bulk.sigma_a);
    part.sigma_s.push_back(bulk.sigma_s);
    part.g.push_back(bulk.g);
  }
  return part;
}

}  // namespace

void decode_paint(const JsonInput& recipe, const Context& context, Material& material) {
  const JsonObject object = recipe.object({"binder_ior", "thickness", "pigments"});
  require_wavelengths(recipe, context, 380.0, 1000.0);
  MaterialLayer paint{.name = "paint",
                      .sigma_a = std::vector(context.bands, 0.0),
                      .sigma_s = std::vector(context.bands, 0.0),
                      .g = std::vector(context.bands, 0.0),
                      .ior = std::vector(context.bands, 1.5)};
  if (const auto ior = object.optional("binder_ior"))
    paint.ior = decode_numbers(*ior, closed_interval(1.0, 3.0), context);
  const JsonInput thickness = object.required("thickness");
  const bool is_infinite = thickness.is_string() && thickness.string() == "infinite";
  if (!is_infinite)
    paint.thickness = mappable_length(
        thickness,
        {.of = MappableNumber::Of::thickness, .name = "paint.thickness", .low = 1e-4, .high = 1e3},
        context);
  const JsonInput pigments = object.required("pigments");
  double sum = 0.0;
  for (const JsonInput& value : pigments.array(1, 100)) {
    const DecodedPigment pigment = decode_pigment(value, paint.mixture.size(), context);
    sum += pigment.particles.volume_fraction;
    paint.mixture.push_back(mixture_part(pigment, paint.ior, context));
  }
  if (sum > 0.6)
    pigments.fail("fractions must sum to at most 0.6, for more than that does not pack");
  material.layers = {std::move(paint)};
  add_to_source(material, "Mie scattering");
}

}  // namespace lamina::material_file
