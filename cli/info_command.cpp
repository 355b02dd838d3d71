// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "info_kinds.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/scene/description/file_materials.h"
#include "lamina/scene/description/plausible_size.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh_report.h"

namespace lamina::cli {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::string file;
  double mm_per_unit = 0.0;
  int uv_set = 0;
  std::vector<std::string> settings;
};

double longest_side(const FaceCounts& counts) {
  const Vec3f d = counts.high - counts.low;
  return static_cast<double>(std::max({d.x, d.y, d.z}));
}

JsonOutput json_of(const Vec3f& v) { return JsonOutput::array({v.x, v.y, v.z}); }

/// @param mm  of a unit; 0: unknown
JsonOutput json_of(const FaceCounts& counts, double mm) {
  const Vec3f size = counts.high - counts.low;
  JsonOutput json = {{"faces", counts.faces},
                     {"triangles", counts.triangles},
                     {"open_edges", counts.open_edges},
                     {"nonmanifold_edges", counts.nonmanifold_edges},
                     {"degenerate_faces", counts.degenerate_faces},
                     {"size", json_of(size)}};
  if (mm > 0.0) json["size_mm"] = json_of(static_cast<float>(mm) * size);
  return json;
}

JsonOutput json_of(const MeshReport& report, double mm) {
  JsonOutput json = json_of(report.counts, mm);
  json["vertices"] = report.vertices;
  json["surfaces"] = report.surfaces;
  json["closed"] = report.is_closed;
  json["uv_sets"] = report.uv_sets;
  json["uv_islands"] = report.uv_islands;
  json["faces_without_uv"] = report.faces_without_uv;
  json["udim_tiles"] = report.tiles;
  json["vertex_colors"] = report.has_colors;
  json["creases"] = report.creases;
  json["memory_bytes"] = rendering_memory(report.vertices, report.counts.triangles);
  return json;
}

std::string size_text(const Vec3f& size, double mm) {
  const auto s = [&](float x) { return static_cast<double>(x) * mm; };
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", s(size.x), s(size.y), s(size.z));
}

std::string counted(std::size_t count, const std::string& noun, const std::string& nouns) {
  return fmt::format("{} {}", count, count == 1 ? noun : nouns);
}

/// The lines that meshes of files and of scenes have in common.
std::string topology_text(const MeshReport& report) {
  const FaceCounts& c = report.counts;
  std::string text = fmt::format("  {:<10}{} of {}, {}\n", "faces", c.faces,
                                 counted(c.triangles, "triangle", "triangles"),
                                 counted(report.vertices, "vertex", "vertices"));
  text += fmt::format(
      "  {:<10}{}, {}; {} of more than two faces; {} without area\n", "surfaces", report.surfaces,
      report.is_closed ? std::string("closed") : counted(c.open_edges, "open edge", "open edges"),
      counted(c.nonmanifold_edges, "edge", "edges"), counted(c.degenerate_faces, "face", "faces"));
  if (report.uv_sets == 0) {
    text += fmt::format("  {:<10}no coordinates\n", "texture");
  } else {
    text += fmt::format("  {:<10}{} of coordinates, {}", "texture",
                        counted(static_cast<std::size_t>(report.uv_sets), "set", "sets"),
                        counted(report.uv_islands, "island", "islands"));
    if (report.faces_without_uv > 0)
      text += fmt::format(", {} without", counted(report.faces_without_uv, "face", "faces"));
    if (report.tiles != std::vector<int>{1001} && !report.tiles.empty()) {
      text += fmt::format(", UDIM tiles {}", report.tiles.front());
      if (report.tiles.size() > 1)
        text += fmt::format(" to {} ({})", report.tiles.back(), report.tiles.size());
    }
    text += "\n";
  }
  if (report.has_colors) text += fmt::format("  {:<10}of vertices\n", "colors");
  if (report.creases > 0)
    text += fmt::format("  {:<10}{}\n", "creases", counted(report.creases, "edge", "edges"));
  text += fmt::format("  {:<10}about {} when rendered\n", "memory",
                      memory_size_text(rendering_memory(report.vertices, c.triangles)));
  return text;
}

std::string joined(std::vector<std::string> texts, const std::string& by) {
  texts.erase(std::unique(texts.begin(), texts.end()), texts.end());
  return texts.empty() ? "(no name)" : fmt::format("{}", fmt::join(texts, by));
}

