// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "info_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/envi_file.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/spectrum/spectrum_table.h"
#include "lamina/scene/mesh/files/materialx_file.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr std::size_t looked_at = 4096;  // bytes
constexpr std::size_t most_listed = 12;  // channels, columns, materials

template <std::size_t N>
bool is_one_of(const std::string& text, const std::array<std::string_view, N>& all) {
  return std::ranges::find(all, text) != all.end();
}

std::string listed(const std::vector<std::string>& texts) {
  if (texts.size() <= most_listed) return fmt::format("{}", fmt::join(texts, ", "));
  const std::vector<std::string> first(texts.begin(), texts.begin() + most_listed);
  return fmt::format("{} and {} more", fmt::join(first, ", "), texts.size() - most_listed);
}

// Images.

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> image_starts = {
    {{"\x76\x2f\x31\x01"sv, "OpenEXR"sv},
     {"\x89PNG\r\n\x1a\n"sv, "PNG"sv},
     {"\xff\xd8\xff"sv, "JPEG"sv},
     {"II*\0"sv, "TIFF"sv},
     {"MM\0*"sv, "TIFF"sv},
     {"II+\0"sv, "TIFF"sv},
     {"MM\0+"sv, "TIFF"sv},
     {"#?R"sv, "Radiance HDR"sv},
     {"ENVI"sv, "ENVI"sv}}};
constexpr std::array<std::string_view, 10> camera_endings = {
    ".dng", ".nef", ".cr2", ".cr3", ".arw", ".raf", ".orf", ".rw2", ".x3f", ".pef"};

std::string_view image_format(const FileLook& look) {
  if (is_one_of(look.ending, camera_endings)) return "camera raw";
  for (const auto& [start, name] : image_starts)
    if (look.start.starts_with(start)) return name;
  return "";
}

bool is_image(const FileLook& look) {
  const std::string_view format = image_format(look);
  return !format.empty() && format != "ENVI";
}

FileFacts image_facts(const FileLook& look, MemoryBudget memory) {
  FileFacts facts;
  const std::string format(image_format(look));
  facts.lines.emplace_back("format", format);
  facts.json["format"] = format;
  add_image(facts, load_image(look.path, ImageReading{.encoding = ColorEncoding::linear}, memory));
  return facts;
}

FileFacts envi_facts(const FileLook& look, MemoryBudget memory) {
  const EnviHeader header = load_envi_header(look.path, memory);
  FileFacts facts;
  facts.json = {{"width", header.samples}, {"height", header.lines}, {"bands", header.bands}};
  facts.lines.emplace_back("size", fmt::format("{} x {} pixels of {} bands", header.samples,
                                               header.lines, header.bands));
  constexpr std::array<std::string_view, 3> orders = {"bsq", "bil", "bip"};
  const std::string numbers = fmt::format(
      "of {} bytes, {}, {}", envi_number_size(header),
      orders[static_cast<std::size_t>(header.interleave)],
      header.scale == 1.0 ? std::string("as they are") : fmt::format("over {:g}", header.scale));
  facts.lines.emplace_back("numbers", numbers);
  facts.json["scale"] = header.scale;
  if (header.wavelengths.empty()) return facts;
  const auto [low, high] = std::ranges::minmax(header.wavelengths);
  facts.lines.emplace_back("bands", fmt::format("{:g} to {:g} nm", low, high));
  facts.json["wavelengths_nm"] = header.wavelengths;
  const auto bad = std::ranges::count(header.is_bad, true);
  if (bad > 0) facts.lines.emplace_back("", fmt::format("{} of them bad, by the file", bad));
  return facts;
}

// Tables.

/// The lowest and highest number of a column; absent where a cell is none.
std::optional<std::pair<double, double>> range_of(const CsvTable& table, std::size_t column) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  try {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double value = table.number(row, column);
      low = std::min(low, value), high = std::max(high, value);
    }
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
  return std::pair{low, high};
}

