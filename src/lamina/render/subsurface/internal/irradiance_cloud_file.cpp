// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as memory has it");

constexpr std::size_t fixed_numbers = 14;  // of a vertex, before those of its bands

std::string hexadecimal(std::uint64_t value) {
  return printf_text("%016llx", static_cast<unsigned long long>(value));
}

/// A number of each band that points have, and where clouds keep it.
struct BandProperty {
  const char* name;
  std::vector<float> IrradianceCloud::*values;
};
using BandProperties = std::span<const BandProperty>;

constexpr std::array before_spread = {BandProperty{"irradiance_", &IrradianceCloud::irradiance}};
/// The last of sheets only.
constexpr std::array after_spread = {
    BandProperty{"exitance_", &IrradianceCloud::exitance},
    BandProperty{"reflectance_", &IrradianceCloud::reflectance},
    BandProperty{"transmittance_", &IrradianceCloud::transmittance}};

/// What files may hold.
constexpr std::array<BandProperties, 3> kinds_of_files = {BandProperties(before_spread),
                                                          BandProperties(after_spread).first(2),
                                                          BandProperties(after_spread)};

BandProperties properties_of(const std::vector<IrradianceCloud>& clouds) {
  if (clouds.front().exitance.empty()) return kinds_of_files[0];
  const bool has_sheet = std::ranges::any_of(
      clouds, [](const IrradianceCloud& cloud) { return !cloud.transmittance.empty(); });
  return kinds_of_files[has_sheet ? 2 : 1];
}

/// What a file says before its numbers, but for the number of vertices and the comments.
std::string property_lines(std::size_t bands, BandProperties properties) {
  std::string text;
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v", "area", "red", "green",
                           "blue", "thickness", "material"})
    text += std::string("property float ") + name + "\n";
  for (const BandProperty& property : properties)
    for (std::size_t b = 0; b < bands; ++b)
      text += std::string("property float ") + property.name + std::to_string(b) + "\n";
  return text;
}

constexpr std::size_t fixed_numbers_of_ratio = 7;  // before those of its bands

/// The same of places where there are ratios, if any are.
std::string ratio_lines(std::size_t places, std::size_t bands) {
  if (places == 0) return {};
  std::string text = "element ratio " + std::to_string(places) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "added_exitance"})
    text += std::string("property float ") + name + "\n";
  for (std::size_t k = 0; k < LightRatioCloud::direction_terms; ++k)
    for (std::size_t b = 0; b < bands; ++b)
      text += "property float term_" + std::to_string(k) + '_' + std::to_string(b) + "\n";
  return text;
}
constexpr std::string_view end_of_header = "end_header\n";

constexpr int version = 6;  // of what the file means; older ones are made anew
const std::string first_words =
    "ply\nformat binary_little_endian 1.0\ncomment lamina irradiance cloud, version ";
const std::string no_checksum(16, '0');  // while the checksum of the file is taken

std::uint64_t cloud_checksum(std::string_view bytes) {
  Hash hash;
  hash.add_text(bytes);
  return hash.value();
}

/// The parts of a scene, by the words that a message uses.
std::array<std::pair<const char*, std::uint64_t>, 5> parts(const LightFingerprint& f) {
  return {{{"meshes", f.meshes},
           {"materials", f.materials},
           {"maps", f.maps},
           {"lights", f.lights},
           {"settings", f.settings}}};
}

std::string header(const std::vector<IrradianceCloud>& clouds,
                   const std::vector<LightRatioCloud>& ratios, const LightFingerprint& made_for) {
  PlainTextStream text;
  text.precision(9);
  text << first_words << version << ", lengths in mm\n"
       << "comment checksum " << no_checksum << '\n';
  for (const auto& [name, value] : parts(made_for))
    text << "comment " << name << ' ' << hexadecimal(value) << '\n';
  std::size_t count = 0;
  for (const IrradianceCloud& cloud : clouds) {
    text << "comment cloud " << cloud.material << ' ' << cloud.points.size() << ' ' << cloud.spacing
         << '\n';
    count += cloud.points.size();
  }
  const std::size_t bands = clouds.front().bands;
  text << "comment bands " << bands << '\n';
  std::size_t places = 0;
  for (const LightRatioCloud& ratio : ratios) {
    text << "comment ratio " << ratio.material << ' ' << ratio.places.size() << ' ' << ratio.walks
         << ' ' << ratio.change << ' ' << ratio.error_left << ' ' << ratio.spacing;
    for (const float number : ratio.shape) text << ' ' << number;
    text << '\n';
    places += ratio.places.size();
  }
  text << "element vertex " << count << '\n'
       << property_lines(bands, properties_of(clouds)) << ratio_lines(places, bands)
       << end_of_header;
  return text.str();
}

struct Unusable {
  std::string why;
};

void require(bool holds) {
  if (!holds) throw Unusable{"is damaged"};
}

