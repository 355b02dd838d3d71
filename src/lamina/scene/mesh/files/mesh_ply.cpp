// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/utf8_text.h"
#include "lamina/scene/mesh/files/internal/mesh_text.h"
#include "lamina/scene/mesh/files/mesh_file.h"

namespace lamina {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::array<std::pair<std::string_view, Type>, 16> type_names{{
    {"char", Type::int8},
    {"int8", Type::int8},
    {"uchar", Type::uint8},
    {"uint8", Type::uint8},
    {"short", Type::int16},
    {"int16", Type::int16},
    {"ushort", Type::uint16},
    {"uint16", Type::uint16},
    {"int", Type::int32},
    {"int32", Type::int32},
    {"uint", Type::uint32},
    {"uint32", Type::uint32},
    {"float", Type::float32},
    {"float32", Type::float32},
    {"double", Type::float64},
    {"float64", Type::float64},
}};

constexpr std::size_t size_of(Type type) {
  switch (type) {
    case Type::int8:
    case Type::uint8:
      return 1;
    case Type::int16:
    case Type::uint16:
      return 2;
    case Type::int32:
    case Type::uint32:
    case Type::float32:
      return 4;
    case Type::float64:
      return 8;
  }
  return 0;
}

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> list_count;  ///< the type of a list's length; absent for a single value
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

enum class Format { ascii, little_endian, big_endian };

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string_view next_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// The values after the header, one after another. Every value of PLY fits a double.
class Values {
 public:
  Values(std::string_view bytes, Format format, const std::string& name)
      : rest_(bytes), format_(format), name_(&name) {}

  /// How often values of these types can still follow.
  [[nodiscard]] std::size_t most(std::span<const Type> types) const {
    std::size_t together = 0;
    for (const Type type : types) together += format_ == Format::ascii ? 2 : size_of(type);
    return (rest_.size() + (format_ == Format::ascii ? 1 : 0)) / together;
  }

  /// `what` names what is being read, for messages.
  template <class What>
  double next(Type type, const What& what) {
    if (format_ == Format::ascii) return next_spelled(what);
    const std::size_t size = size_of(type);
    if (rest_.size() < size) throw FileError(*name_ + ": is cut off within " + what());
    std::array<char, 8> bytes{};
    std::copy_n(rest_.begin(), size, bytes.begin());
    rest_.remove_prefix(size);
    const bool is_native =
        (format_ == Format::little_endian) == (std::endian::native == std::endian::little);
    if (!is_native) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case Type::int8:
        return as<std::int8_t>(bytes);
      case Type::uint8:
        return as<std::uint8_t>(bytes);
      case Type::int16:
        return as<std::int16_t>(bytes);
      case Type::uint16:
        return as<std::uint16_t>(bytes);
      case Type::int32:
        return as<std::int32_t>(bytes);
      case Type::uint32:
        return as<std::uint32_t>(bytes);
      case Type::float32:
        return static_cast<double>(as<float>(bytes));
      case Type::float64:
        return as<double>(bytes);
    }
    return 0.0;
  }

 private:
  template <class T>
  static T as(const std::array<char, 8>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  template <class What>
  double next_spelled(const What& what) {
    const std::string_view word = next_word(rest_);
    if (word.empty()) throw FileError(*name_ + ": is cut off within " + what());
    const std::optional<double> value = spelled_number(word);
    if (!value)
      throw FileError(*name_ + ": " + what() + " must hold numbers, but has \"" + excerpt(word) +
                      "\"");
    return *value;
  }

  std::string_view rest_;
  Format format_;
  const std::string* name_;
};

class PlyReader {
 public:
  PlyReader(const std::string& name, MemoryBudget memory) : memory_(memory) {
    mesh_.name = name;
    mesh_.parts = {{}};
  }

  PolygonMesh read(std::string_view bytes) {
    read_header(bytes);
    Values values(bytes, format_, mesh_.name);
    for (const Element& element : elements_) {
      check_count(element, values);
      if (element.name == "vertex") {
        read_vertices(element, values);
      } else if (element.name == "face") {
        read_faces(element, values);
      } else if (element.name == "edge") {
        read_edges(element, values);
      } else if (element.name == "tristrips") {
        refuse("holds triangle strips, which must be turned into faces first");
      } else {
        for (std::size_t i = 0; i < element.count; ++i)
          for (const Property& property : element.properties)
            skip(property, values, [&] { return place(element, i); });
      }
    }
    finish();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(mesh_.name + ": " + why);
  }

  static std::string place(const Element& element, std::size_t i) {
    return element.name + " " + std::to_string(i) + " of " + std::to_string(element.count);
  }

