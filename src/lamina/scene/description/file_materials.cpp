// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/file_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "lamina/base/io/json_output.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/albedo_inversion/subsurface_color.h"
#include "lamina/solve/reflectance/material_totals.h"

namespace lamina {
namespace {

using Color = std::array<double, 3>;

/// Red, green and blue.
template <class Value>
Color each_of(const Value& value) {
  return {value(0), value(1), value(2)};
}

/// Absorption and scattering of a thin sheet of thickness 1 in diffuse light.
struct SheetCoefficients {
  double sigma_a = 0.0, sigma_s = 0.0;
};

/// Source: [KubelkaMunk1931]; S and K from R and T by the closed forms of [Kortum1969] §4.5, and
/// isotropic coefficients from those by K = 2 sigma_a, S = 3/4 sigma_s - 1/4 sigma_a [Gate1974].
SheetCoefficients kubelka_munk(double reflectance, double transmittance) {
  const double r = std::clamp(reflectance, 0.001, 0.997);
  const double t = std::clamp(transmittance, 0.001, 0.998 - r);
  const double a = std::max((1.0 + r * r - t * t) / (2.0 * r), 1.0 + 1e-6);
  const double b = std::sqrt(a * a - 1.0);
  const double s = std::asinh(b * r / t) / b;  // since T / R = b / sinh(b S)
  const double sigma_a = 0.5 * (a - 1.0) * s;
  return {.sigma_a = sigma_a, .sigma_s = (s + 0.25 * sigma_a) * 4.0 / 3.0};
}

/// Those that reflect and let through that much by radiative transfer: what Kubelka and Munk miss
/// is added to what they are asked for, a few times over.
SheetCoefficients sheet_of(double reflectance, double transmittance) {
  constexpr int steps = 8;
  const double most = 0.995 / std::max(reflectance + transmittance, 0.995);  // some is absorbed
  const double r = most * reflectance, t = most * transmittance;
  double r_asked = r, t_asked = t;
  SheetCoefficients found = kubelka_munk(r, t);
  for (int step = 0; step < steps; ++step) {
    const EnteredTotals totals = material_totals(LayerStack(
        {{.medium = {.sigma_a = found.sigma_a, .sigma_s = found.sigma_s, .g = 0.0, .ior = 1.0},
          .thickness = 1.0}}));
    r_asked += r - totals.reflectance;
    t_asked += t - totals.transmittance;
    found = kubelka_munk(r_asked, t_asked);
  }
  return found;
}

JsonOutput file_of_layer(const JsonOutput& layer) {
  JsonOutput file = JsonOutput::object();
  file["lamina"] = "material";
  file["version"] = 1;
  file["length_unit"] = "mm";
  file["bands"] = "rgb";
  file["layers"].push_back(layer);
  return file;
}

class SceneMaterialWriter {
 public:
  SceneMaterialWriter(const FileMaterial& material, double mm_per_unit, int uv_set)
      : material_(material), mm_per_unit_(mm_per_unit), uv_set_(uv_set) {
    result_.ignored = material.ignored;
  }

  SceneMaterialText write() {
    const FileMaterial& m = material_;
    const bool attenuates = m.attenuation_distance > 0.0 && m.thickness > 0.0;
    if (m.metallic > 0.5) ignore("metallic: lamina has no metals");
    JsonOutput scene = JsonOutput::object();
    if (m.transmission >= 0.5)
      write_dielectric(scene);
    else if (attenuates && (m.multiscatter_color || m.diffuse_transmission > 0.0))
      write_volume(scene);
    else if (m.diffuse_transmission > 0.0)
      write_sheet(scene);
    else
      write_diffuse(scene);
    if (m.normal_texture) {
      if (const auto map = texture(*m.normal_texture, "normal texture")) scene["normal_map"] = *map;
    } else if (m.bump_texture) {
      if (auto map = texture(*m.bump_texture, "bump texture")) {
        (*map)["scale"] = m.bump_scale * mm_per_unit_;
        scene["bump"] = *map;
      }
    }
    result_.json = scene.text();
    return std::move(result_);
  }

 private:
  void ignore(std::string what) { result_.ignored.push_back(std::move(what)); }

  std::optional<JsonOutput> texture(const FileTexture& given, const std::string& what) {
    if (given.uv_set != uv_set_) {
      ignore(what + ": it wants the texture coordinates " + std::to_string(given.uv_set) +
             ", and \"uv_set\" is " + std::to_string(uv_set_));
      return std::nullopt;
    }
    JsonOutput map = JsonOutput::object();
    map["map"] = given.map;
    if (given.repeat_u != 1.0 || given.repeat_v != 1.0)
      map["repeat"] = std::vector<double>{given.repeat_u, given.repeat_v};
    if (given.rotate != 0.0) map["rotate"] = given.rotate * 180.0 / std::numbers::pi;
    if (given.shift_u != 0.0 || given.shift_v != 0.0)
      map["shift"] = std::vector<double>{given.shift_u, given.shift_v};
    return map;
  }

  [[nodiscard]] double alpha() const { return material_.roughness * material_.roughness; }

