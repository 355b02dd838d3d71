// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "lamina/base/image/map_description.h"
#include "lamina/base/io/files_read.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/layers/materials/builtin_texts.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/scene/description/internal/scene_file.h"
#include "lamina/skin/maps/files/material_map_file.h"

namespace lamina::scene_file {
namespace {

/// What the numbers of an image are for.
enum class Use { color, scalar, coverage };

constexpr double largest_factor = 1e6;  // of a quantity; beyond, taken for a mistake

NoiseMap decode_noise(const JsonInput& value) {
  const JsonObject object = value.object({"kind", "size", "octaves", "seed"});
  NoiseMap noise;
  if (const auto kind = object.optional("kind")) noise.kind = kind->choice<NoiseMap::Kind>();
  noise.size = static_cast<float>(object.required("size").number(closed_interval(1e-6, 1e6, "mm")));
  if (const auto octaves = object.optional("octaves"))
    noise.octaves = static_cast<int>(octaves->integer(1, 16));
  if (const auto seed = object.optional("seed"))
    noise.seed = static_cast<std::uint32_t>(seed->integer(0, 0xffffffff));
  return noise;
}

/// Decodes materials one by one and remembers where the first image is.
class MaterialDecoder {
 public:
  explicit MaterialDecoder(Images& images) : images_(images) {}

  DecodedMaterial run(const std::string& name, const JsonInput& value) {
    result_.material.name = name;
    constexpr std::array<std::string_view, 4> kinds = {"subsurface", "diffuse", "dielectric",
                                                       "thin"};
    const auto count = std::ranges::count_if(
        kinds, [&](std::string_view kind) { return value.peek(kind).has_value(); });
    if (count == 1) {
      if (value.peek("subsurface"))
        decode_subsurface(value);
      else if (value.peek("diffuse"))
        decode_diffuse(value);
      else if (value.peek("dielectric"))
        decode_dielectric(value);
      else
        decode_thin(value);
      return std::move(result_);
    }
    // A misspelled key is named as such before the kind is missed.
    (void)value.object({"subsurface", "diffuse", "dielectric", "thin", "color", "color_use",
                        "thickness", "single_scattering_weight", "single_scattering_blur",
                        "opacity", "emission", "over", "coat", "bump", "normal_map"});
    value.fail(
        count == 0
            ? "must have \"subsurface\", \"diffuse\", \"dielectric\" or \"thin\", but has none"
            : "must have only one of \"subsurface\", \"diffuse\", \"dielectric\" and \"thin\"");
  }

 private:
  /// The keys of all kinds of materials.
  void decode_common(const JsonObject& object) {
    SurfaceMaterial& material = result_.material;
    if (const auto coat = object.optional("coat")) material.coat = decode_coat(*coat);
    if (const auto bump = object.optional("bump")) {
      const MapDescription map = decode_map_description(*bump);
      if (map.value) map.value->fail("\"scale\" and \"offset\" of a bump map are its heights [mm]");
      material.bump = texture_map(map, Use::scalar);
    }
    if (const auto normals = object.optional("normal_map")) {
      if (normals->is_object())
        (void)normals->object({"map", "repeat", "rotate", "shift"});  // no quantity to scale
      material.normal_map =
          image_map(normals->is_object() ? decode_map_description(*normals)
                                         : MapDescription{.self = *normals, .file = normals},
                    Use::scalar);
    }
  }

  void warn_of_sizes(std::span<const MaterialMap> maps) {
    const auto size = [](const MaterialMap& map) {
      return std::to_string(map.values.width) + " x " + std::to_string(map.values.height);
    };
    for (const MaterialMap& map : maps)
      if (size(map) != size(maps.front()))
        result_.warnings.push_back(map.number.name + ": " + size(map) + " texels, where " +
                                   maps.front().number.name + " has " + size(maps.front()) +
                                   ": each is resampled to the texels of the surface");
  }

  /// Oil on skin, as the recipe says, unless a coat says more.
  void decode_oiliness(const Material& layers, const std::optional<ScalarParameter>& map = {}) {
    if (map)
      result_.material.coat = Coat{.weight = *map};
    else if (layers.oiliness > 0.0)
      result_.material.coat = Coat{.weight = {.value = static_cast<float>(layers.oiliness)}};
  }