/// Goes through a header line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  void expect(std::string_view text) {
    require(rest_.starts_with(text));
    rest_.remove_prefix(text.size());
  }
  /// The words after a beginning, if the next line has it.
  bool next(const std::string& beginning, std::istringstream& words) {
    const std::size_t end = rest_.find('\n', beginning.size());
    if (!rest_.starts_with(beginning) || end == std::string_view::npos) return false;
    words = std::istringstream(std::string(rest_.substr(beginning.size(), end - beginning.size())));
    words.imbue(std::locale::classic());
    rest_.remove_prefix(end + 1);
    return true;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// What a vertex must be, whatever the checksum says.
void check(const CloudPoint& point, float spacing, std::span<const float> of_bands) {
  const auto is_at_least_0 = [](float x) { return x >= 0.0f && std::isfinite(x); };
  for (int k = 0; k < 3; ++k) require(std::isfinite(point.position[k]));
  require(std::abs(length(point.normal) - 1.0f) < 1e-3f);
  require(std::isfinite(point.uv.x) && std::isfinite(point.uv.y));
  require(point.area > 0.0f && point.area < 1e4f * spacing * spacing);  // about spacing²
  for (int k = 0; k < 3; ++k) require(std::isfinite(point.albedo[k]));
  require(point.thickness > 0.0f);
  for (const float value : of_bands) require(is_at_least_0(value));
}

/// Takes a ratio's numbers off the comment that has them.
/// @throws Unusable
LightRatioCloud parse_ratio_comment(std::istringstream& words, std::size_t bands,
                                    std::size_t& places) {
  LightRatioCloud ratio{.bands = bands,
                        .shape = std::vector<float>(LightRatioCloud::shape_terms * bands)};
  require(words >> ratio.material >> places >> ratio.walks >> ratio.change >> ratio.error_left >>
              ratio.spacing &&
          places >= 1 && std::isfinite(ratio.change) && std::isfinite(ratio.error_left) &&
          std::isfinite(ratio.spacing) && ratio.spacing > 0.0f);
  for (float& number : ratio.shape) require(words >> number && std::isfinite(number));
  return ratio;
}

/// Takes the places of ratios off the end of a file.
/// @param counts  [ratio], of its places
/// @throws Unusable
void parse_ratios(std::string_view rest, const std::vector<std::size_t>& counts,
                  std::vector<LightRatioCloud>& ratios) {
  for (std::size_t c = 0; c < ratios.size(); ++c) {
    LightRatioCloud& ratio = ratios[c];
    std::vector<float> v(fixed_numbers_of_ratio + LightRatioCloud::direction_terms * ratio.bands);
    for (std::size_t i = 0; i < counts[c]; ++i) {
      std::memcpy(v.data(), rest.data(), v.size() * sizeof(float));
      rest.remove_prefix(v.size() * sizeof(float));
      for (const float number : v) require(std::isfinite(number));
      ratio.places.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]});
      require(std::abs(length(ratio.places.back().normal) - 1.0f) < 1e-3f && v[6] >= 0.0f);
      ratio.ratios.insert(ratio.ratios.end(), v.begin() + fixed_numbers_of_ratio, v.end());
    }
  }
}