/// The wavelengths of a table, turned to rise; none of tables of something else.
std::optional<std::vector<double>> wavelengths_of(CsvTable& table) {
  try {
    raise_wavelengths(table);
    return read_wavelengths(table);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

FileFacts table_facts(const FileLook& look, MemoryBudget memory) {
  CsvTable table = load_csv(look.path, memory);
  FileFacts facts;
  facts.json = {{"rows", table.rows()}};
  facts.lines.emplace_back("rows", fmt::format("{}", table.rows()));
  if (const auto nm = wavelengths_of(table)) {
    facts.lines.emplace_back("bands", fmt::format("{:g} to {:g} nm", nm->front(), nm->back()));
    facts.json["wavelengths_nm"] = *nm;
  }
  facts.json["columns"] = JsonOutput::array();
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const auto range = range_of(table, c);
    JsonOutput column = {{"name", table.columns()[c]}};
    if (range) column["low"] = range->first, column["high"] = range->second;
    facts.json["columns"].push_back(std::move(column));
    if (c < most_listed)
      facts.lines.emplace_back(
          c == 0 ? "columns" : "",
          table.columns()[c] + (range ? fmt::format(": {:g} to {:g}", range->first, range->second)
                                      : std::string(": text")));
  }
  if (table.columns().size() > most_listed)
    facts.lines.emplace_back("", fmt::format("and {} more", table.columns().size() - most_listed));
  return facts;
}

// Files of other programs.

FileFacts mcml_input_facts(const FileLook& look, MemoryBudget memory) {
  FileFacts facts;
  facts.json["runs"] = JsonOutput::array();
  const std::vector<McmlRun> runs = load_mcml(look.path, memory);
  for (const McmlRun& run : runs) {
    facts.json["runs"].push_back(
        {{"output", run.output_file}, {"photons", run.photons}, {"layers", run.layers.size()}});
    if (facts.json["runs"].size() <= most_listed)
      facts.lines.emplace_back(
          facts.lines.empty() ? "runs" : "",
          fmt::format("{}: {} photons into {} {}, {} x {} x {} cells", run.output_file, run.photons,
                      run.layers.size(), run.layers.size() == 1 ? "layer" : "layers", run.nz,
                      run.nr, run.na));
  }
  if (runs.size() > most_listed)
    facts.lines.emplace_back("", fmt::format("and {} more", runs.size() - most_listed));
  return facts;
}

/// The totals in the section RAT of a file of MCML.
FileFacts mcml_output_facts(const FileLook& look, MemoryBudget) {
  FileFacts facts;
  const std::size_t section = look.start.find("\nRAT");
  if (section == std::string::npos)
    throw FileError(look.path.string() + ": must be a result of MCML, but has no section RAT");
  std::size_t at = look.start.find('\n', section + 1);
  for (const char* name :
       {"specular_reflectance", "diffuse_reflectance", "absorbed_fraction", "transmittance"}) {
    if (at == std::string::npos) break;
    char* end = nullptr;
    const double value = std::strtod(look.start.c_str() + at, &end);
    if (end == look.start.c_str() + at || !std::isfinite(value)) break;
    facts.lines.emplace_back(facts.lines.empty() ? "totals" : "",
                             fmt::format("{} {:g}", name, value));
    facts.json[name] = value;
    at = look.start.find('\n', at + 1);
  }
  return facts;
}

FileFacts iad_facts(const FileLook& look, MemoryBudget memory) {
  const std::string text = read_file_bytes(look.path, memory);
  FileFacts facts;
  facts.lines.emplace_back("lines", fmt::format("{}", std::ranges::count(text, '\n')));
  facts.lines.emplace_back("use",
                           "as \"table\" of a measurement, which also says what the spheres are");
  facts.json["lines"] = std::ranges::count(text, '\n');
  return facts;
}

FileFacts materialx_facts(const FileLook& look, MemoryBudget memory) {
  std::vector<std::string> names;
  for (const FileMaterial& material : load_materialx(look.path, memory))
    names.push_back(material.name);
  FileFacts facts;
  facts.lines.emplace_back("materials", listed(names));
  facts.json["materials"] = names;
  return facts;
}

// Files that lamina keeps of its own work.

/// Light kept on surfaces, by the header of its PLY file.
FileFacts light_facts(const FileLook& look, MemoryBudget) {
  FileFacts facts;
  for (std::size_t at = 0; at < look.start.size();) {
    const std::size_t end = std::min(look.start.find('\n', at), look.start.size());
    const std::string line = look.start.substr(at, end - at);
    if (line == "end_header") break;
    if (line.starts_with("element ")) {
      const std::size_t part = line.rfind(' ');
      const std::string name = line.substr(8, part - 8);
      facts.lines.emplace_back(name == "vertex" ? "samples" : name, line.substr(part + 1));
      facts.json[name == "vertex" ? "samples" : name] = line.substr(part + 1);
    }
    at = end + 1;
  }
  const auto bands = [&](std::string_view name) {
    int count = 0;
    while (look.start.find(fmt::format(" {}_{}\n", name, count)) != std::string::npos) ++count;
    return count;
  };
  const int arriving = bands("irradiance"), leaving = bands("exitance");
  facts.lines.emplace_back("bands", fmt::format("{}, of light that {}", std::max(arriving, leaving),
                                                leaving > 0 ? "has spread" : "arrives"));
  facts.json["bands"] = std::max(arriving, leaving);
  return facts;
}

FileFacts cached_facts(const FileLook& look, MemoryBudget) {
  FileFacts facts;
  std::error_code error;
  facts.json["bytes"] = static_cast<std::uint64_t>(fs::file_size(look.path, error));
  facts.lines.emplace_back("use", "lamina takes it by itself where it belongs, and makes it anew");
  return facts;
}

template <const char* Said>
bool says(const FileLook& look) {
  return look.is_json && look.said == Said;
}
constexpr char scene[] = "scene", material[] = "material", capture[] = "capture", patch[] = "patch",
               measurement[] = "measurement", population[] = "population", maps[] = "maps",
               job[] = "job", reproduction[] = "reproduction";

template <const char* Ending>
bool ends(const FileLook& look) {
  return !look.is_folder && look.ending == Ending;
}
constexpr char mci[] = ".mci", mco[] = ".mco", rxt[] = ".rxt", mtlx[] = ".mtlx", own[] = ".lamina";

bool is_light(const FileLook& look) {
  return look.start.starts_with("ply") &&
         look.start.find("\ncomment lamina irradiance cloud") != std::string::npos;
}

bool is_mesh(const FileLook& look) {
  // Formats behind .glb are refused, with how to get to one that is read.
  constexpr std::array<std::string_view, 12> endings = {".obj", ".ply",  ".gltf",  ".glb",
                                                        ".usd", ".usda", ".usdc",  ".usdz",
                                                        ".abc", ".fbx",  ".blend", ".stl"};
  return !look.is_folder && is_one_of(look.ending, endings);
}

bool holds(const FileLook& look, const char* name) {
  std::error_code error;
  return look.is_folder && fs::is_regular_file(look.path / name, error);
}

bool is_table(const FileLook& look) {
  constexpr std::array<std::string_view, 4> endings = {".csv", ".tsv", ".txt", ".dat"};
  return !look.is_folder && is_one_of(look.ending, endings) &&
         look.start.find('\0') == std::string::npos;
}

// In this order: what shows more clearly comes first.
constexpr auto kinds = std::to_array<FileKind>({
    {"scene", ".json", "render", says<scene>, nullptr},
    {"material", ".json", "slab, profile, bsdf, photons, patch, export, materials, and scenes",
     says<material>, material_facts},
    {"capture", ".json", "acquire", says<capture>, capture_facts},
    {"patch", ".json", "patch; its maps: edit", says<patch>, patch_facts},
    {"measurement", ".json", "fit", says<measurement>, measurement_facts},
    {"population", ".json", "captures, measurements and edit", says<population>, population_facts},
    {"recipe of maps", ".json", "maps", says<maps>, recipe_facts},
    {"job", ".json", "submit", says<job>, job_facts},
    {"reproduction", ".json", "reproduce", says<reproduction>, reproduction_facts},
    {"counts of photons", ".json", "merge", [](const FileLook& f) { return f.has_counts; },
     photon_counts_facts},
    {"shard of fits", ".json", "merge",
     [](const FileLook& f) { return f.is_shard && f.command == "fit"; }, result_facts},
    {"result", ".json of --json", "", [](const FileLook& f) { return !f.command.empty(); },
     result_facts},
    {"job folder", "with job.json", "status, submit",
     [](const FileLook& f) { return holds(f, "job.json"); }, job_folder_facts},
    {"folder of maps", "with patch.json or material.json", "edit",
     [](const FileLook& f) { return holds(f, "patch.json") || holds(f, "material.json"); },
     maps_facts},
    {"light on surfaces", ".ply of --cache", "render --cache", is_light, light_facts},
    {"mesh", ".obj, .ply, .gltf, .glb", "scenes, export --mesh", is_mesh, nullptr},
    {"image", ".exr, .png, .jpg, .tif, .hdr, camera raw", "scenes, captures, patches, maps",
     is_image, image_facts},
    {"ENVI image", ".hdr beside its numbers", "captures",
     [](const FileLook& f) { return image_format(f) == "ENVI"; }, envi_facts},
#ifdef LAMINA_RENDER
    {"shard of a picture", ".shard", "merge", is_picture_shard, picture_shard_facts},
    {"unfinished picture", ".unfinished", "render --resume",
     [](const FileLook& f) { return !f.is_folder && !f.is_json && f.ending == ".unfinished"; },
     kept_picture_facts},
#endif
    {"MCML input", ".mci", "photons", ends<mci>, mcml_input_facts},
    {"MCML result", ".mco", "", ends<mco>, mcml_output_facts},
    {"iad readings", ".rxt", "measurements", ends<rxt>, iad_facts},
    {"MaterialX", ".mtlx", "scenes", ends<mtlx>, materialx_facts},
    {"kept result", ".lamina", "", ends<own>, cached_facts},
    {"table", ".csv, .tsv, .txt", "materials, captures, measurements, fit --batch", is_table,
     table_facts},
});

}  // namespace

