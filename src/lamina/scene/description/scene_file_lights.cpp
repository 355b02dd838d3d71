// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/scene/description/internal/scene_file.h"
#include "lamina/scene/description/studio_environment.h"

namespace lamina::scene_file {
namespace {

constexpr NumberRange light_range = closed_interval(0.0, brightest);

PointLight decode_point(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object({"type", "name", "position", "intensity"});
  PointLight light{.position = decode_vector(object.required("position"), mm_per_unit),
                   .intensity = decode_color(object.required("intensity"), light_range)};
  // The file gives the irradiance one unit away.
  light.intensity *= static_cast<float>(mm_per_unit * mm_per_unit);
  return light;
}

SpotLight decode_spot(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object(
      {"type", "name", "position", "look_at", "intensity", "inner_angle", "outer_angle"});
  SpotLight light{.position = decode_vector(object.required("position"), mm_per_unit),
                  .intensity = decode_color(object.required("intensity"), light_range)};
  const JsonInput target = object.required("look_at");
  const Vec3 towards = decode_vector(target, mm_per_unit) - light.position;
  if (!(length(towards) > 0.0)) target.fail("must differ from the light's position");
  light.direction = normalize(towards);
  light.intensity *= static_cast<float>(mm_per_unit * mm_per_unit);
  const JsonInput outer = object.required("outer_angle");
  const double outer_angle =
      outer.number({.low = 0.0, .high = 180.0, .includes_low = false, .unit = "deg"});
  double inner_angle = 0.0;
  if (const auto inner = object.optional("inner_angle")) {
    inner_angle = inner->number(closed_interval(0.0, 180.0, "deg"));
    if (inner_angle > outer_angle) inner->fail("must not be larger than \"outer_angle\"");
  }
  constexpr double half_in_radians = std::numbers::pi / 360.0;
  light.cos_inner = static_cast<float>(std::cos(inner_angle * half_in_radians));
  light.cos_outer = static_cast<float>(std::cos(outer_angle * half_in_radians));
  return light;
}

SphereLight decode_sphere(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object({"type", "name", "position", "radius", "radiance"});
  return {.center = decode_vector(object.required("position"), mm_per_unit),
          .radius =
              mm_per_unit * object.required("radius").number(
                                {.low = 0.0, .high = longest / mm_per_unit, .includes_low = false}),
          .radiance = decode_color(object.required("radiance"), light_range)};
}

DirectionalLight decode_directional(const JsonInput& value) {
  const JsonObject object = value.object({"type", "name", "towards", "irradiance"});
  return {.direction = decode_direction(object.required("towards")),
          .irradiance = decode_color(object.required("irradiance"), light_range)};
}

RectangleLight decode_rectangle(const JsonInput& value, double mm_per_unit) {
  const JsonObject object =
      value.object({"type", "name", "position", "look_at", "up", "size", "radiance"});
  const Vec3 center = decode_vector(object.required("position"), mm_per_unit);
  const Vec3 target = decode_vector(object.required("look_at"), mm_per_unit);
  if (!(length(target - center) > 0.0))
    object.required("look_at").fail("must differ from the light's position");
  const Vec3 forward = normalize(target - center);
  Vec3 up{0, 1, 0};
  if (const auto given = object.optional("up")) {
    up = decode_direction(*given);
    if (length(cross(up, forward)) < 1e-6)
      given->fail("must not be parallel to the light's direction");
  } else if (length(cross(up, forward)) < 1e-3) {
    up = {0, 0, 1};  // a light straight above or below
  }
  const std::vector<double> size = object.required("size").number_or_numbers(
      2, {.low = 0.0, .high = longest / mm_per_unit, .includes_low = false});
  const Vec3 right = normalize(cross(up, forward));
  return {.center = center,
          .edge_u = mm_per_unit * size[0] * right,
          .edge_v = mm_per_unit * size[1] * cross(forward, right),
          .radiance = decode_color(object.required("radiance"), light_range)};
}

/// A file, or {"procedural": "studio"}.
std::size_t decode_environment_image(const JsonInput& value, Images& images) {
  if (value.is_object()) {
    constexpr std::array<std::string_view, 1> names = {"studio"};
    (void)value.object({"procedural"}).required("procedural").choice(names);
    return images.add(make_studio_environment());
  }
  const std::size_t index = images.load(value, ColorEncoding::srgb);
  for (float& number :
       images[index].pixels)  // resampling leaves tiny negative numbers in some maps
    number = std::max(number, 0.0F);
  return index;
}

EnvironmentLight decode_environment(const JsonInput& value, Images& images) {
  const JsonObject object =
      value.object({"type", "name", "image", "radiance", "scale", "rotation", "visible"});
  const auto image = object.optional("image"), radiance = object.optional("radiance");
  if (image.has_value() == radiance.has_value())
    value.fail(image ? "must have \"image\" or \"radiance\", but has both"
                     : "must have \"image\" or \"radiance\", but has neither");
  EnvironmentLight light;
  if (image) {
    light.image = decode_environment_image(*image, images);
    if (const auto scale = object.optional("scale"))
      light.scale = decode_color(*scale, light_range);
  } else {
    if (const auto scale = object.optional("scale")) scale->fail("is for an \"image\" only");
    light.scale = decode_color(*radiance, light_range);
  }
  if (const auto rotation = object.optional("rotation"))
    light.rotation = static_cast<float>(rotation->number(closed_interval(-1e6, 1e6, "deg")) *
                                        std::numbers::pi / 180.0);
  if (const auto visible = object.optional("visible")) light.is_visible = visible->boolean();
  return light;
}

}  // namespace

std::string decode_light_name(const JsonInput& value) {
  const auto given = value.peek("name");
  if (!given) return "";
  std::string name = given->string();
  const auto fits = [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || c == '_' ||
           c == '-';
  };
  if (name.empty() || name.size() > 64 || !std::ranges::all_of(name, fits))
    given->fail("must be 1 to 64 letters, digits, _ and -, but is \"" + name + "\"");
  return name;
}

Light decode_light(const JsonInput& value, Images& images, double mm_per_unit) {
  enum class Type { point, spot, sphere, directional, rectangle, environment };
  const auto given = value.peek("type");
  if (!given) value.fail("\"type\" is required, but missing");
  switch (given->choice<Type>({{"point", Type::point},
                               {"spot", Type::spot},
                               {"sphere", Type::sphere},
                               {"directional", Type::directional},
                               {"rectangle", Type::rectangle},
                               {"environment", Type::environment}})) {
    case Type::point:
      return decode_point(value, mm_per_unit);
    case Type::spot:
      return decode_spot(value, mm_per_unit);
    case Type::sphere:
      return decode_sphere(value, mm_per_unit);
    case Type::directional:
      return decode_directional(value);
    case Type::rectangle:
      return decode_rectangle(value, mm_per_unit);
    case Type::environment:
      break;
  }
  return decode_environment(value, images);
}

}  // namespace lamina::scene_file
