// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/materialx_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/utf8_text.h"
#include "lamina/base/spectrum/rgb_encoding.h"
#include "lamina/scene/mesh/files/internal/mesh_text.h"
#include "lamina/scene/mesh/files/internal/xml_elements.h"

namespace lamina {
namespace {

using Color = std::array<double, 3>;

/// The names that the three surfaces have for one thing.
struct SurfaceNames {
  std::string_view base, base_color, roughness, ior, metallic, transmission, subsurface,
      subsurface_color, subsurface_radius, subsurface_scale, subsurface_anisotropy, thin_walled,
      emission, emission_color, specular, opacity;
};

std::optional<SurfaceNames> names_of_surface(std::string_view kind) {
  if (kind == "open_pbr_surface")
    return SurfaceNames{.base = "base_weight",
                        .base_color = "base_color",
                        .roughness = "specular_roughness",
                        .ior = "specular_ior",
                        .metallic = "base_metalness",
                        .transmission = "transmission_weight",
                        .subsurface = "subsurface_weight",
                        .subsurface_color = "subsurface_color",
                        .subsurface_radius = "subsurface_radius_scale",
                        .subsurface_scale = "subsurface_radius",
                        .subsurface_anisotropy = "subsurface_scatter_anisotropy",
                        .thin_walled = "geometry_thin_walled",
                        .emission = "emission_luminance",
                        .emission_color = "emission_color",
                        .specular = "specular_weight",
                        .opacity = "geometry_opacity"};
  if (kind == "standard_surface")
    return SurfaceNames{.base = "base",
                        .base_color = "base_color",
                        .roughness = "specular_roughness",
                        .ior = "specular_IOR",
                        .metallic = "metalness",
                        .transmission = "transmission",
                        .subsurface = "subsurface",
                        .subsurface_color = "subsurface_color",
                        .subsurface_radius = "subsurface_radius",
                        .subsurface_scale = "subsurface_scale",
                        .subsurface_anisotropy = "subsurface_anisotropy",
                        .thin_walled = "thin_walled",
                        .emission = "emission",
                        .emission_color = "emission_color",
                        .specular = "specular",
                        .opacity = "opacity"};
  if (kind == "gltf_pbr")
    return SurfaceNames{.base = {},
                        .base_color = "base_color",
                        .roughness = "roughness",
                        .ior = "ior",
                        .metallic = "metallic",
                        .transmission = "transmission",
                        .subsurface = {},
                        .subsurface_color = {},
                        .subsurface_radius = {},
                        .subsurface_scale = {},
                        .subsurface_anisotropy = {},
                        .thin_walled = {},
                        .emission = {},
                        .emission_color = "emissive",
                        .specular = "specular",
                        .opacity = "alpha"};
  return std::nullopt;
}

/// What the surfaces have where a file says nothing, as far as they differ from glTF.
struct SurfaceDefaults {
  double base = 1.0;
  Color base_color{0.8, 0.8, 0.8};
  double roughness = 0.3;
  Color subsurface_radius{1.0, 0.5, 0.25};
};

SurfaceDefaults defaults_of(std::string_view kind) {
  if (kind == "standard_surface") return {.roughness = 0.2, .subsurface_radius = {1.0, 1.0, 1.0}};
  if (kind == "gltf_pbr") return {.base_color = {1, 1, 1}, .roughness = 1.0};
  return {};
}

class MaterialXReader {
 public:
  MaterialXReader(const XmlElement& root, const std::string& name) : root_(root), name_(name) {}

  std::vector<FileMaterial> read() {
    if (root_.name != "materialx")
      throw FileError(name_ + ": must be a MaterialX file, but is <" + excerpt(root_.name) + ">");
    std::vector<FileMaterial> result;
    for (const XmlElement& element : root_.children) {
      if (element.name != "surfacematerial") continue;
      const XmlElement* input = input_of(element, "surfaceshader");
      const XmlElement* surface = input ? node_named(root_, input->attribute("nodename")) : nullptr;
      if (!surface) continue;
      const auto names = names_of_surface(surface->name);
      FileMaterial material{};
      material.name = element.attribute("name");
      ignored_.clear();
      if (names)
        read_surface(*surface, *names, material);
      else
        ignored_.insert("the surface " + surface->name);
      material.ignored.assign(ignored_.begin(), ignored_.end());
      result.push_back(std::move(material));
    }
    return result;
  }