  void decode_subsurface(const JsonInput& value) {
    const JsonObject object =
        value.object({"subsurface", "color", "color_use", "thickness", "single_scattering_weight",
                      "single_scattering_blur", "maps", "over", "coat", "bump", "normal_map"});
    SubsurfaceSurface surface;
    std::optional<ScalarParameter> oiliness;
    const MaterialMaps take = [&](const MappableNumber& number,
                                  const JsonInput& map) -> std::vector<double> {
      if (number.of == MappableNumber::Of::roughness)
        map.fail("must be a number: in scenes a surface is as rough everywhere");
      if (number.of == MappableNumber::Of::oiliness) {
        oiliness = decode_scalar_parameter(map, closed_interval(0.0, 1.0));
        return {1.0};
      }
      surface.material_maps.push_back(decode_material_map(number, map, result_.warnings));
      return means_of(surface.material_maps.back());
    };
    surface.material = decode_layers_of(object.required("subsurface"), take);
    if (!surface.material_maps.empty()) {
      result_.mapped = "subsurface." + surface.material_maps.front().number.name;
      warn_of_sizes(surface.material_maps);
    }
    decode_oiliness(surface.material, oiliness);
    using ColorUse = SubsurfaceSurface::ColorUse;
    if (const auto color = object.optional("color")) {
      surface.color = decode_color_parameter(*color);
      surface.color_use = ColorUse::scale;
    }
    if (const auto use = object.optional("color_use")) {
      surface.color_use = use->choice<ColorUse>();
      if (!object.has("color")) use->fail("there is no \"color\" that it could be the use of");
    }
    surface.thickness.value = 0.0F;
    if (const auto thickness = object.optional("thickness")) {
      surface.thickness = decode_scalar_parameter(*thickness, closed_interval(0.0, longest, "mm"));
      if (std::isfinite(surface.material.layers.back().thickness))
        thickness->fail(
            "the layers of the material say how thick it is: leave it out, or make the last one "
            "infinite");
    }
    if (const auto weight = object.optional("single_scattering_weight"))
      surface.single_scattering_weight =
          decode_scalar_parameter(*weight, closed_interval(0.0, 1.0));
    if (const auto blur = object.optional("single_scattering_blur"))
      surface.single_scattering_blur =
          decode_scalar_parameter(*blur, closed_interval(0.0, longest, "mm"));
    if (const auto maps = object.optional("maps"))
      for (const auto& [key, given] : maps->entries()) {
        LayerMap map = find_quantity(given, key, surface.material);
        for (const MaterialMap& said : surface.material_maps)
          if (said.number.name == "skin." + key)
            given.fail("is a map in the recipe \"skin\" already; say it there only");
        if (given.is_array())
          for (const JsonInput& term : given.array(1, 16))
            map.terms.push_back(
                decode_scalar_parameter(term, closed_interval(0.0, largest_factor)));
        else
          map.terms.push_back(decode_scalar_parameter(given, closed_interval(0.0, largest_factor)));
        surface.maps.push_back(std::move(map));
      }
    surface.over = decode_coverings(object);
    result_.material.surface = std::move(surface);
    decode_common(object);
  }

  void decode_diffuse(const JsonInput& value) {
    const JsonObject object =
        value.object({"diffuse", "emission", "opacity", "over", "coat", "bump", "normal_map"});
    result_.material.surface =
        DiffuseSurface{.color = decode_color_parameter(object.required("diffuse")),
                       .over = decode_coverings(object)};
    decode_opacity(object);
    if (const auto emission = object.optional("emission")) {
      result_.material.emission = decode_color(*emission, closed_interval(0.0, brightest));
      if (object.has("opacity")) emission->fail("must not stand beside \"opacity\"");
    }
    decode_common(object);
  }

  void decode_thin(const JsonInput& value) {
    const JsonObject object =
        value.object({"thin", "color", "thickness", "opacity", "coat", "bump", "normal_map"});
    const JsonInput layers = object.required("thin");
    ThinSurface surface{.material = decode_layers_of(layers)};
    decode_oiliness(surface.material);
    if (std::isinf(surface.material.layers.back().thickness))
      layers.fail("must be a material of finite layers, but its last one is infinitely thick");
    if (const auto color = object.optional("color")) surface.color = decode_color_parameter(*color);
    if (const auto thickness = object.optional("thickness"))
      surface.thickness = decode_scalar_parameter(
          *thickness, {.low = 0.0, .high = longest, .includes_low = false, .unit = "mm"});
    result_.material.surface = std::move(surface);
    decode_opacity(object);
    decode_common(object);
  }