  /// Takes the header from the front of the file.
  void read_header(std::string_view& bytes) {
    bool has_format = false;
    std::set<std::string> element_names;
    // Old Macs end lines by a carriage return alone.
    const bool is_of_mac = bytes.starts_with("ply\r") && !bytes.starts_with("ply\r\n");
    for (int line_number = 1;; ++line_number) {
      const std::size_t end = bytes.find(is_of_mac ? '\r' : '\n');
      if (line_number == 1 && !bytes.starts_with("ply"))
        refuse("must begin with \"ply\", but does not: it is no PLY file");
      if (end == std::string_view::npos) refuse("the header is cut off: \"end_header\" is missing");
      std::string_view line = bytes.substr(0, end);
      bytes.remove_prefix(end + 1);
      const std::string where = "line " + std::to_string(line_number) + " of the header ";
      const std::string_view keyword = next_word(line);
      if (keyword == "end_header") break;
      if (keyword == "element" || keyword == "property")
        take_memory(memory_, per_declaration + 4 * end, mesh_.name + ": the header");
      if (keyword == "format") {
        has_format = true;
        format_ = parse_format(next_word(line), where);
      } else if (keyword == "element") {
        elements_.push_back(parse_element(line, where));
        if (!element_names.insert(elements_.back().name).second)
          refuse(where + "names element " + excerpt(elements_.back().name) + " again");
      } else if (keyword == "property") {
        if (elements_.empty()) refuse(where + "has a property before any element");
        elements_.back().properties.push_back(parse_property(line, where));
      } else if (line_number > 1 && keyword != "comment" && keyword != "obj_info" &&
                 !keyword.empty()) {
        refuse(where + "begins with unknown \"" + excerpt(keyword) + "\"");
      }
    }
    if (!has_format) refuse("the header must name a format, but does not");
  }

  Format parse_format(std::string_view word, const std::string& where) const {
    if (word == "ascii") return Format::ascii;
    if (word == "binary_little_endian") return Format::little_endian;
    if (word == "binary_big_endian") return Format::big_endian;
    refuse(where + "must name ascii, binary_little_endian or binary_big_endian, but names \"" +
           excerpt(word) + "\"");
  }

  Element parse_element(std::string_view line, const std::string& where) const {
    Element element{.name = std::string(next_word(line))};
    const std::string_view count = next_word(line);
    const auto [end, code] =
        std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (element.name.empty() || code != std::errc() || end != count.data() + count.size())
      refuse(where + "must read: element NAME COUNT");
    return element;
  }

  Property parse_property(std::string_view line, const std::string& where) const {
    const auto type = [&](std::string_view word) {
      const auto* const found =
          std::ranges::find(type_names, word, [](auto& t) { return t.first; });
      if (found == type_names.end())
        refuse(where + "has an unknown type \"" + excerpt(word) + "\"");
      return found->second;
    };
    Property property;
    std::string_view word = next_word(line);
    if (word == "list") {
      property.list_count = type(next_word(line));
      word = next_word(line);
    }
    property.type = type(word);
    property.name = next_word(line);
    if (property.name.empty()) refuse(where + "has a property without a name");
    return property;
  }

  /// Refuses a count that the rest of the file cannot hold, before anything is allocated for it.
  void check_count(const Element& element, const Values& values) const {
    if (element.count == 0) return;
    if (element.properties.empty())
      refuse("element " + excerpt(element.name) + " has no properties");
    const Property& first = element.properties.front();
    const Type least = first.list_count.value_or(first.type);
    if (element.count > values.most({&least, 1}) || element.count >= no_index)
      refuse("is cut off: the header promises " + std::to_string(element.count) + " of " +
             excerpt(element.name) + ", which do not fit into the file");
  }

  template <class What>
  static std::size_t list_size(const Property& property, Values& values, const What& what) {
    const double count = values.next(*property.list_count, what);
    if (!(count >= 0.0 && count <= static_cast<double>(values.most({&property.type, 1}))))
      return no_index;
    return static_cast<std::size_t>(count);
  }

  template <class What>
  void skip(const Property& property, Values& values, const What& what) const {
    std::size_t count = 1;
    if (property.list_count) count = checked_list_size(property, values, what);
    for (std::size_t i = 0; i < count; ++i) (void)values.next(property.type, what);
  }

  template <class What>
  std::size_t checked_list_size(const Property& property, Values& values, const What& what) const {
    const std::size_t count = list_size(property, values, what);
    if (count == no_index)
      refuse(what() + ": a list is longer than the rest of the file, or its length is negative");
    return count;
  }