 private:
  static const XmlElement* input_of(const XmlElement& node, std::string_view name) {
    if (name.empty()) return nullptr;
    const auto found = std::ranges::find_if(node.children, [&](const XmlElement& child) {
      return child.name == "input" && child.attribute("name") == name;
    });
    return found != node.children.end() ? &*found : nullptr;
  }

  static const XmlElement* node_named(const XmlElement& scope, std::string_view name) {
    const auto found = std::ranges::find_if(scope.children, [&](const XmlElement& child) {
      return !name.empty() && child.name != "input" && child.name != "output" &&
             child.attribute("name") == name;
    });
    return found != scope.children.end() ? &*found : nullptr;
  }

  /// The encoding of colors, by the innermost element that says one; empty: none does.
  [[nodiscard]] std::string color_space(std::string_view input,
                                        std::initializer_list<const XmlElement*> elements) const {
    for (const XmlElement* element : elements) {
      const std::string_view space = element->attribute("colorspace");
      if (space.empty()) continue;
      if (space == "none" || space == "raw") return "lin_rec709";
      if (!rgb_encoding_named(space))
        throw FileError(name_ + ": the color space of " + std::string(input) + " must be one of " +
                        names_of_color_spaces() + ", but is " + excerpt(space));
      return std::string(usual_rgb_encoding_name(space));
    }
    return {};
  }

  static std::string names_of_color_spaces() {
    std::string list;
    for (const std::string_view each : rgb_encoding_names())
      list += (list.empty() ? "" : ", ") + std::string(each);
    return list;
  }

  /// The node that an input is connected to, and where its own inputs find theirs.
  struct Connected {
    const XmlElement* node = nullptr;
    const XmlElement* scope = nullptr;
  };

  [[nodiscard]] Connected connected(const XmlElement& input, const XmlElement& scope) const {
    if (const XmlElement* node = node_named(scope, input.attribute("nodename")))
      return {node, &scope};
    const XmlElement* graph = node_named(root_, input.attribute("nodegraph"));
    if (!graph) return {};
    const std::string_view wanted = input.attribute("output");
    for (const XmlElement& output : graph->children)
      if (output.name == "output" && (wanted.empty() || output.attribute("name") == wanted))
        return {node_named(*graph, output.attribute("nodename")), graph};
    return {};
  }

  /// The image behind an input, through a normal map.
  std::optional<FileTexture> texture(const XmlElement& surface, std::string_view name) {
    const XmlElement* input = input_of(surface, name);
    if (!input) return std::nullopt;
    Connected at = connected(*input, root_);
    for (int step = 0; at.node && at.node->name == "normalmap" && step < 8; ++step) {
      const XmlElement* in = input_of(*at.node, "in");
      at = in ? connected(*in, *at.scope) : Connected{};
    }
    if (!at.node) return std::nullopt;
    if (at.node->name != "image" && at.node->name != "tiledimage" &&
        at.node->name != "gltf_image" && at.node->name != "gltf_colorimage") {
      ignored_.insert(std::string(name) + ": a node of the kind " + at.node->name);
      return std::nullopt;
    }
    const XmlElement* file = input_of(*at.node, "file");
    if (!file) return std::nullopt;
    FileTexture result{.map = std::string(file->attribute("value"))};
    const std::filesystem::path path = result.map;
    const bool leads_out = path.is_absolute() || std::ranges::find(path, "..") != path.end();
    if (result.map.empty() || leads_out || result.map.find('\0') != std::string::npos) {
      ignored_.insert(std::string(name) + ": an image outside of the folder of the file");
      return std::nullopt;
    }
    result.encoding = color_space(name, {file, at.node, at.scope, &root_});
    if (const XmlElement* tiling = input_of(*at.node, "uvtiling")) {
      const std::vector<double> times = numbers(*tiling);
      if (times.size() == 2) result.repeat_u = times[0], result.repeat_v = times[1];
    }
    return result;
  }