void show_mesh(const InfoOptions& options) {
  MemoryBudget memory = options.common.memory;
  const std::filesystem::path file = options.file;
  const PolygonMesh mesh = load_polygon_mesh(file, memory, {.uv_set = options.uv_set});
  const bool is_gltf = lower_case_ending(file) == ".glb" || lower_case_ending(file) == ".gltf";
  // glTF is in metres.
  const double mm = options.mm_per_unit > 0.0 ? options.mm_per_unit : is_gltf ? 1000.0 : 0.0;
  const MeshReport report = report_mesh(mesh);
  const Vec3f size = report.counts.high - report.counts.low;
  std::string text = fmt::format("{}\n", options.file);
  if (mm > 0.0) {
    text += fmt::format("  {:<10}{} mm, with mm_per_unit {:g}{}\n", "size", size_text(size, mm), mm,
                        is_gltf && options.mm_per_unit == 0.0 ? ", for glTF is in metres" : "");
  } else {
    text += fmt::format("  {:<10}{} units: the longest is {} if they are mm, {} if cm, {} if m\n",
                        "size", size_text(size, 1.0), length_text(longest_side(report.counts)),
                        length_text(10.0 * longest_side(report.counts)),
                        length_text(1000.0 * longest_side(report.counts)));
  }
  text += topology_text(report);
  JsonOutput result = make_result("info");
  result["file"] = options.file;
  result["kind"] = "mesh";
  if (mm > 0.0) result["mm_per_unit"] = mm;
  result.update(json_of(report, mm));
  std::vector<std::string> warnings = mesh.notes;
  if (const auto why = too_far_from_origin(mesh, "units"))
    warnings.push_back(options.file + ": " + *why);
  if (mm > 0.0)
    if (auto warning = implausible_size(options.file, mm * longest_side(report.counts), mm))
      warnings.push_back(std::move(*warning));

  result["parts"] = JsonOutput::array();
  text += fmt::format("  {:<10}{:>9} {:>10}  {}\n", "parts", "triangles", "open edges",
                      "names, by which \"parts\" of a scene finds them");
  for (std::size_t p = 0; p < report.parts.size(); ++p) {
    const PartReport& part = report.parts[p];
    text += fmt::format("  {:<10}{:>9} {:>10}  {}\n", "", part.counts.triangles,
                        part.counts.open_edges, joined(part.labels, ", "));
    JsonOutput json = {{"names", part.labels}};
    json.update(json_of(part.counts, mm));
    if (const auto m = mesh.parts[p].material) json["material"] = *m;
    result["parts"].push_back(std::move(json));
  }
  result["materials"] = JsonOutput::array();
  if (!mesh.file_materials.empty())
    text += fmt::format("  {:<10}as a scene would say them\n", "materials");
  for (const FileMaterial& material : mesh.file_materials) {
    const SceneMaterialText scene =
        scene_material_text(material, mm > 0.0 ? mm : 1.0, options.uv_set);
    text += fmt::format("    \"{}\": {}\n", material.name, scene.json);
    if (!scene.ignored.empty())
      text += fmt::format("      not taken: {}\n", joined(scene.ignored, "; "));
    result["materials"].push_back({{"name", material.name},
                                   {"scene", JsonOutput(parse_json(scene.json, "").root())},
                                   {"ignored", scene.ignored}});
  }
  result["warnings"] = warnings;
  write_json(result, options.common);
  for (const std::string& warning : warnings) say("warning: " + warning);
  print(options.common, text);
}

std::string kind_of(const SurfaceMaterial& material) {
  constexpr std::array names = {"diffuse", "subsurface", "dielectric", "thin"};
  std::string text = names[material.surface.index()];
  for (const Covering& covering : coverings_of(material))
    text += ", over it " + (covering.name.empty() ? std::string("layers") : covering.name);
  if (material.coat) text += ", coat";
  const Vec3f& e = material.emission;
  if (e.x > 0.0F || e.y > 0.0F || e.z > 0.0F) text += ", emission";
  return text;
}

std::size_t bytes_of(const Image& image) {
  // With the smaller copies that textures are looked up in, three numbers each.
  const std::size_t texels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  return image.pixels.size() * sizeof(float) + texels / 3 * sizeof(Vec3f);
}

