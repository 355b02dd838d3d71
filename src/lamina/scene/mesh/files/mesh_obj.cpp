// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "lamina/base/core/error.h"
#include "lamina/base/io/utf8_text.h"
#include "lamina/scene/mesh/files/internal/mesh_text.h"
#include "lamina/scene/mesh/files/mesh_file.h"

namespace lamina {
namespace {

constexpr bool is_blank_in_line(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f'; }

/// The words of a line, one after another.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  /// The next word, or an empty one at the end.
  std::string_view next() {
    skip_blanks();
    std::size_t end = 0;
    while (end < rest_.size() && !is_blank_in_line(rest_[end])) ++end;
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }

  /// All that is left, without blanks around it.
  std::string_view rest() {
    skip_blanks();
    while (!rest_.empty() && is_blank_in_line(rest_.back())) rest_.remove_suffix(1);
    return rest_;
  }

 private:
  void skip_blanks() {
    while (!rest_.empty() && is_blank_in_line(rest_.front())) rest_.remove_prefix(1);
  }
  std::string_view rest_;
};

class ObjReader {
 public:
  ObjReader(const std::string& name, MemoryBudget memory) : memory_(memory) { mesh_.name = name; }

  PolygonMesh read(std::string_view text) {
    std::string joined;  // a line that goes on after a backslash
    text = without_byte_order_mark(text);
    const char end_of_line = end_of_lines(text);
    while (!text.empty()) {
      const std::size_t end = text.find(end_of_line);
      std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      while (!line.empty() && is_blank_in_line(line.back())) line.remove_suffix(1);
      if (!line.empty() && line.back() == '\\') {
        joined += line.substr(0, line.size() - 1);
        joined += ' ';
        continue;
      }
      if (joined.empty()) {
        read_line(line);
      } else {
        joined += line;
        read_line(joined);
        joined.clear();
      }
    }
    if (face_count(mesh_) == 0) throw FileError(mesh_.name + ": holds no faces");
    mesh_.uv_sets = mesh_.uvs.empty() ? 0 : 1;
    finish_colors();
    set_positions(mesh_, positions_);
    mesh_.material_libraries = std::move(libraries_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(mesh_.name + ":" + std::to_string(line_) + ": " + why);
  }

  void read_line(std::string_view line) {
    Words words(line.substr(0, line.find('#')));
    const std::string_view keyword = words.next();
    if (keyword == "v" || keyword == "vt" || keyword == "vn")
      take_growing(memory_, sizeof(Vec3), mesh_.name);
    if (keyword == "v") {
      const auto what = [&] { return "vertex " + std::to_string(positions_.size() + 1); };
      const double x = exact_number(words, what), y = exact_number(words, what);
      positions_.push_back({x, y, exact_number(words, what)});
      read_color(words, what);
    } else if (keyword == "vt") {
      const auto what = [&] { return "vt " + std::to_string(mesh_.uvs.size() + 1); };
      mesh_.uvs.push_back({number(words, what), optional_number(words, what)});
    } else if (keyword == "vn") {
      const auto what = [&] { return "vn " + std::to_string(mesh_.normals.size() + 1); };
      mesh_.normals.push_back({number(words, what), number(words, what), number(words, what)});
    } else if (keyword == "f") {
      read_face(words);
    } else if (keyword == "g") {
      group_ = label(words);
    } else if (keyword == "o") {
      object_ = label(words);
    } else if (keyword == "usemtl") {
      material_ = label(words);
    } else if (keyword == "mtllib") {
      if (const std::string library(words.rest()); !library.empty() && libraries_.size() < 100)
        libraries_.push_back(library);
    } else if (keyword == "t") {
      read_tag(words);
    } else if ((keyword == "surf" || keyword == "curv") && !has_free_forms_) {
      has_free_forms_ = true;
      mesh_.notes.push_back(mesh_.name + ":" + std::to_string(line_) +
                            ": free-form curves and surfaces are left out");
    }  // the rest (smoothing groups, lines, points) does not concern the shape
  }

  /// Three numbers behind a position; a single one is a weight, which is left out.
  template <class What>
  void read_color(Words& words, const What& what) {
    const std::string_view r = words.next(), g = words.next(), b = words.next();
    if (b.empty()) return;
    take_growing(memory_, sizeof(Vec3f), mesh_.name);
    mesh_.colors.resize(positions_.size() - 1, no_color);
    const auto given = [&](std::string_view word) {
      const float value = std::max(parse_number(word, what), 0.0F);
      color_range_.add(static_cast<double>(value), line_);
      return value;
    };
    const float red = given(r), green = given(g);
    mesh_.colors.push_back({red, green, given(b)});
  }

  /// Makes linear colors of what vertices have, once the range of all is known.
  void finish_colors() {
    if (mesh_.colors.empty()) return;
    const std::string place = mesh_.name + ":" + std::to_string(color_range_.line());
    if (!color_range_.is_known()) {
      mesh_.notes.push_back(place + colors_left_out(color_range_.largest()));
      mesh_.colors.clear();
      return;
    }
    if (color_range_.is_bytes()) mesh_.notes.push_back(place + std::string(colors_are_bytes));
    const float largest = color_range_.is_bytes() ? 255.0F : 1.0F;
    mesh_.colors.resize(positions_.size(), no_color);
    for (Vec3f& color : mesh_.colors)
      for (int c = 0; c < 3; ++c)
        color[c] = color[c] < 0.0F ? 1.0F : srgb_to_linear(std::min(color[c] / largest, 1.0F));
    for (MeshCorner& corner : mesh_.corners) corner.color = corner.position;
  }

  /// `t crease 2/1/0 A B SHARPNESS`, vertices counted from 0, as OpenSubdiv's examples have it.
  void read_tag(Words& words) {
    if (words.next() != "crease") return;
    const auto what = [] { return std::string("t crease"); };
    if (words.next() != "2/1/0") refuse("t crease must read 2/1/0 VERTEX VERTEX SHARPNESS");
    std::array<std::uint32_t, 2> ends{};
    for (std::uint32_t& end : ends) {
      const float given = number(words, what);
      if (!(given >= 0.0F && given < static_cast<float>(positions_.size())) ||
          given != std::floor(given))
        refuse("a vertex of t crease must lie in [0, " + std::to_string(positions_.size()) + ")");
      end = static_cast<std::uint32_t>(given);
    }
    const float sharpness = number(words, what);
    if (!(sharpness >= 0.0F)) refuse("the sharpness of t crease must be >= 0");
    take_growing(memory_, sizeof(MeshCrease), mesh_.name);
    if (sharpness > 0.0F && ends[0] != ends[1])
      mesh_.creases.push_back({ends[0], ends[1], sharpness});
  }

  /// A name of the part that the faces to come belong to.
  std::string label(Words& words) {
    constexpr std::size_t longest = 1000;  // each part copies it
    const std::string_view name = words.rest();
    if (name.size() > longest) refuse("a name must not have more than 1000 bytes");
    part_.reset();
    return std::string(name);
  }

  /// `what` names the thing that the number belongs to.
  template <class What>
  float number(Words& words, const What& what) const {
    const std::string_view word = words.next();
    if (word.empty()) refuse(what() + " is cut off: a number is missing");
    return parse_number(word, what);
  }

  template <class What>
  double exact_number(Words& words, const What& what) const {
    const std::string_view word = words.next();
    if (word.empty()) refuse(what() + " is cut off: a number is missing");
    (void)parse_number(word, what);  // refuses what is none
    return *spelled_number(word);
  }

  template <class What>
  float optional_number(Words& words, const What& what) const {
    const std::string_view word = words.next();
    return word.empty() ? 0.0F : parse_number(word, what);
  }

  template <class What>
  float parse_number(std::string_view word, const What& what) const {
    const std::optional<double> value = spelled_number(word);
    if (!value || !std::isfinite(static_cast<float>(*value)))
      refuse(what() + ": every number must be finite, but one is \"" + excerpt(word) + "\"");
    return static_cast<float>(*value);
  }

  void read_face(Words& words) {
    face_.clear();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      MeshCorner corner;
      corner.position = index(word, positions_.size(), "v");
      if (take_slash(word)) {
        if (!word.empty() && word.front() != '/') corner.uv = index(word, mesh_.uvs.size(), "vt");
        if (take_slash(word)) corner.normal = index(word, mesh_.normals.size(), "vn");
      }
      if (!word.empty())
        refuse("a corner of a face must read v, v/vt, v//vn or v/vt/vn, but goes on with \"" +
               excerpt(word) + "\"");
      face_.push_back(corner);
    }
    if (face_.size() < 3)
      refuse("a face must have at least 3 corners, but has " + std::to_string(face_.size()));
    take_growing(memory_, face_.size() * sizeof(MeshCorner), mesh_.name);
    add_face(mesh_, face_, part());
  }