  [[nodiscard]] std::vector<double> numbers(const XmlElement& input) const {
    std::vector<double> result;
    std::string_view rest = input.attribute("value");
    while (!rest.empty()) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      std::string_view word = rest.substr(0, comma);
      rest.remove_prefix(std::min(comma + 1, rest.size()));
      while (word.starts_with(' ')) word.remove_prefix(1);
      while (word.ends_with(' ')) word.remove_suffix(1);
      const std::optional<double> value = spelled_number(word);
      if (!value || !std::isfinite(*value) || result.size() > 4)
        throw FileError(name_ + ": the value of " + std::string(input.attribute("name")) +
                        " must be numbers, but is \"" +
                        std::string(input.attribute("value").substr(0, 60)) + "\"");
      result.push_back(*value);
    }
    return result;
  }

  Color color(const XmlElement& surface, std::string_view name, const Color& otherwise,
              double most = 1.0) {
    const XmlElement* input = input_of(surface, name);
    if (!input || input->attribute("value").empty()) return otherwise;
    std::vector<double> v = numbers(*input);
    if (v.size() == 1) v = {v[0], v[0], v[0]};
    if (v.size() < 3) return otherwise;
    if (const std::string space = color_space(name, {input, &surface, &root_}); !space.empty()) {
      const Color linear = linear_rec709(*rgb_encoding_named(space), {v[0], v[1], v[2]});
      v.assign(linear.begin(), linear.end());
    }
    return {std::clamp(v[0], 0.0, most), std::clamp(v[1], 0.0, most), std::clamp(v[2], 0.0, most)};
  }

  double number(const XmlElement& surface, std::string_view name, double otherwise,
                double most = 1.0) {
    const XmlElement* input = input_of(surface, name);
    if (!input) return otherwise;
    if (input->attribute("value").empty()) {
      ignored_.insert(std::string(name) + ": an image of a number");
      return otherwise;
    }
    const std::vector<double> v = numbers(*input);
    return v.empty() ? otherwise : std::clamp(v[0], 0.0, most);
  }

  void read_surface(const XmlElement& surface, const SurfaceNames& names, FileMaterial& material) {
    const SurfaceDefaults defaults = defaults_of(surface.name);
    const double base = number(surface, names.base, defaults.base);
    material.base_color_texture = texture(surface, names.base_color);
    material.base_color = material.base_color_texture
                              ? Color{1, 1, 1}
                              : color(surface, names.base_color, defaults.base_color);
    for (double& c : material.base_color) c *= base;
    material.roughness = number(surface, names.roughness, defaults.roughness);
    material.ior = number(surface, names.ior, 1.5, 10.0);
    material.metallic = number(surface, names.metallic, 0.0);
    material.transmission = number(surface, names.transmission, 0.0);
    material.has_specular = number(surface, names.specular, 1.0) > 0.0;
    material.opacity = number(surface, names.opacity, 1.0);
    for (const std::string_view key : {"geometry_normal", "normal"})
      if (auto normal = texture(surface, key)) material.normal_texture = std::move(normal);
    const double emission =
        number(surface, names.emission, names.emission.empty() ? 1.0 : 0.0, 1e9);
    const Color emitted = color(surface, names.emission_color,
                                names.emission.empty() ? Color{0, 0, 0} : Color{1, 1, 1});
    for (std::size_t c = 0; c < 3; ++c) material.emission[c] = emission * emitted[c];
    if (const double share = number(surface, names.subsurface, 0.0); is_thin(surface, names))
      read_thin_subsurface(surface, names, share, material);
    else if (share >= 0.5)
      read_subsurface(surface, names, material);
    const std::set<std::string_view> taken = {names.base,
                                              names.base_color,
                                              names.roughness,
                                              names.ior,
                                              names.metallic,
                                              names.transmission,
                                              names.subsurface,
                                              names.subsurface_color,
                                              names.emission,
                                              names.subsurface_radius,
                                              names.subsurface_scale,
                                              names.emission_color,
                                              names.specular,
                                              names.opacity,
                                              names.thin_walled,
                                              names.subsurface_anisotropy,
                                              "geometry_normal",
                                              "normal"};
    for (const XmlElement& child : surface.children)
      if (child.name == "input" && !taken.contains(child.attribute("name")))
        ignored_.insert(std::string(child.attribute("name")));
  }

