// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/mesh/files/internal/mtl_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "lamina/core/error.h"
#include "lamina/mesh/files/internal/mesh_text.h"

namespace lamina {
namespace {

class MtlReader {
 public:
  explicit MtlReader(const std::string& name) : name_(name) {}

  std::vector<FileMaterial> read(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      read_line(line.substr(0, line.find('#')));
    }
    for (std::size_t m = 0; m < materials_.size(); ++m)
      materials_[m].ignored.assign(ignored_[m].begin(), ignored_[m].end());
    return std::move(materials_);
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
      refuse("a number must be finite, but is \"" + std::string(word.substr(0, 40)) + "\"");
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
      const auto skip_numbers = [&] {
        for (int i = 0; i < 3; ++i) {
          std::string_view look = rest;
          if (!spelled_number(next(look))) return;
          rest = look;
        }
      };
      if (word == "-s") {
        result.repeat_u = number(rest, -1e4, 1e4);
        result.repeat_v = result.repeat_u;
        for (double* repeat : {&result.repeat_v}) {
          std::string_view look = rest;
          if (const auto value = spelled_number(next(look))) *repeat = *value, rest = look;
        }
        std::string_view look = rest;
        if (spelled_number(next(look))) rest = look;
      } else if (word == "-bm" && bump_scale != nullptr) {
        *bump_scale = number(rest, -1e6, 1e6);
      } else if (word == "-o" || word == "-t" || word == "-mm") {
        skip_numbers();
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
    const std::filesystem::path path = result.map;
    const bool leads_out = path.is_absolute() || std::ranges::find(path, "..") != path.end();
    if (result.map.empty() || leads_out || result.map.find('\0') != std::string::npos) {
      ignore("a texture outside of the folder");
      return std::nullopt;
    }
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
      ignore(std::string(keyword.substr(0, 40)));
    }
  }

  std::string name_;
  std::vector<FileMaterial> materials_;
  std::vector<std::set<std::string>> ignored_;  // [material], each name once
  int line_ = 0;
};

}  // namespace

std::vector<FileMaterial> parse_mtl(std::string_view text, const std::string& name) {
  return MtlReader(name).read(text);
}

}  // namespace lamina