  void read_vertices(const Element& element, Values& values) {
    enum Slot { x, y, z, nx, ny, nz, u, v, r, g, b, slots, ignored = slots };
    constexpr std::array<std::pair<std::string_view, Slot>, 23> names{{
        {"x", x},
        {"y", y},
        {"z", z},
        {"nx", nx},
        {"ny", ny},
        {"nz", nz},
        {"u", u},
        {"v", v},
        {"s", u},
        {"t", v},
        {"texture_u", u},
        {"texture_v", v},
        {"texture_s", u},
        {"texture_t", v},
        {"red", r},
        {"green", g},
        {"blue", b},
        {"r", r},
        {"g", g},
        {"b", b},
        {"diffuse_red", r},
        {"diffuse_green", g},
        {"diffuse_blue", b},
    }};
    std::vector<Slot> slot_of;  // [property]
    std::array<bool, slots + 1> has{};
    for (const Property& property : element.properties) {
      const auto* const found =
          std::ranges::find(names, property.name, [](auto& entry) { return entry.first; });
      const bool is_known = found != names.end() && !property.list_count;
      slot_of.push_back(is_known ? found->second : ignored);
      has[slot_of.back()] = true;
    }
    if (element.count > 0 && !(has[x] && has[y] && has[z]))
      refuse("element vertex must have the properties x, y and z");
    const bool has_normals = has[nx] && has[ny] && has[nz];
    has_uvs_ = has[u] && has[v];
    has_colors_ = has[r] && has[g] && has[b];
    std::vector<Type> types;  // of what a vertex has at least
    for (const Property& property : element.properties)
      types.push_back(property.list_count.value_or(property.type));
    const std::size_t most = std::min(element.count, values.most(types) + 1);  // one may be cut
    take_memory(memory_, most, sizeof(Vec3) + (has_colors_ ? 3 : 2) * sizeof(Vec3f) + sizeof(Vec2f),
                mesh_.name + ": its vertices");
    positions_.reserve(most);
    if (has_normals) mesh_.normals.reserve(most);
    if (has_uvs_) mesh_.uvs.reserve(most);
    for (std::size_t i = 0; i < element.count; ++i) {
      const auto what = [&] { return place(element, i); };
      std::array<float, slots + 1> given{};
      Vec3 position;
      for (std::size_t p = 0; p < slot_of.size(); ++p) {
        if (slot_of[p] == ignored) {
          skip(element.properties[p], values, what);
          continue;
        }
        const double value = values.next(element.properties[p].type, what);
        given[slot_of[p]] = static_cast<float>(value);
        if (slot_of[p] <= z) position[slot_of[p] - x] = value;
        if (r <= slot_of[p] && slot_of[p] <= b)
          given[slot_of[p]] = color_component(value, element.properties[p].type);
        if (!std::isfinite(given[slot_of[p]]) && !(nx <= slot_of[p] && slot_of[p] <= nz))
          refuse(what() + ": " + excerpt(element.properties[p].name) + " must be finite, but is " +
                 number_text(value));
      }
      positions_.push_back(position);
      if (has_normals) mesh_.normals.push_back({given[nx], given[ny], given[nz]});
      if (has_uvs_) mesh_.uvs.push_back({given[u], given[v]});
      if (has_colors_) mesh_.colors.push_back({given[r], given[g], given[b]});
    }
  }

  /// Of 8 and 16 bits by sRGB; others as they are until the range of all is known.
  float color_component(double value, Type type) {
    const double largest = type == Type::uint8 ? 255.0 : type == Type::uint16 ? 65535.0 : 0.0;
    if (largest > 0.0) return srgb_to_linear(static_cast<float>(value / largest));
    color_range_.add(value, 0);
    return static_cast<float>(value);
  }

  /// Colors of other types are linear in [0, 1], or bytes in wider numbers.
  void finish_colors() {
    if (!has_colors_) return;
    if (!color_range_.is_known()) {
      mesh_.notes.push_back(mesh_.name + colors_left_out(color_range_.largest()));
      mesh_.colors.clear();
      return;
    }
    if (color_range_.is_bytes()) {
      mesh_.notes.push_back(mesh_.name + std::string(colors_are_bytes));
      for (Vec3f& color : mesh_.colors)
        for (int c = 0; c < 3; ++c) color[c] = srgb_to_linear(std::max(color[c], 0.0F) / 255.0F);
    }
    for (MeshCorner& corner : mesh_.corners) corner.color = corner.position;
  }

  /// Creases: vertex1, vertex2, and a sharpness under the name crease or sharpness.
  void read_edges(const Element& element, Values& values) {
    for (std::size_t i = 0; i < element.count; ++i) {
      const auto what = [&] { return place(element, i); };
      MeshCrease crease{no_index, no_index, 0.0F};
      for (const Property& property : element.properties) {
        if (!property.list_count && property.name == "vertex1")
          crease.a = index(values.next(property.type, what), what);
        else if (!property.list_count && property.name == "vertex2")
          crease.b = index(values.next(property.type, what), what);
        else if (!property.list_count &&
                 (property.name == "crease" || property.name == "sharpness"))
          crease.sharpness = static_cast<float>(values.next(property.type, what));
        else
          skip(property, values, what);
      }
      if (!(crease.sharpness > 0.0F) || crease.a == crease.b) continue;
      take_growing(memory_, sizeof crease, mesh_.name);
      mesh_.creases.push_back(crease);
    }
  }