  [[nodiscard]] static bool is_thin(const XmlElement& surface, const SurfaceNames& names) {
    const XmlElement* input = input_of(surface, names.thin_walled);
    return input && input->attribute("value") == "true";
  }

  static Color default_scattered(const XmlElement& surface) {
    return surface.name == "open_pbr_surface" ? Color{0.8, 0.8, 0.8} : Color{1, 1, 1};
  }

  double anisotropy(const XmlElement& surface, const SurfaceNames& names) {
    const XmlElement* input = input_of(surface, names.subsurface_anisotropy);
    const std::vector<double> v = input ? numbers(*input) : std::vector<double>{};
    return v.empty() ? 0.0 : std::clamp(v[0], -1.0, 1.0);
  }

  /// A wall without thickness. OpenPBR parts its light between the sides by the anisotropy, both of
  /// one color; Standard Surface lets its subsurface color through.
  void read_thin_subsurface(const XmlElement& surface, const SurfaceNames& names, double share,
                            FileMaterial& material) {
    if (share <= 0.0) return;
    const Color scattered = color(surface, names.subsurface_color, default_scattered(surface));
    material.diffuse_transmission_color = scattered;
    if (surface.name != "open_pbr_surface") {
      material.diffuse_transmission = share;
    } else if (share >= 0.5) {
      material.diffuse_transmission = 0.5 * (1.0 + anisotropy(surface, names));
      material.base_color = scattered;
      material.base_color_texture.reset();
    }
  }

  /// The medium of a closed body, or a matte surface where light does not travel: the limit of
  /// both formats.
  void read_subsurface(const XmlElement& surface, const SurfaceNames& names,
                       FileMaterial& material) {
    const bool is_openpbr = surface.name == "open_pbr_surface";
    const SurfaceDefaults defaults = defaults_of(surface.name);
    const Color scattered = color(surface, names.subsurface_color, default_scattered(surface));
    const Color radius = color(surface, names.subsurface_radius, defaults.subsurface_radius, 1e6);
    const double scale = number(surface, names.subsurface_scale, 1.0, 1e6);
    const double longest = scale * std::max({radius[0], radius[1], radius[2]});
    material.base_color_texture.reset();
    if (longest == 0.0) {
      material.base_color = scattered;
      return;
    }
    // A channel that does not travel beside others that do: at a thousandth of theirs it does not
    // show that it travels.
    const auto length = [&](std::size_t c) { return std::max(scale * radius[c], 1e-3 * longest); };
    const double least = std::min({length(0), length(1), length(2)});
    material.multiscatter_color = scattered;
    material.multiscatter_definition =
        is_openpbr ? SubsurfaceColor::openpbr : SubsurfaceColor::standard_surface;
    material.scatter_anisotropy = anisotropy(surface, names);
    material.thickness = 1.0;
    material.attenuation_distance = least;
    for (std::size_t c = 0; c < 3; ++c)
      material.attenuation_color[c] = std::exp(-least / length(c));
    material.base_color = {1, 1, 1};  // that of the surface beside it
  }

  const XmlElement& root_;
  std::string name_;
  std::set<std::string> ignored_;
};

}  // namespace

std::vector<FileMaterial> parse_materialx(std::string_view text, const std::string& name) {
  const XmlElement root = parse_xml(text, name);
  return MaterialXReader(root, name).read();
}

std::vector<FileMaterial> load_materialx(const std::filesystem::path& file, MemoryBudget& memory) {
  const std::string bytes = read_file_bytes(file, memory);
  // Elements take more than their text: names, nodes of maps, room to grow.
  constexpr std::size_t growth = 32;
  MemoryBudget while_reading = memory;
  take_memory(while_reading, bytes.size(), growth, file.string() + ": its elements");
  return parse_materialx(bytes, file.string());
}

}  // namespace lamina
