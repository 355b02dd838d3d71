// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/internal/mtl_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "lamina/base/core/error.h"
#include "lamina/base/io/utf8_text.h"
#include "lamina/scene/mesh/files/internal/mesh_text.h"

namespace lamina {
namespace {

class MtlReader {
 public:
  MtlReader(std::filesystem::path file, std::filesystem::path folder)
      : name_(file.string()), file_(std::move(file)), folder_(std::move(folder)) {}

  MtlFile read(std::string_view text) {
    text = without_byte_order_mark(text);
    const char end_of_line = end_of_lines(text);
    while (!text.empty()) {
      const std::size_t end = text.find(end_of_line);
      std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      read_line(line.substr(0, line.find('#')));
    }
    for (std::size_t m = 0; m < materials_.size(); ++m)
      materials_[m].ignored.assign(ignored_[m].begin(), ignored_[m].end());
    return {.materials = std::move(materials_), .notes = std::move(notes_)};
  }

 private:
  static std::string_view next(std::string_view& rest) {
    constexpr std::string_view blanks = " \t\r\f";
    const std::size_t begin = std::min(rest.find_first_not_of(blanks), rest.size());
    const std::size_t end = std::min(rest.find_first_of(blanks, begin), rest.size());
    const std::string_view word = rest.substr(begin, end - begin);
    rest.remove_prefix(end);
    return word;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(name_ + ":" + std::to_string(line_) + ": " + why);
  }

  double number(std::string_view& rest, double low, double high) const {
    const std::string_view word = next(rest);
    const std::optional<double> value = spelled_number(word);
    if (!value || !std::isfinite(*value))
      refuse("a number must be finite, but is \"" + excerpt(word) + "\"");
    return std::clamp(*value, low, high);
  }

  std::array<double, 3> color(std::string_view rest) const {
    std::array<double, 3> result{};
    result[0] = number(rest, 0.0, 1.0);
    std::string_view more = rest;
    if (next(more).empty()) return {result[0], result[0], result[0]};  // one for all
    result[1] = number(rest, 0.0, 1.0);
    result[2] = number(rest, 0.0, 1.0);
    return result;
  }

  /// Options that begin with a minus, and the file.
  std::optional<FileTexture> texture(std::string_view rest, double* bump_scale = nullptr) {
    FileTexture result;
    while (true) {
      std::string_view ahead = rest;
      const std::string_view word = next(ahead);
      if (word.empty()) return std::nullopt;
      if (word.front() != '-') break;
      rest = ahead;
      const auto take_numbers = [&] {
        std::vector<double> numbers;
        for (int i = 0; i < 3; ++i) {
          std::string_view look = rest;
          const std::optional<double> value = spelled_number(next(look));
          if (!value) break;
          numbers.push_back(std::isfinite(*value) ? std::clamp(*value, -1e4, 1e4) : 0.0);
          rest = look;
        }
        return numbers;
      };
      if (word == "-s") {
        const std::vector<double> s = take_numbers();
        if (s.empty()) refuse("-s must be followed by numbers");
        result.repeat_u = s[0];
        result.repeat_v = s.size() > 1 ? s[1] : s[0];
      } else if (word == "-o") {
        const std::vector<double> o = take_numbers();
        if (o.empty()) refuse("-o must be followed by numbers");
        result.shift_u = o[0];
        result.shift_v = o.size() > 1 ? o[1] : 0.0;
      } else if (word == "-bm" && bump_scale != nullptr) {
        *bump_scale = number(rest, -1e6, 1e6);
      } else if (word == "-t" || word == "-mm") {
        (void)take_numbers();
        ignore(std::string(word));
      } else {
        (void)next(rest);
        ignore(std::string(word));
      }
    }
    while (!rest.empty() && (rest.back() == ' ' || rest.back() == '\r' || rest.back() == '\t'))
      rest.remove_suffix(1);
    while (rest.starts_with(' ') || rest.starts_with('\t')) rest.remove_prefix(1);
    result.map = rest;
    std::ranges::replace(result.map, '\\', '/');
    result.place = name_ + ":" + std::to_string(line_);
    const std::filesystem::path path = result.map;
    if (result.map.empty() || result.map.find('\0') != std::string::npos) {
      ignore("a texture without a name");
      return std::nullopt;
    }
    const bool has_drive = result.map.size() > 1 && result.map[1] == ':';
    if (has_drive || path.is_absolute() || std::ranges::find(path, "..") != path.end()) {
      // The folder of who made the file; its textures are mostly sent along beside it.
      const std::filesystem::path beside = path.filename();
      std::error_code ignored;
      const bool lies_beside = std::filesystem::exists(file_.parent_path() / beside, ignored);
      notes_.push_back(result.place + ": the texture " + result.map +
                       (lies_beside
                            ? " lies elsewhere: " + beside.string() +
                                  " beside the file is "
                                  "taken"
                            : " is left out: it must lie in the folder of the file or below "
                              "it, and there is no " +
                                  beside.string()));
      if (!lies_beside) return std::nullopt;
      result.map = beside.string();
    }
    result.map = (folder_ / result.map).string();
    return result;
  }