  void read_faces(const Element& element, Values& values) {
    const auto& properties = element.properties;
    const auto is_indices = [](const Property& p) {
      return p.list_count && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (element.count > 0 && std::ranges::none_of(properties, is_indices))
      refuse("element face must have a list vertex_indices");
    if (element.count > 0 &&
        std::ranges::any_of(properties, [](const Property& p) { return p.name == "red"; }))
      mesh_.notes.push_back(mesh_.name +
                            ": colors of faces are left out, for lamina takes those of vertices");
    std::vector<MeshCorner> corners;
    std::vector<double> texcoords;  // u, v of each corner
    for (std::size_t i = 0; i < element.count; ++i) {
      const auto what = [&] { return place(element, i); };
      corners.clear();
      texcoords.clear();
      for (const Property& property : properties) {
        if (is_indices(property)) {
          corners.resize(checked_list_size(property, values, what));
          for (MeshCorner& corner : corners)
            corner.position = index(values.next(property.type, what), what);
        } else if (property.list_count && property.name == "texcoord") {
          texcoords.resize(checked_list_size(property, values, what));
          for (double& t : texcoords) t = values.next(property.type, what);
        } else {
          skip(property, values, what);
        }
      }
      if (corners.size() < 3)
        refuse(what() + " must have at least 3 corners, but has " + std::to_string(corners.size()));
      take_growing(memory_, corners.size() * (sizeof(MeshCorner) + sizeof(Vec2f)), mesh_.name);
      if (texcoords.size() == 2 * corners.size()) add_face_uvs(corners, texcoords, what);
      add_face(mesh_, corners, 0);
    }
  }

  /// Texture coordinates given per corner, as MeshLab writes them.
  template <class What>
  void add_face_uvs(std::vector<MeshCorner>& corners, const std::vector<double>& texcoords,
                    const What& what) {
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Vec2f uv{static_cast<float>(texcoords[2 * c]),
                     static_cast<float>(texcoords[2 * c + 1])};
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
        refuse(what() + ": texcoord must be finite");
      corners[c].uv = static_cast<std::uint32_t>(face_uvs_.size());
      face_uvs_.push_back(uv);
    }
  }

  template <class What>
  std::uint32_t index(double given, const What& what) const {
    if (!(given >= 0.0 && given < static_cast<double>(no_index)) || given != std::floor(given))
      refuse(what() + ": a vertex index must be a whole number >= 0, but is " + number_text(given));
    return static_cast<std::uint32_t>(given);
  }

  /// Checks the indices, which may stand before the vertices, and points them at what there is.
  void finish() {
    if (face_count(mesh_) == 0) refuse("holds no faces");
    for (std::size_t f = 0; f < face_count(mesh_); ++f)
      for (std::size_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
        MeshCorner& corner = mesh_.corners[c];
        if (corner.position >= positions_.size())
          refuse("face " + std::to_string(f) + ": a vertex index must be < " +
                 std::to_string(positions_.size()) + ", but is " + std::to_string(corner.position));
        if (!mesh_.normals.empty()) corner.normal = corner.position;
        if (face_uvs_.empty() && has_uvs_) corner.uv = corner.position;
      }
    if (!face_uvs_.empty()) mesh_.uvs = std::move(face_uvs_);
    mesh_.uv_sets = mesh_.uvs.empty() ? 0 : 1;
    finish_colors();
    for (const MeshCrease& crease : mesh_.creases)
      if (crease.a >= positions_.size() || crease.b >= positions_.size())
        refuse("element edge: a vertex index must be < " + std::to_string(positions_.size()));
    set_positions(mesh_, positions_);
  }

  static constexpr std::size_t per_declaration = 256;  // of an element or a property
  MemoryBudget memory_;
  PolygonMesh mesh_;
  std::vector<Vec3> positions_;
  VertexColorRange color_range_;
  Format format_ = Format::ascii;
  std::vector<Element> elements_;
  bool has_uvs_ = false;         // per vertex
  bool has_colors_ = false;      // per vertex
  std::vector<Vec2f> face_uvs_;  // per corner
};

}  // namespace

PolygonMesh parse_ply(std::string_view bytes, const std::string& name, MemoryBudget memory) {
  return PlyReader(name, memory).read(bytes);
}

}  // namespace lamina
