// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/irradiance_cloud_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/core/file_bytes.h"

namespace lamina {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as memory has it");

constexpr std::size_t fixed_numbers = 14;  // of a vertex, before those of its bands

std::string hexadecimal(std::uint64_t value) {
  std::ostringstream text;
  text << std::hex << value;
  return text.str();
}

/// What a file says before its numbers, but for the number of vertices and the comments.
std::string property_lines(std::size_t bands, bool has_spread) {
  std::string text;
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v", "area", "red", "green",
                           "blue", "thickness", "material"})
    text += std::string("property float ") + name + "\n";
  const std::vector<const char*> of_bands =
      has_spread ? std::vector{"exitance_", "reflectance_"} : std::vector{"irradiance_"};
  for (const char* name : of_bands)
    for (std::size_t b = 0; b < bands; ++b)
      text += std::string("property float ") + name + std::to_string(b) + "\n";
  return text + "end_header\n";
}

constexpr int version = 2;  // of what the file means; older ones are refused
constexpr const char* format_lines = "ply\nformat binary_little_endian 1.0\n";
constexpr const char* version_words = "comment lamina irradiance cloud, version";

/// The parts of a scene, by the words that a message uses.
std::array<std::pair<const char*, std::uint64_t>, 5> parts(const SceneFingerprint& f) {
  return {{{"meshes", f.meshes},
           {"materials", f.materials},
           {"maps", f.maps},
           {"lights", f.lights},
           {"settings", f.settings}}};
}

std::string header(const std::vector<IrradianceCloud>& clouds, const SceneFingerprint& made_for) {
  std::ostringstream text;
  text.precision(9);
  text << format_lines << version_words << ' ' << version << ", lengths in mm\n";
  for (const auto& [name, value] : parts(made_for))
    text << "comment " << name << ' ' << hexadecimal(value) << '\n';
  std::size_t count = 0;
  for (const IrradianceCloud& cloud : clouds) {
    text << "comment cloud " << cloud.material << ' ' << cloud.points.size() << ' ' << cloud.spacing
         << '\n';
    count += cloud.points.size();
  }
  text << "comment bands " << clouds.front().bands << '\n';
  text << "element vertex " << count << '\n'
       << property_lines(clouds.front().bands, !clouds.front().exitance.empty());
  return text.str();
}

/// Goes through a header line by line.
class Lines {
 public:
  Lines(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  [[noreturn]] void refuse(const std::string& why) const { throw FileError(file_ + ": " + why); }

  void expect(std::string_view text) {
    if (!rest_.starts_with(text)) refuse("is not a point cloud of lamina's, or damaged");
    rest_.remove_prefix(text.size());
  }
  /// The words after a beginning, if the next line has it.
  bool next(const std::string& beginning, std::istringstream& words) {
    const std::size_t end = rest_.find('\n');
    if (!rest_.starts_with(beginning + ' ') || end == std::string_view::npos) return false;
    words = std::istringstream(
        std::string(rest_.substr(beginning.size() + 1, end - beginning.size() - 1)));
    rest_.remove_prefix(end + 1);
    return true;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::string file_;
};

}  // namespace

void save_irradiance_clouds(const std::vector<IrradianceCloud>& clouds,
                            const SceneFingerprint& made_for, const std::filesystem::path& file) {
  std::string bytes = header(clouds, made_for);
  std::vector<float> vertex;
  for (const IrradianceCloud& cloud : clouds)
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const auto& [p, n, uv, area, albedo, thickness] = cloud.points[i];
      vertex = {p.x,
                p.y,
                p.z,
                n.x,
                n.y,
                n.z,
                uv.x,
                uv.y,
                area,
                albedo.x,
                albedo.y,
                albedo.z,
                std::isfinite(thickness) ? thickness : 0.0f,
                static_cast<float>(cloud.material)};
      const auto add = [&](const std::vector<float>& of_bands) {
        vertex.insert(vertex.end(), &of_bands[i * cloud.bands],
                      &of_bands[i * cloud.bands] + cloud.bands);
      };
      if (cloud.exitance.empty()) {
        add(cloud.irradiance);
      } else {
        add(cloud.exitance);
        add(cloud.reflectance);
      }
      bytes.append(reinterpret_cast<const char*>(vertex.data()), vertex.size() * sizeof(float));
    }
  write_file_bytes(file, std::as_bytes(std::span(bytes)));
}