  void ignore(std::string what) { ignored_.back().insert(std::move(what)); }

  void read_line(std::string_view rest) {
    const std::string_view keyword = next(rest);
    if (keyword.empty()) return;
    if (keyword == "newmtl") {
      constexpr std::size_t most = 100'000, longest = 1000;
      while (rest.starts_with(' ') || rest.starts_with('\t')) rest.remove_prefix(1);
      while (!rest.empty() && (rest.back() == ' ' || rest.back() == '\r' || rest.back() == '\t'))
        rest.remove_suffix(1);
      if (rest.size() > longest || materials_.size() == most)
        refuse("a name must not have more than 1000 bytes, nor a file more than 100000 materials");
      materials_.push_back({.name = std::string(rest)});
      materials_.back().has_specular = false;
      ignored_.emplace_back();
      return;
    }
    if (materials_.empty()) return;
    FileMaterial& material = materials_.back();
    if (keyword == "Kd") {
      material.base_color = color(rest);
    } else if (keyword == "map_Kd") {
      material.base_color_texture = texture(rest);
    } else if (keyword == "Ks") {
      const std::array<double, 3> c = color(rest);
      material.has_specular = std::max({c[0], c[1], c[2]}) > 0.0;
    } else if (keyword == "Ns") {
      const double exponent = number(rest, 0.0, 1e6);
      material.roughness = std::min(std::pow(2.0 / (exponent + 2.0), 0.25), 1.0);
    } else if (keyword == "Pr") {
      material.roughness = number(rest, 0.0, 1.0);
      material.has_specular = true;
    } else if (keyword == "Pm") {
      material.metallic = number(rest, 0.0, 1.0);
    } else if (keyword == "Ni") {
      material.ior = number(rest, 1.0, 10.0);
    } else if (keyword == "d") {
      material.opacity = number(rest, 0.0, 1.0);
    } else if (keyword == "Tr") {
      material.opacity = 1.0 - number(rest, 0.0, 1.0);
    } else if (keyword == "Ke") {
      material.emission = color(rest);
    } else if (keyword == "bump" || keyword == "map_bump" || keyword == "map_Bump") {
      material.bump_texture = texture(rest, &material.bump_scale);
    } else if (keyword == "norm") {
      material.normal_texture = texture(rest);
    } else if (keyword != "Ka" && keyword != "illum") {
      ignore(excerpt(keyword));
    }
  }

  std::string name_;
  std::filesystem::path file_, folder_;
  std::vector<std::string> notes_;
  std::vector<FileMaterial> materials_;
  std::vector<std::set<std::string>> ignored_;  // [material], each name once
  int line_ = 0;
};

}  // namespace

MtlFile parse_mtl(std::string_view text, const std::filesystem::path& file,
                  const std::filesystem::path& folder) {
  return MtlReader(file, folder).read(text);
}

}  // namespace lamina