FileLook look_at(const fs::path& path, MemoryBudget memory) {
  FileLook look{.path = path, .ending = lower_case_ending(path)};
  std::error_code error;
  look.is_folder = fs::is_directory(path, error);
  if (look.is_folder) return look;
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  look.start.resize(looked_at);
  stream.read(look.start.data(), looked_at);
  look.start.resize(static_cast<std::size_t>(stream.gcount()));
  const std::size_t first = look.start.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool has_brace = first != std::string::npos && look.start[first] == '{';
  if (look.ending != ".json" && (!has_brace || look.ending == ".gltf")) return look;
  const JsonDocument document = load_json(path, memory);
  const JsonInput root = document.root();
  look.is_json = root.is_object();
  if (!look.is_json) return look;
  const auto text = [&](const char* key) {
    const auto value = root.peek(key);
    return value && value->is_string() ? value->string() : std::string();
  };
  look.said = text("lamina");
  if (!look.said.empty()) look.command = text("command");
  look.has_counts = !look.command.empty() && root.peek("counts").has_value();
  look.is_shard = !look.command.empty() && root.peek("shard").has_value();
  return look;
}

const FileKind* find_file_kind(const FileLook& look) {
  const auto found =
      std::ranges::find_if(kinds, [&](const FileKind& kind) { return kind.is(look); });
  return found == kinds.end() ? nullptr : &*found;
}

