// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/internal/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "lamina/scene/mesh/files/internal/gltf_buffers.h"

namespace lamina {
namespace {

class MaterialReader {
 public:
  MaterialReader(const JsonInput& root, const std::filesystem::path& file)
      : file_(file),
        textures_(gltf_list(root, "textures")),
        images_(gltf_list(root, "images")),
        materials_(gltf_list(root, "materials")) {}

  std::vector<FileMaterial> read() {
    std::vector<FileMaterial> result;
    for (const JsonInput& material : materials_) result.push_back(read(material));
    return result;
  }

 private:
  FileMaterial read(const JsonInput& input) {
    FileMaterial material{};
    result_ = &material;
    alpha_ = 1.0;
    if (const auto name = input.peek("name"); name && name->is_string())
      material.name = name->string();
    if (const auto pbr = input.peek("pbrMetallicRoughness"))
      read_base(*pbr);
    else
      material.metallic = 1.0;
    if (const auto normal = input.peek("normalTexture")) {
      material.normal_texture = texture(*normal);
      if (number(*normal, "scale", 1.0) != 1.0) ignore("normalTexture.scale");
    }
    if (input.peek("occlusionTexture")) ignore("occlusionTexture");
    material.emission = color(input, "emissiveFactor", {0, 0, 0});
    if (input.peek("emissiveTexture")) {
      ignore("emissiveTexture");
      material.emission = {0, 0, 0};
    }
    if (const auto mode = input.peek("alphaMode"); mode && mode->string() != "OPAQUE") {
      material.has_cutouts = material.base_color_texture.has_value();
      material.opacity = alpha_;
    }
    if (const auto extensions = input.peek("extensions"))
      for (const auto& [name, extension] : extensions->entries()) read_extension(name, extension);
    return material;
  }

  void read_base(const JsonInput& pbr) {
    FileMaterial& material = *result_;
    if (const auto factor = pbr.peek("baseColorFactor")) {
      std::vector<double> c = factor->numbers(4);
      for (double& each : c) each = std::clamp(each, 0.0, 1.0);
      material.base_color = {c[0], c[1], c[2]};
      alpha_ = c[3];
    }
    if (const auto base = pbr.peek("baseColorTexture"))
      material.base_color_texture = texture(*base);
    material.metallic = number(pbr, "metallicFactor", 1.0);
    material.roughness = number(pbr, "roughnessFactor", 1.0);
    if (pbr.peek("metallicRoughnessTexture")) {
      ignore("metallicRoughnessTexture");
      material.metallic = 0.0;  // most of what has one is no metal
    }
  }

  void read_extension(const std::string& name, const JsonInput& extension) {
    FileMaterial& material = *result_;
    const auto ignore_texture = [&](std::string_view key) {
      if (extension.peek(key)) ignore(name + "." + std::string(key));
    };
    if (name == "KHR_materials_ior") {
      material.ior = number(extension, "ior", 1.5, 0.0, 10.0);
    } else if (name == "KHR_materials_transmission") {
      material.transmission = number(extension, "transmissionFactor", 0.0);
      ignore_texture("transmissionTexture");
    } else if (name == "KHR_materials_volume") {
      material.thickness = number(extension, "thicknessFactor", 0.0, 0.0, 1e9);
      material.attenuation_distance = number(extension, "attenuationDistance", 0.0, 0.0, 1e9);
      material.attenuation_color = color(extension, "attenuationColor", {1, 1, 1});
      ignore_texture("thicknessTexture");
    } else if (name == "KHR_materials_volume_scatter" || name == "KHR_materials_scatter") {
      // The drafts have two names for it.
      const auto with = color(extension, "multiscatterColor", {0, 0, 0});
      material.multiscatter_color = color(extension, "multiscatterColorFactor", with);
      material.scatter_anisotropy = number(extension, "scatterAnisotropy", 0.0, -1.0, 1.0);
      ignore_texture("multiscatterColorTexture");
    } else if (name == "KHR_materials_diffuse_transmission") {
      material.diffuse_transmission = number(extension, "diffuseTransmissionFactor", 0.0);
      material.diffuse_transmission_color =
          color(extension, "diffuseTransmissionColorFactor", {1, 1, 1});
      ignore_texture("diffuseTransmissionTexture");
      ignore_texture("diffuseTransmissionColorTexture");
    } else if (name == "KHR_materials_emissive_strength") {
      const double strength = number(extension, "emissiveStrength", 1.0, 0.0, 1e12);
      for (double& c : material.emission) c *= strength;
    } else if (name == "KHR_materials_specular") {
      material.has_specular = number(extension, "specularFactor", 1.0) > 0.0;
      ignore_texture("specularTexture");
      ignore_texture("specularColorFactor");
      ignore_texture("specularColorTexture");
    } else {
      ignore(name);
    }
  }