/// @throws Unusable
KeptClouds parse_clouds(std::string bytes, const LightFingerprint& wanted, const std::string& name,
                        MemoryBudget memory, CloudOrigin origin) {
  const bool is_own = origin == CloudOrigin::own;
  Lines lines(bytes);
  std::istringstream words;
  int found_version = 0;
  require(lines.next(first_words, words) && words >> found_version);
  if (found_version != version)
    throw Unusable{"is of version " + std::to_string(found_version) + ", not " +
                   std::to_string(version)};
  lines.expect("comment checksum ");
  const std::size_t at = bytes.size() - lines.rest().size();
  require(bytes.size() >= at + no_checksum.size());
  const std::string stated = bytes.substr(at, no_checksum.size());
  bytes.replace(at, no_checksum.size(), no_checksum);
  require(!is_own || stated == hexadecimal(cloud_checksum(bytes)));
  lines.expect(no_checksum + '\n');
  for (const auto& [part, value] : parts(wanted)) {
    std::string found;
    require(lines.next(std::string("comment ") + part + ' ', words) && words >> found);
    if (is_own && found != hexadecimal(value))
      throw Unusable{
          std::string("was made for other ") + part +
          (part == parts(wanted).back().first ? ", or by another version of the program" : "")};
  }
  std::vector<IrradianceCloud> clouds;
  std::vector<std::size_t> sizes;  // [cloud], of its points
  std::size_t count = 0;
  while (lines.next("comment cloud ", words)) {
    IrradianceCloud cloud;
    std::size_t points = 0;
    require(words >> cloud.material >> points >> cloud.spacing && cloud.spacing > 0.0f &&
            std::isfinite(cloud.spacing) && points <= bytes.size() - count);
    take_memory(memory, 2 * sizeof cloud, name + ": its header");
    sizes.push_back(points);
    count += points;
    clouds.push_back(std::move(cloud));
  }
  std::size_t bands = 0;
  require(lines.next("comment bands ", words) && words >> bands && bands >= 1 && bands <= 16);
  std::vector<LightRatioCloud> ratios;
  std::vector<std::size_t> places_of;  // [ratio]
  std::size_t places = 0;
  while (lines.next("comment ratio ", words)) {
    ratios.push_back(parse_ratio_comment(words, bands, places_of.emplace_back()));
    require(places_of.back() <= bytes.size() - places);
    take_memory(memory, 2 * sizeof(LightRatioCloud), name + ": its header");
    places += places_of.back();
  }
  const std::string end = ratio_lines(places, bands) + std::string(end_of_header);
  const std::string before_properties = "element vertex " + std::to_string(count) + "\n";
  const auto kind = std::ranges::find_if(kinds_of_files, [&](BandProperties properties) {
    return lines.rest().starts_with(before_properties + property_lines(bands, properties) + end);
  });
  require(kind != kinds_of_files.end());
  lines.expect(before_properties + property_lines(bands, *kind) + end);
  const std::size_t stride = fixed_numbers + kind->size() * bands;
  std::string_view rest = lines.rest();
  const std::size_t stride_of_ratio =
      places == 0 ? 0 : fixed_numbers_of_ratio + LightRatioCloud::direction_terms * bands;
  require(rest.size() == (count * stride + places * stride_of_ratio) * sizeof(float));
  take_memory(memory, places, 2 * stride_of_ratio * sizeof(float),
              name + ": " + std::to_string(places) + " places");
  take_memory(memory, count, sizeof(CloudPoint) + 2 * kind->size() * bands * sizeof(float),
              name + ": " + std::to_string(count) + " points");
  std::vector<float> v(stride);
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    IrradianceCloud& cloud = clouds[c];
    cloud.bands = bands;
    cloud.points.resize(sizes[c]);
    for (CloudPoint& point : cloud.points) {
      std::memcpy(v.data(), rest.data(), stride * sizeof(float));
      rest.remove_prefix(stride * sizeof(float));
      point = {.position = {v[0], v[1], v[2]},
               .normal = {v[3], v[4], v[5]},
               .uv = {v[6], v[7]},
               .area = v[8],
               .albedo = {v[9], v[10], v[11]},
               .thickness = v[12] != 0.0f ? v[12] : std::numeric_limits<float>::infinity()};
      check(point, cloud.spacing, std::span(v).subspan(fixed_numbers));
      require(v[13] == static_cast<float>(cloud.material));
      auto number = v.begin() + fixed_numbers;
      for (const BandProperty& property : *kind) {
        std::vector<float>& values = cloud.*property.values;
        values.insert(values.end(), number, number + static_cast<std::ptrdiff_t>(bands));
        number += static_cast<std::ptrdiff_t>(bands);
      }
    }
  }
  parse_ratios(rest, places_of, ratios);
  return {.clouds = std::move(clouds), .ratios = std::move(ratios), .why_unusable = {}};
}

}  // namespace

void save_irradiance_clouds(const std::vector<IrradianceCloud>& clouds,
                            const std::vector<LightRatioCloud>& ratios,
                            const LightFingerprint& made_for, const std::filesystem::path& file) {
  std::string bytes = header(clouds, ratios, made_for);
  const BandProperties properties = properties_of(clouds);
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
      for (const BandProperty& property : properties) {
        const std::vector<float>& values = cloud.*property.values;
        for (std::size_t b = 0; b < cloud.bands; ++b)
          vertex.push_back(values.empty() ? 0.0f : values[i * cloud.bands + b]);
      }
      bytes.append(reinterpret_cast<const char*>(vertex.data()), vertex.size() * sizeof(float));
    }
  for (const LightRatioCloud& ratio : ratios) {
    const std::size_t numbers = LightRatioCloud::direction_terms * ratio.bands;
    for (std::size_t i = 0; i < ratio.places.size(); ++i) {
      const auto& [p, n, added_exitance] = ratio.places[i];
      vertex = {p.x, p.y, p.z, n.x, n.y, n.z, added_exitance};
      const auto first = ratio.ratios.begin() + static_cast<std::ptrdiff_t>(i * numbers);
      vertex.insert(vertex.end(), first, first + static_cast<std::ptrdiff_t>(numbers));
      bytes.append(reinterpret_cast<const char*>(vertex.data()), vertex.size() * sizeof(float));
    }
  }
  const std::string sum = hexadecimal(cloud_checksum(bytes));
  bytes.replace(bytes.find("comment checksum ") + 17, sum.size(), sum);
  write_file_bytes(file, std::as_bytes(std::span(bytes)));
}

KeptClouds load_irradiance_clouds(const std::filesystem::path& file, const LightFingerprint& wanted,
                                  MemoryBudget memory, CloudOrigin origin) {
  std::string bytes = read_file_bytes(file, memory);
  if (!bytes.starts_with(first_words))
    throw FileError(file.string() + ": must be a cache of light, but is another file");
  try {
    return parse_clouds(std::move(bytes), wanted, file.string(), memory, origin);
  } catch (const Unusable& unusable) {
    return {.clouds = {}, .ratios = {}, .why_unusable = unusable.why};
  }
}

}  // namespace lamina