  static bool take_slash(std::string_view& word) {
    if (word.empty() || word.front() != '/') return false;
    word.remove_prefix(1);
    return true;
  }

  /// Takes an index from the front of a word: counted from 1, or back from the latest if negative.
  std::uint32_t index(std::string_view& word, std::size_t count, const char* kind) const {
    long long given = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), given);
    const auto size = static_cast<long long>(count);
    const auto found = code == std::errc() ? (given < 0 ? size + given : given - 1) : -1;
    if (found < 0 || found >= size)
      refuse(std::string("an index of ") + kind + " must lie in [1, " + std::to_string(count) +
             "] or count back from the latest, but is \"" +
             excerpt(word.substr(0, word.find('/'))) + "\"");
    word.remove_prefix(static_cast<std::size_t>(end - word.data()));
    return static_cast<std::uint32_t>(found);
  }

  std::uint32_t part() {
    if (!part_) {
      std::vector<std::string> labels;
      for (const std::string& label : {material_, group_, object_})
        if (!label.empty()) labels.push_back(label);
      const auto next = static_cast<std::uint32_t>(mesh_.parts.size());
      const auto [found, is_new] = part_of_labels_.try_emplace(labels, next);
      if (is_new) {
        std::size_t size = sizeof(MeshPart);
        for (const std::string& each : labels) size += sizeof each + each.size();
        take_growing(memory_, size, mesh_.name);
        mesh_.parts.push_back({.labels = std::move(labels)});
      }
      part_ = found->second;
    }
    return *part_;
  }

  MemoryBudget memory_;
  static constexpr Vec3f no_color{-1, -1, -1};  // of vertices, which are white then
  PolygonMesh mesh_;
  std::vector<Vec3> positions_;
  VertexColorRange color_range_;
  std::vector<MeshCorner> face_;
  std::string material_, group_, object_;
  std::vector<std::string> libraries_;
  std::map<std::vector<std::string>, std::uint32_t> part_of_labels_;
  std::optional<std::uint32_t> part_;  // that material, group and object name
  bool has_free_forms_ = false;
  int line_ = 0;
};

}  // namespace

PolygonMesh parse_obj(std::string_view bytes, const std::string& name, MemoryBudget memory) {
  return ObjReader(name, memory).read(bytes);
}

}  // namespace lamina