void show_scene(const InfoOptions& options) {
  const Scene scene = load_scene(options.file, options.common.memory, options.settings);
  std::vector<std::string> warnings = scene.warnings;
  std::ranges::move(implausible_sizes(scene), std::back_inserter(warnings));
  std::size_t memory = 0, triangles = 0;
  JsonOutput result = make_result("info");
  result["file"] = options.file;
  result["kind"] = "scene";
  result["mm_per_unit"] = scene.mm_per_unit;
  result["meshes"] = JsonOutput::array();
  std::string meshes;
  for (const Mesh& mesh : scene.meshes) {
    const PolygonMesh polygons = polygons_of(mesh);
    MeshReport report = report_mesh(polygons);
    report.is_closed = mesh.is_closed;  // before faces without area went
    report.counts.open_edges = 0;
    for (const OpenPart& part : mesh.open_parts) report.counts.open_edges += part.edges;
    meshes += fmt::format("{}\n  {:<10}{} mm\n", mesh.name, "size",
                          size_text(report.counts.high - report.counts.low, 1.0));
    meshes += topology_text(report);
    JsonOutput json = {{"name", mesh.name}};
    json.update(json_of(report, 1.0));
    json["parts"] = JsonOutput::array();
    for (std::size_t p = 0; p < report.parts.size(); ++p) {
      const SurfaceMaterial& material = scene.materials[*polygons.parts[p].material];
      meshes += fmt::format("  {:<10}{} ({}): {}{}\n", p == 0 ? "materials" : "", material.name,
                            kind_of(material),
                            counted(report.parts[p].counts.triangles, "triangle", "triangles"),
                            is_closed(mesh, *polygons.parts[p].material) ? ", closed" : ", open");
      JsonOutput part = {{"material", material.name}, {"kind", kind_of(material)}};
      part.update(json_of(report.parts[p].counts, 1.0));
      json["parts"].push_back(std::move(part));
    }
    result["meshes"].push_back(std::move(json));
    memory += rendering_memory(mesh.positions.size(), mesh.triangles.size());
    triangles += mesh.triangles.size();
  }
  std::size_t of_images = 0;
  for (const Image& image : scene.images) of_images += bytes_of(image);
  const std::size_t of_film =
      static_cast<std::size_t>(scene.film.width) * static_cast<std::size_t>(scene.film.height) * 80;
  result["triangles"] = triangles;
  result["images"] = scene.images.size();
  result["lights"] = scene.lights.size();
  result["materials"] = scene.materials.size();
  result["memory_bytes"] = memory + of_images + of_film;
  result["warnings"] = warnings;
  write_json(result, options.common);
  for (const std::string& warning : warnings) say("warning: " + warning);
  print(options.common,
        fmt::format("{}\n  {:<10}{} in {}, {}, {}, {}\n  {:<10}about {}: meshes {}, images {}, "
                    "picture {}; methods take more\n{}",
                    options.file, "holds", counted(triangles, "triangle", "triangles"),
                    counted(scene.meshes.size(), "mesh", "meshes"),
                    counted(scene.materials.size(), "material", "materials"),
                    counted(scene.images.size(), "image", "images"),
                    counted(scene.lights.size(), "light", "lights"), "memory",
                    memory_size_text(memory + of_images + of_film), memory_size_text(memory),
                    memory_size_text(of_images), memory_size_text(of_film), meshes));
}

/// A file of another kind: a few lines, and what takes it.
void show_facts(const InfoOptions& options, const FileLook& look, const FileKind& kind) {
  const FileFacts facts = kind.facts(look, options.common.memory);
  JsonOutput result = make_result("info");
  result["file"] = options.file;
  result["kind"] = kind.name;
  result["facts"] = facts.json;
  result["taken_by"] = kind.commands;
  result["warnings"] = facts.warnings;
  std::string text = fmt::format("{}\n  {:<12}{}\n", options.file, "kind", kind.name);
  for (const auto& [name, what] : facts.lines)
    text += fmt::format("  {:<12}{}\n", name, printable(what, ""));
  if (!kind.commands.empty()) text += fmt::format("  {:<12}{}\n", "taken by", kind.commands);
  write_json(result, options.common);
  for (const std::string& warning : facts.warnings) say("warning: " + warning);
  print(options.common, text);
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  const Command command(app, "info", "Say what a file holds, and what is odd about it");
  command
      .add_option("file", options->file,
                  "any file or folder that lamina reads or writes: its kind, size, bands and what "
                  "takes it; of a mesh (.obj, .ply, .gltf, .glb) or a scene its parts, materials, "
                  "triangles, size in mm, open edges, texture islands and memory")
      .type_name("FILE")
      .required();
  command
      .add_option("--mm-per-unit", options->mm_per_unit,
                  "of a mesh: millimetres of one unit; without it 1000 of glTF, and unknown else")
      .range(1e-6, 1e6);
  command.add_option("--uv-set", options->uv_set, "of glTF: which TEXCOORD_n is looked at")
      .range(0, 1000);
  add_settings_option(command, options->settings, "scene");
  add_common_options(command, options->common);
  command.footer(
      "Example: a mesh before it is rendered\n"
      "  lamina info head.obj --mm-per-unit 10");
  command.callback([command, options] {
    const FileLook look = look_at(options->file, options->common.memory);
    const FileKind* kind = find_file_kind(look);
    const bool is_scene = kind && kind->name == "scene", is_mesh = kind && kind->name == "mesh";
    if (!kind && look.is_json && !look.said.empty())
      throw InvalidInput(fmt::format("{}: \"lamina\" must be one of {}, but is \"{}\"{}",
                                     options->file, fmt::join(document_kinds(), ", "), look.said,
                                     did_you_mean(look.said, document_kinds())));
    if (!kind)
      throw InvalidInput(options->file + ": must be of a kind that lamina knows, but is none of " +
                         file_kind_names());
    for (const char* option : {"--mm-per-unit", "--uv-set"})
      if (!is_mesh && command.is_given(option))
        throw InvalidInput(
            fmt::format("{}: {}", option,
                        is_scene ? "a scene says this itself"
                                 : fmt::format("is for meshes, but this is a {}", kind->name)));
    if (!is_scene && !options->settings.empty()) throw InvalidInput("--set: is for scenes");
    if (is_scene)
      show_scene(*options);
    else if (is_mesh)
      show_mesh(*options);
    else
      show_facts(*options, look, *kind);
  });
}

}  // namespace lamina::cli