  void ignore(std::string name) { result_->ignored.push_back(std::move(name)); }

  static double number(const JsonInput& object, std::string_view key, double otherwise,
                       double low = 0.0, double high = 1.0) {
    const auto value = object.peek(key);
    return value ? std::clamp(value->number(), low, high) : otherwise;
  }

  static std::array<double, 3> color(const JsonInput& object, std::string_view key,
                                     const std::array<double, 3>& otherwise) {
    const auto value = object.peek(key);
    if (!value) return otherwise;
    const std::vector<double> c = value->numbers(3);
    return {std::clamp(c[0], 0.0, 1.0), std::clamp(c[1], 0.0, 1.0), std::clamp(c[2], 0.0, 1.0)};
  }

  std::optional<FileTexture> texture(const JsonInput& info) {
    const auto index = info.peek("index");
    if (!index) info.fail("\"index\" is required, but missing");
    const auto source = gltf_element(textures_, *index).peek("source");
    if (!source) {  // that of an extension: WebP, KTX2
      ignore("an image that is no PNG or JPEG");
      return std::nullopt;
    }
    const JsonInput& image = gltf_element(images_, *source);
    FileTexture result;
    if (const auto uri = image.peek("uri"); uri && !uri->string().starts_with("data:"))
      (void)gltf_path(*uri, {});  // refuses what leads out of the folder
    result.map = file_.filename().string() + "#" +
                 std::to_string(static_cast<std::size_t>(source->number()));
    if (const auto set = info.peek("texCoord"))
      result.uv_set = static_cast<int>(set->integer(0, 1000));
    result.place = info.where();
    const auto extensions = info.peek("extensions");
    if (const auto moved = extensions ? extensions->peek("KHR_texture_transform") : std::nullopt)
      read_transform(*moved, result);
    return result;
  }

  /// KHR_texture_transform: uv' = offset + R(rotation) (scale uv), with v downward there and R
  /// counterclockwise as one sees the image, R = [[cos, sin], [-sin, cos]]. With v upward it is the
  /// same turn, and the shift takes up where the axes start.
  static void read_transform(const JsonInput& moved, FileTexture& into) {
    const NumberRange range = closed_interval(-1e4, 1e4);
    const auto pair = [&](std::string_view key, double otherwise) {
      const auto given = moved.peek(key);
      return given ? given->numbers(2, range) : std::vector<double>{otherwise, otherwise};
    };
    const std::vector<double> scale = pair("scale", 1.0), offset = pair("offset", 0.0);
    if (const auto rotation = moved.peek("rotation")) into.rotate = rotation->number(range);
    if (const auto set = moved.peek("texCoord"))
      into.uv_set = static_cast<int>(set->integer(0, 1000));
    into.repeat_u = scale[0], into.repeat_v = scale[1];
    into.shift_u = offset[0] + scale[1] * std::sin(into.rotate);
    into.shift_v = 1.0 - offset[1] - scale[1] * std::cos(into.rotate);
  }

  const std::filesystem::path& file_;
  std::vector<JsonInput> textures_, images_, materials_;
  FileMaterial* result_ = nullptr;
  double alpha_ = 1.0;
};

}  // namespace

FileMaterial default_gltf_material() {
  return {.name = "default material of glTF", .metallic = 1.0};
}

std::vector<FileMaterial> decode_gltf_materials(const JsonInput& root,
                                                const std::filesystem::path& file) {
  return MaterialReader(root, file).read();
}

}  // namespace lamina