  std::vector<Covering> decode_coverings(const JsonObject& object) {
    std::vector<Covering> coverings;
    if (const auto over = object.optional("over"))
      for (const JsonInput& value : over->array(1, most_coverings))
        coverings.push_back(decode_covering(value));
    return coverings;
  }

  Covering decode_covering(const JsonInput& value) {
    const JsonObject object = value.object({"name", "material", "thickness", "coverage"});
    const JsonInput layers = object.required("material");
    Covering covering{.material = decode_layers_of(layers), .coverage = {.value = 1.0f}};
    covering.name = covering.material.name;
    if (const auto name = object.optional("name")) covering.name = name->string();
    double& last = covering.material.layers.back().thickness;
    if (const auto thickness = object.optional("thickness")) {
      if (std::isfinite(last))
        thickness->fail(
            "the layers of the material say how thick it is: leave it out, or make the last one "
            "infinite");
      last = thickness->number({.low = 0.0, .high = longest, .includes_low = false, .unit = "mm"});
    } else if (std::isinf(last)) {
      layers.fail("ends in a layer without end: say its \"thickness\" beside it");
    }
    if (const auto coverage = object.optional("coverage"))
      covering.coverage =
          decode_scalar_parameter(*coverage, closed_interval(0.0, 1.0), Use::coverage);
    return covering;
  }

  void decode_opacity(const JsonObject& object) {
    if (const auto opacity = object.optional("opacity"))
      result_.material.opacity =
          decode_scalar_parameter(*opacity, closed_interval(0.0, 1.0), Use::coverage);
  }

  void decode_dielectric(const JsonInput& value) {
    const JsonObject object = value.object({"dielectric", "coat", "bump", "normal_map"});
    const JsonObject inner =
        object.required("dielectric")
            .object({"ior", "roughness", "smoothness", "distribution", "scattering"});
    DielectricSurface surface;
    surface.ior = static_cast<float>(inner.required("ior").number(closed_interval(0.1, 10.0)));
    if (const auto roughness = inner.optional("roughness"))
      surface.roughness = decode_scalar_parameter(*roughness, closed_interval(0.0, 1.0));
    if (const auto smoothness = inner.optional("smoothness")) {
      if (inner.has("roughness")) smoothness->fail("must not stand beside \"roughness\"");
      surface.smoothness = decode_scalar_parameter(*smoothness, closed_interval(0.1, 1e4));
    }
    if (const auto distribution = inner.optional("distribution"))
      surface.distribution = decode_distribution(*distribution);
    if (const auto scattering = inner.optional("scattering")) {
      surface.scattering = scattering->choice<FacetScattering>();
      if (surface.scattering == FacetScattering::xu_sun &&
          surface.distribution == MicrofacetDistribution::ggx)
        scattering->fail("\"xu_sun\" has Gaussian slopes, which is \"beckmann\"");
    }
    result_.material.surface = surface;
    decode_common(object);
  }

  Coat decode_coat(const JsonInput& value) {
    const JsonObject object =
        value.object({"ior", "roughness", "weight", "distribution", "second_lobe"});
    Coat coat;
    if (const auto ior = object.optional("ior"))
      coat.ior = static_cast<float>(ior->number(closed_interval(1.0, 10.0)));
    if (const auto roughness = object.optional("roughness"))
      coat.roughness = decode_scalar_parameter(*roughness, closed_interval(0.0, 1.0));
    if (const auto weight = object.optional("weight"))
      coat.weight = decode_scalar_parameter(*weight, closed_interval(0.0, 1.0));
    if (const auto distribution = object.optional("distribution"))
      coat.distribution = decode_distribution(*distribution);
    if (const auto second = object.optional("second_lobe")) {
      const JsonObject lobe = second->object({"roughness", "share"});
      coat.second = Coat::SecondLobe{.roughness = decode_scalar_parameter(
                                         lobe.required("roughness"), closed_interval(0.0, 1.0))};
      if (const auto share = lobe.optional("share"))
        coat.second->share = decode_scalar_parameter(*share, closed_interval(0.0, 1.0));
    }
    return coat;
  }

  static MicrofacetDistribution decode_distribution(const JsonInput& value) {
    return value.choice<MicrofacetDistribution>();
  }