  JsonOutput color() {
    JsonOutput result = JsonOutput::object();
    if (material_.base_color_texture)
      if (auto map = texture(*material_.base_color_texture, "base color texture")) {
        const std::string& said = material_.base_color_texture->encoding;
        result = *map;
        result["encoding"] = said.empty() ? "srgb" : said;
      }
    if (material_.has_vertex_colors) result["vertex_colors"] = true;
    if (result.size() == 0) return material_.base_color;
    result["value"] = material_.base_color;
    return result;
  }

  [[nodiscard]] bool varies() const {
    return material_.base_color_texture || material_.has_vertex_colors;
  }

  [[nodiscard]] bool is_white() const {
    return material_.base_color == Color{1, 1, 1} && !varies();
  }

  void write_coat(JsonOutput& scene) const {
    if (!material_.has_specular || material_.ior <= 1.0) return;
    scene["coat"] = {
        {"ior", std::min(material_.ior, 10.0)}, {"roughness", alpha()}, {"distribution", "ggx"}};
  }

  /// @return whether there are holes
  bool write_opacity(JsonOutput& scene) {
    const FileMaterial& m = material_;
    if (m.has_cutouts && m.base_color_texture) {
      if (auto map = texture(*m.base_color_texture, "alpha")) {
        (*map)["encoding"] = "srgb";
        if (m.opacity != 1.0) (*map)["value"] = m.opacity;
        scene["opacity"] = *map;
        return true;
      }
    } else if (m.opacity < 1.0) {
      scene["opacity"] = m.opacity;
      return true;
    }
    return false;
  }

  void write_diffuse(JsonOutput& scene) {
    scene["diffuse"] = color();
    write_coat(scene);
    const bool has_holes = write_opacity(scene);
    const Color& e = material_.emission;
    if (std::max({e[0], e[1], e[2]}) > 0.0) {
      if (has_holes)
        ignore("emission: of what has holes");
      else
        scene["emission"] = e;
    }
    if (material_.transmission > 0.0) ignore("transmission: less than a half");
  }

  void write_dielectric(JsonOutput& scene) {
    scene["dielectric"] = {{"ior", std::clamp(material_.ior, 1.0001, 10.0)},
                           {"roughness", alpha()},
                           {"distribution", "ggx"}};
    if (!is_white()) ignore("base color: dielectrics are clear");
    if (material_.attenuation_distance > 0.0 && material_.attenuation_color != Color{1, 1, 1})
      ignore("attenuation: dielectrics are clear");
  }

  void write_volume(JsonOutput& scene) {
    const FileMaterial& m = material_;
    const Color albedo = m.multiscatter_color.value_or(m.diffuse_transmission_color);
    // The boundary's roughness is the coat's, which shapes what is mirrored.
    const HalfSpaceLook look{.ior = boundary_ior(),
                             .g = std::clamp(m.scatter_anisotropy, -0.99, 0.99)};
    const auto scattered = [&](std::size_t c) {
      return subsurface_albedo(m.multiscatter_definition, albedo[c], look);
    };
    const auto sigma_t = [&](std::size_t c) {
      return -std::log(std::clamp(m.attenuation_color[c], 1e-4, 0.9999)) /
             (m.attenuation_distance * mm_per_unit_);
    };
    JsonOutput layer = JsonOutput::object();
    layer["name"] = "inside";
    layer["thickness"] = "infinite";
    layer["sigma_a"] = each_of([&](std::size_t c) { return sigma_t(c) * (1.0 - scattered(c)); });
    layer["sigma_s"] = each_of([&](std::size_t c) { return sigma_t(c) * scattered(c); });
    layer["g"] = look.g;
    layer["ior"] = look.ior;
    scene["subsurface"] = file_of_layer(layer);
    scene["subsurface"]["source"] = definition_text(m.multiscatter_definition);
    write_coat(scene);
    if (!is_white()) ignore("base color: the volume has its own");
  }

  /// That of the surface, which does not reflect where its format says so.
  [[nodiscard]] double boundary_ior() const {
    return material_.has_specular ? std::clamp(material_.ior, 1.0, 4.0) : 1.0;
  }

  void write_sheet(JsonOutput& scene) {
    const FileMaterial& m = material_;
    constexpr double thickness = 0.2;  // [mm]; only the optical one counts
    const auto coefficients = [&](std::size_t c) {
      const double base = varies() ? 1.0 : m.base_color[c];
      return sheet_of(base * (1.0 - m.diffuse_transmission),
                      m.diffuse_transmission_color[c] * m.diffuse_transmission);
    };
    JsonOutput layer = JsonOutput::object();
    layer["name"] = "sheet";
    layer["thickness"] = thickness;
    layer["sigma_a"] = each_of([&](std::size_t c) { return coefficients(c).sigma_a / thickness; });
    layer["sigma_s"] = each_of([&](std::size_t c) { return coefficients(c).sigma_s / thickness; });
    layer["g"] = 0.0;
    layer["ior"] = 1.0;
    scene["thin"] = file_of_layer(layer);
    scene["thin"]["ior_below"] = 1.0;
    if (varies()) scene["color"] = color();
    write_coat(scene);
    (void)write_opacity(scene);
  }

  const FileMaterial& material_;
  double mm_per_unit_;
  int uv_set_;
  SceneMaterialText result_;
};

}  // namespace

SceneMaterialText scene_material_text(const FileMaterial& material, double mm_per_unit,
                                      int uv_set) {
  return SceneMaterialWriter(material, mm_per_unit, uv_set).write();
}

}  // namespace lamina