std::vector<IrradianceCloud> load_irradiance_clouds(const std::filesystem::path& file,
                                                    const SceneFingerprint& wanted) {
  const std::string bytes = read_file_bytes(file);
  Lines lines(bytes, file.string());
  std::istringstream words;
  lines.expect(format_lines);
  int found_version = 0;
  if (!lines.next(version_words, words) || !(words >> found_version))
    lines.refuse("is not a point cloud of lamina's, or damaged");
  if (found_version != version)
    lines.refuse("must be of version " + std::to_string(version) + ", but is of version " +
                 std::to_string(found_version) + "; remove it to make it anew");
  for (const auto& [name, value] : parts(wanted)) {
    std::string found;
    if (!lines.next(std::string("comment ") + name, words) || !(words >> found))
      lines.refuse(std::string("does not say which ") + name + " it was made for");
    if (found != hexadecimal(value))
      throw InvalidInput(file.string() + ": is stale: the scene's " + name +
                         " have changed since it was made; remove it to make it anew");
  }
  std::vector<IrradianceCloud> clouds;
  std::size_t count = 0;
  while (lines.next("comment cloud", words)) {
    IrradianceCloud cloud;
    std::size_t points = 0;
    if (!(words >> cloud.material >> points >> cloud.spacing) || !(cloud.spacing > 0.0f) ||
        points > bytes.size())
      lines.refuse("has a damaged header");
    cloud.points.resize(points);
    count += points;
    clouds.push_back(std::move(cloud));
  }
  std::size_t bands = 0;
  if (!lines.next("comment bands", words) || !(words >> bands) || bands < 1 || bands > 16)
    lines.refuse("has a damaged header");
  const std::string before_properties = "element vertex " + std::to_string(count) + "\n";
  const bool has_spread = lines.rest().starts_with(before_properties + property_lines(bands, true));
  lines.expect(before_properties + property_lines(bands, has_spread));
  const std::size_t stride = fixed_numbers + (has_spread ? 2 : 1) * bands;
  if (lines.rest().size() != count * stride * sizeof(float))
    lines.refuse("must hold " + std::to_string(count) + " vertices, but is cut off or too long");
  std::vector<float> vertex(stride);
  std::string_view rest = lines.rest();
  for (IrradianceCloud& cloud : clouds) {
    cloud.bands = bands;
    for (CloudPoint& point : cloud.points) {
      std::memcpy(vertex.data(), rest.data(), stride * sizeof(float));
      rest.remove_prefix(stride * sizeof(float));
      for (const float number : vertex)
        if (!std::isfinite(number)) lines.refuse("holds a number that is not finite");
      const auto& v = vertex;
      point = {.position = {v[0], v[1], v[2]},
               .normal = {v[3], v[4], v[5]},
               .uv = {v[6], v[7]},
               .area = v[8],
               .albedo = {v[9], v[10], v[11]},
               .thickness = v[12] > 0.0f ? v[12] : std::numeric_limits<float>::infinity()};
      const auto first = v.begin() + fixed_numbers,
                 second = first + static_cast<std::ptrdiff_t>(bands);
      std::vector<float>& of_first = has_spread ? cloud.exitance : cloud.irradiance;
      of_first.insert(of_first.end(), first, second);
      cloud.reflectance.insert(cloud.reflectance.end(), second, v.end());
    }
  }
  return clouds;
}

}  // namespace lamina
