// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/decoded_spheres.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina::fit_detail {
namespace {

/// [row]
/// @param is_behind  the sample, where what is opposite to it is the wall unless said otherwise
std::vector<IntegratingSphere> decode_sphere(const JsonInput& value, std::size_t rows,
                                             bool is_behind) {
  const JsonObject object = value.object(
      {"diameter_mm", "sample_port_mm", "detector_port_mm", "entrance_port_mm", "open_port_mm",
       "wall_reflectance", "detector_reflectance", "standard_reflectance", "method", "baffle"});
  const NumberRange length = greater_than(0.0, "mm"), fraction = open_interval(0.0, 1.0);
  IntegratingSphere sphere{.diameter = object.required("diameter_mm").number(length),
                           .sample_port = object.required("sample_port_mm").number(length),
                           .detector_port = object.required("detector_port_mm").number(length)};
  if (const auto port = object.optional("entrance_port_mm"))
    sphere.entrance_port = port->number(at_least(0.0, "mm"));
  if (const auto port = object.optional("open_port_mm"))
    sphere.open_port = port->number(at_least(0.0, "mm"));
  if (const auto detector = object.optional("detector_reflectance"))
    sphere.detector_reflectance =
        detector->number({.low = 0.0, .high = 1.0, .includes_high = false});
  sphere.has_baffle = object.required("baffle").boolean();
  sphere.method = object.required("method").choice<SphereMethod>();
  const std::vector<double> walls =
      object.required("wall_reflectance").number_or_numbers(rows, fraction);
  std::vector<double> standards = walls;
  if (!is_behind || object.has("standard_reflectance"))
    standards = object.required("standard_reflectance")
                    .number_or_numbers(rows, {.low = 0.0, .high = 1.0, .includes_low = false});

  std::vector<IntegratingSphere> spheres(rows, sphere);
  for (std::size_t row = 0; row < rows; ++row) {
    spheres[row].wall_reflectance = walls[row];
    spheres[row].standard_reflectance = standards[row];
  }
  try {
    check_sphere(spheres.front());
  } catch (const InvalidInput& error) {
    value.fail(error.what());
  }
  return spheres;
}

}  // namespace

void decode_spheres(const JsonObject& entry, std::size_t rows, MeasuredSeries& series) {
  double smallest_port = 0.0;
  for (const auto& [key, quantity] :
       {std::pair{"reflectance_sphere", MeasuredQuantity::reflectance},
        std::pair{"transmittance_sphere", MeasuredQuantity::transmittance}}) {
    const auto value = entry.optional(key);
    if (!value) continue;
    if (std::ranges::count(series.points, quantity, &MeasuredPoint::quantity) == 0)
      value->fail("there is no \"" + std::string(name_of(quantity)) + "\" that it reads");
    if (series.incidence.is_diffuse)
      entry.required("incidence").refuse("must be \"normal\" or degrees with a sphere");
    const auto spheres = decode_sphere(*value, rows, quantity == MeasuredQuantity::transmittance);
    for (MeasuredPoint& point : series.points)
      if (point.quantity == quantity) point.sphere = spheres[point.band];
    const double port = spheres.front().sample_port;
    smallest_port = smallest_port > 0.0 ? std::min(smallest_port, port) : port;
  }
  const auto beam = entry.optional("beam_diameter_mm");
  if (!beam) return;
  if (smallest_port == 0.0)
    beam->fail("needs a \"reflectance_sphere\" or \"transmittance_sphere\"");
  series.beam_diameter = beam->number(at_least(0.0, "mm"));
  if (*series.beam_diameter > smallest_port)
    beam->refuse("must not exceed the sample's port, " + number_text(smallest_port) + " mm");
}

void take_iad_spheres(const JsonObject& entry, const MeasuredTable& table, MeasuredSeries& series) {
  const IadFile& iad = *table.iad();
  for (const std::string_view key : sphere_keys)
    if (const auto given = entry.optional(key)) given->fail("stands in the file of iad");
  if (const JsonInput unit = entry.required("unit"); unit.string() != "fraction")
    unit.refuse("must be \"fraction\" for a file of iad");
  if (iad.spheres == 0) {
    for (const std::string_view key : iad_keys)
      if (const auto given = entry.optional(key))
        given->fail("is of spheres, but the file has none");
    return;
  }
  const auto method = entry.required("method").choice<SphereMethod>();
  const bool has_baffle = entry.required("baffle").boolean();
  if (series.incidence.is_diffuse)
    entry.required("incidence").refuse("must be \"normal\" or degrees with a sphere");
  const NumberRange share = open_interval(0.0, 1.0);
  const std::vector<double> above = table.numbers("r_w", share),
                            below = table.has("t_w") ? table.numbers("t_w", share) : above,
                            standards = table.numbers(
                                "r_std", {.low = 0.0, .high = 1.0, .includes_low = false});
  for (MeasuredPoint& point : series.points) {
    if (point.quantity == MeasuredQuantity::unscattered_transmittance) continue;
    const bool is_reflected = point.quantity == MeasuredQuantity::reflectance;
    IntegratingSphere sphere = is_reflected ? iad.above : iad.below;
    const std::vector<double>& walls = is_reflected ? above : below;
    if (!walls.empty()) sphere.wall_reflectance = walls[point.band];
    if (!is_reflected) sphere.standard_reflectance = sphere.wall_reflectance;
    if (is_reflected && !standards.empty()) sphere.standard_reflectance = standards[point.band];
    sphere.method = method;
    sphere.has_baffle = has_baffle;
    try {
      check_sphere(sphere);
    } catch (const InvalidInput& error) {
      entry.required("file").fail(std::string(is_reflected ? "reflectance" : "transmittance") +
                                  " sphere: " + error.what());
    }
    point.sphere = sphere;
    if (iad.beam_diameter > sphere.sample_port)
      entry.required("file").fail("the beam must not exceed the sample's port, " +
                                  number_text(sphere.sample_port) + " mm, but is " +
                                  number_text(iad.beam_diameter));
  }
  series.beam_diameter = iad.beam_diameter;
}

}  // namespace lamina::fit_detail