  /// A built-in material by name, a material file by path, or a material file as an object.
  static Material decode_layers_of(const JsonInput& value, const MaterialMaps& maps = {}) {
    if (value.is_object() && value.peek("diffuse_color")) return decode_color_material(value);
    if (value.is_object()) return decode_material(value, maps);
    if (!value.is_string())
      value.refuse("must be a built-in material, a material file, or what one says");
    const std::string name = value.string();
    const auto& names = builtin_material_names();
    if (std::ranges::find(names, name) != names.end()) return find_material(name);
    std::error_code ignored;
    note_file(value.file_path());  // also where it may come to be
    const bool looks_like_a_file = name.find_first_of("./\\") != std::string::npos;
    if (!looks_like_a_file && !std::filesystem::exists(value.file_path(), ignored))
      value.fail("there is no built-in material and no file \"" + name + "\"" +
                 did_you_mean(name, names));
    return load_for(value, [&] { return load_material(value.file_path(), value.memory(), maps); });
  }

  ColorParameter decode_color_parameter(const JsonInput& value) {
    ColorParameter parameter;
    if (value.is_string() && value.string() == "vertex_colors") {
      parameter.map = TextureMap{.source = VertexColorMap{}};
      result_.vertex_colored = value.path();
      return parameter;
    }
    if (value.is_string())
      value.refuse(
          "must be a number or an array of 3 numbers, an object with \"map\" or \"noise\", or "
          "\"vertex_colors\"");
    if (!value.is_object()) {
      parameter.value = decode_color(value, closed_interval(0.0, 1.0));
      return parameter;
    }
    const MapDescription map = decode_map_description(value, true);
    if (map.value) parameter.value = decode_color(*map.value, closed_interval(0.0, 1.0));
    parameter.map = texture_map(map, Use::color);
    return parameter;
  }

  ScalarParameter decode_scalar_parameter(const JsonInput& value, const NumberRange& range,
                                          Use use = Use::scalar) {
    ScalarParameter parameter;
    if (!value.is_object()) {
      parameter.value = static_cast<float>(value.number(range));
      return parameter;
    }
    const MapDescription map = decode_map_description(value);
    if (map.value) parameter.value = static_cast<float>(map.value->number(range));
    parameter.map = texture_map(map, use);
    return parameter;
  }

  TextureMap texture_map(const MapDescription& map, Use use) {
    TextureMap texture{.scale = static_cast<float>(map.scale),
                       .offset = static_cast<float>(map.offset),
                       .low = static_cast<float>(map.low),
                       .high = static_cast<float>(map.high)};
    if (map.has_vertex_colors) result_.vertex_colored = map.self.path();
    if (map.noise && map.has_vertex_colors)
      map.self.fail("\"vertex_colors\" goes with a \"map\" or alone, not with \"noise\"");
    if (map.noise) {
      texture.source = decode_noise(*map.noise);
    } else if (map.file) {
      texture.source = image_map(map, use);
      if (map.has_vertex_colors) texture.vertex_colors = VertexColorMap{};
    } else {
      texture.source = VertexColorMap{};
    }
    return texture;
  }

  ImageMap image_map(const MapDescription& map, Use use) {
    const ColorEncoding encoding = encoding_of(map, use == Use::color);
    if (map.channel && use == Use::color)
      map.channel->fail("is for quantities: a color takes red, green and blue");
    const JsonInput& file = *map.file;
    if (result_.mapped.empty()) result_.mapped = file.path();
    if (is_tiled(file)) {
      refuse_placement(map, "must be left out, for the tiles of <UDIM> do not repeat");
      ImageMap tiled;
      tiled.tiles = images_.load_tiles(file, encoding, map.channel, use == Use::coverage);
      tiled.image = images_of(tiled).front();
      result_.tiled.push_back({tiled, file});
      return tiled;
    }
    const std::size_t image = map.channel ? images_.load_channel(file, encoding, *map.channel)
                              : use == Use::coverage ? images_.load_coverage(file, encoding)
                                                     : images_.load(file, encoding);
    return {.image = image, .placement = placement_of(map)};
  }

  Images& images_;
  DecodedMaterial result_;
};

}  // namespace

DecodedMaterial decode_surface_material(const std::string& name, const JsonInput& value,
                                        Images& images) {
  return MaterialDecoder(images).run(name, value);
}

}  // namespace lamina::scene_file