std::span<const std::string_view> document_kinds() {
  static constexpr std::array<std::string_view, 9> all = {
      scene, material, capture, patch, measurement, population, maps, job, reproduction};
  return all;
}

std::string file_kind_names() {
  std::vector<std::string> names;
  for (const FileKind& kind : kinds) names.push_back(fmt::format("{} ({})", kind.name, kind.files));
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_bands(FileFacts& facts, const BandSet& bands) {
  std::string text = "R, G, B";
  if (!bands.is_rgb()) {
    const auto nm = bands.wavelengths();
    text = bands.size() == 1
               ? fmt::format("{:g} nm", nm.front())
               : fmt::format("{}, {:g} to {:g} nm", bands.size(), nm.front(), nm.back());
    facts.json["wavelengths_nm"] = nm;
  }
  facts.lines.emplace_back("bands", text);
  facts.json["bands"] = bands.size();
}

void add_image(FileFacts& facts, const Image& image) {
  const std::size_t channels = image.channel_count();
  facts.lines.emplace_back("size", fmt::format("{} x {} pixels of {} {}", image.width, image.height,
                                               channels, channels == 1 ? "channel" : "channels"));
  facts.json["width"] = image.width;
  facts.json["height"] = image.height;
  facts.json["channels"] = JsonOutput::array();
  for (std::size_t c = 0; c < channels; ++c) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    std::size_t others = 0;
    for (std::size_t i = c; i < image.pixels.size(); i += channels) {
      const float value = image.pixels[i];
      if (!std::isfinite(value)) {
        ++others;
        continue;
      }
      low = std::min(low, value), high = std::max(high, value);
    }
    JsonOutput channel = {{"name", image.channels[c]}, {"not_finite", others}};
    std::string text = image.channels[c];
    if (low <= high) {
      text += fmt::format(": {:.4g} to {:.4g}", low, high);
      channel["low"] = low, channel["high"] = high;
    }
    if (others > 0) text += fmt::format(", {} not finite", others);
    facts.json["channels"].push_back(std::move(channel));
    if (c < most_listed) facts.lines.emplace_back(c == 0 ? "channels" : "", text);
  }
  if (channels > most_listed)
    facts.lines.emplace_back("", fmt::format("and {} more", channels - most_listed));
}

}  // namespace lamina::cli
