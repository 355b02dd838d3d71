// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/surface_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "lamina/base/core/hash.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr float least_agreement = 0.5f;     // of two normals within one cell
constexpr float elements_per_cell = 14.0f;  // about
constexpr float seed_distance = 0.79f;      // over the spacing: as dense as asked for

struct Corners {
  Vec3f p0, p1, p2;
};

Corners corners(const Mesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

float area_of_corners(const Corners& c) { return 0.5f * length(cross(c.p1 - c.p0, c.p2 - c.p0)); }

/// A point drawn on each element, as cells are made of.
struct Place {
  Vec3f position, normal;
};

/// A triangle, or a part of one, to cut, and where its elements go.
struct Piece {
  std::uint32_t mesh = 0, triangle = 0;
  std::array<Vec2f, 3> place = {Vec2f{0, 0}, {1, 0}, {0, 1}};  // of its corners: u, v
  std::uint32_t part = 0;  // of the triangle: 0 is all, 4 p + 1 to 4 p + 4 are quarters of p
  std::uint32_t cuts = 0;  // of each edge: into cuts² congruent elements
  std::size_t first = 0;
};

Corners corners(const std::vector<Mesh>& meshes, const Piece& piece) {
  const Corners c = corners(meshes[piece.mesh], piece.triangle);
  const auto at = [&](Vec2f uv) { return c.p0 + uv.x * (c.p1 - c.p0) + uv.y * (c.p2 - c.p0); };
  return {at(piece.place[0]), at(piece.place[1]), at(piece.place[2])};
}

float longest_edge(const Corners& c) {
  return std::max({length(c.p1 - c.p0), length(c.p2 - c.p1), length(c.p0 - c.p2)});
}

std::uint32_t count_cuts(const Corners& c, float spacing) {
  const float area = area_of_corners(c);
  if (!(area > 0.0f)) return 0;
  const float wanted = std::max(std::sqrt(elements_per_cell * area) / spacing,  // small enough,
                                longest_edge(c) / spacing);                     // slivers too
  return static_cast<std::uint32_t>(std::clamp(std::ceil(wanted), 1.0f, 4096.0f));
}

/// Cuts a triangle into congruent elements, with a random point on each.
void cut(const Corners& c, const Piece& piece, std::uint64_t seed, SurfaceElement* element) {
  const int n = static_cast<int>(piece.cuts);
  const float step = 1.0f / static_cast<float>(n), area = area_of_corners(c) * step * step;
  Random random = make_random(seed + (std::uint64_t{piece.part} << 32),
                              (std::uint64_t{piece.mesh} << 32) | piece.triangle);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * (n - i) - 1; ++j) {
      float a = random.uniform_float(), b = random.uniform_float();
      if (a + b > 1.0f) a = 1.0f - a, b = 1.0f - b;
      // Even ones point as the whole does, odd ones the other way.
      const bool is_upright = j % 2 == 0;
      const float u = step * (static_cast<float>(j / 2) + (is_upright ? a : 1.0f - a));
      const float v = step * (static_cast<float>(i) + (is_upright ? b : 1.0f - b));
      const auto& [p0, p1, p2] = piece.place;
      const Vec2f at = p0 + u * (p1 - p0) + v * (p2 - p0);
      *element++ = {piece.mesh, piece.triangle, at.x, at.y, area};
    }
}

/// Calls `body(i)` for each i in [begin, end), on all threads.
template <class Body>
void for_each_index(std::size_t begin, std::size_t end, const Body& body) {
  constexpr std::size_t chunk = 1024;
  parallel_for((end - begin + chunk - 1) / chunk, [&](std::size_t c) {
    const std::size_t first = begin + c * chunk;
    for (std::size_t i = first; i < std::min(end, first + chunk); ++i) body(i);
  });
}

/// Seeds that are found by place: a grid of cubes as wide as the distance that seeds keep.
class SeedGrid {
 public:
  SeedGrid(std::size_t expected, float distance)
      : distance_(distance), heads_(std::bit_ceil(2 * expected + 16), none) {}

  void add(const Place& place) {
    std::uint32_t& head = heads_[slot(cube(scaled(place.position)))];
    seeds_.push_back({place, head});
    head = static_cast<std::uint32_t>(seeds_.size() - 1);
  }

  /// The nearest seed within the distance whose normal agrees, or none; `any` such seed if that
  /// is enough.
  [[nodiscard]] std::uint32_t nearest(const Place& place, bool any) const {
    const Vec3f at = scaled(place.position);
    const Cube middle = cube(at);
    std::uint32_t found = none;
    float best = distance_ * distance_;
    for (const auto& step : nearest_first) {
      float to_cube2 = 0.0f;
      Cube near = middle;
      for (int axis = 0; axis < 3; ++axis) {
        near[axis] += step[axis];
        const float within = at[axis] - static_cast<float>(middle[axis]);
        const float gap = step[axis] == 0 ? 0.0f : step[axis] < 0 ? within : 1.0f - within;
        to_cube2 += gap * gap;
      }
      // A little more, for cubes are rounded.
      if (to_cube2 * distance_ * distance_ > 1.001f * best) continue;
      for (std::uint32_t s = heads_[slot(near)]; s != none; s = seeds_[s].next) {
        const Place& other = seeds_[s].place;
        const Vec3f offset = other.position - place.position;
        const float d2 = dot(offset, offset);
        if (d2 > best || (d2 == best && found <= s)) continue;
        if (dot(other.normal, place.normal) < least_agreement) continue;
        found = s;
        best = d2;
        if (any) return found;
      }
    }
    return found;
  }

  [[nodiscard]] std::size_t size() const { return seeds_.size(); }

 private:
  using Cube = std::array<std::int32_t, 3>;
  struct Seed {
    Place place;
    std::uint32_t next = none;  // in the same slot
  };

  [[nodiscard]] Vec3f scaled(const Vec3f& p) const {
    const auto bounded = [&](float x) { return std::clamp(x / distance_, -1e9f, 1e9f); };
    return {bounded(p.x), bounded(p.y), bounded(p.z)};
  }
  static Cube cube(const Vec3f& at) {
    const auto index = [](float x) { return static_cast<std::int32_t>(std::floor(x)); };
    return {index(at.x), index(at.y), index(at.z)};
  }
  [[nodiscard]] std::size_t slot(const Cube& c) const {
    return hash_cell(c[0], c[1], c[2]) & (heads_.size() - 1);
  }

  /// Steps to the cubes around one: itself, faces, edges, corners.
  static constexpr std::array<Cube, 27> nearest_first = [] {
    std::array<Cube, 27> steps{};
    std::size_t filled = 0;
    for (int far = 0; far <= 3; ++far)
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z)
            if (x * x + y * y + z * z == far) steps[filled++] = {x, y, z};
    return steps;
  }();

  float distance_;
  std::vector<std::uint32_t> heads_;
  std::vector<Seed> seeds_;
};

/// The surface seen from nowhere: only its place.
Place place_of(const std::vector<Mesh>& meshes, const SurfaceElement& e) {
  const SurfacePoint point = make_surface_point(
      meshes, {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle}, 0.0f);
  return {point.position, point.smooth_normal};
}

template <class OnTriangle>
void for_triangles(const std::vector<Mesh>& meshes, std::uint32_t material,
                   const OnTriangle& on_triangle) {
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t t = 0; t < meshes[m].triangles.size(); ++t)
      if (meshes[m].material[t] == material)
        on_triangle(corners(meshes[m], t), static_cast<std::uint32_t>(m),
                    static_cast<std::uint32_t>(t));
}

}  // namespace

std::uint64_t element_key(const SurfaceElement& element) {
  Hash hash;
  hash.add((std::uint64_t{element.mesh} << 32) | element.triangle);
  hash.add((std::uint64_t{std::bit_cast<std::uint32_t>(element.u)} << 32) |
           std::bit_cast<std::uint32_t>(element.v));
  return hash.value();
}

double surface_area(const std::vector<Mesh>& meshes, std::uint32_t material) {
  double area = 0.0;
  for_triangles(meshes, material, [&](const Corners& c, std::uint32_t, std::uint32_t) {
    area += static_cast<double>(area_of_corners(c));
  });
  return area;
}

namespace {

/// Quarters of a piece, appended to others.
void add_quarters(const Piece& piece, std::vector<Piece>& to) {
  const auto& [a, b, d] = piece.place;
  const Vec2f ab = 0.5f * (a + b), bd = 0.5f * (b + d), da = 0.5f * (d + a);
  std::uint32_t part = 4 * piece.part;
  for (const std::array<Vec2f, 3>& place : {std::array{a, ab, da}, std::array{ab, b, bd},
                                            std::array{da, bd, d}, std::array{ab, bd, da}})
    to.push_back(
        {.mesh = piece.mesh, .triangle = piece.triangle, .place = place, .part = ++part});
}

/// Lowest level of the field at the middle and the corners of a triangle.
int lowest_level(const SpacingField& field, const Corners& c) {
  int level = field.level((1.0f / 3.0f) * (c.p0 + c.p1 + c.p2));
  for (const Vec3f& corner : {c.p0, c.p1, c.p2}) level = std::min(level, field.level(corner));
  return level;
}

/// Visits the triangles of a material, and quarters of those of which a visit returns true, as
/// often as it does.
template <class Visit>  // (piece, its corners) -> whether to quarter it
void for_pieces(const std::vector<Mesh>& meshes, std::uint32_t material, const Visit& visit) {
  std::vector<Piece> open;
  for_triangles(meshes, material, [&](const Corners&, std::uint32_t mesh, std::uint32_t t) {
    open.push_back({.mesh = mesh, .triangle = t});
    while (!open.empty()) {
      const Piece piece = open.back();
      open.pop_back();
      if (visit(piece, corners(meshes, piece))) add_quarters(piece, open);
    }
  });
}

int level_of(const SpacingField& field, const Corners& c) {
  return field.level((1.0f / 3.0f) * (c.p0 + c.p1 + c.p2));
}

/// All triangles of a material, those that are wide against the field in parts: [level].
std::vector<std::vector<Piece>> make_pieces(const std::vector<Mesh>& meshes, std::uint32_t material,
                                            const SpacingField& field) {
  std::vector<std::vector<Piece>> pieces(field.is_even() ? 1 : SpacingField::levels);
  for_pieces(meshes, material, [&](const Piece& piece, const Corners& c) {
    const int level = level_of(field, c);
    if (level > 0 && longest_edge(c) > field.width(level)) return true;
    pieces[static_cast<std::size_t>(lowest_level(field, c))].push_back(piece);
    return false;
  });
  return pieces;
}

/// Pieces of a material as wide as the field's first level or less, of which those are left out
/// that do not touch it: wherever that is, each piece that stays is the same.
std::vector<Piece> make_pieces_of_first_level(const std::vector<Mesh>& meshes,
                                              std::uint32_t material, const SpacingField& field) {
  std::vector<Piece> pieces;
  for_pieces(meshes, material, [&](const Piece& piece, const Corners& c) {
    const float wide = longest_edge(c);
    const int level = level_of(field, c);
    // The first level ends two of its cubes from places that are seen along each axis, and those
    // are a width of the level below this one away, or more:
    // test SampledPlaces.AreThoseOfAnEyeNearby.
    constexpr float reach = 3.5f;
    if (level > 0 && wide <= field.width(level - 1) - reach * field.width(0)) return false;
    if (wide > field.width(0)) return true;
    if (lowest_level(field, c) == 0) pieces.push_back(piece);
    return false;
  });
  return pieces;
}

std::vector<SurfaceElement> cut_pieces(const std::vector<Mesh>& meshes, std::vector<Piece> pieces,
                                       float spacing, std::uint64_t seed) {
  std::size_t count = 0;
  for (Piece& piece : pieces) {
    piece.cuts = count_cuts(corners(meshes, piece), spacing);
    piece.first = count;
    count += std::size_t{piece.cuts} * piece.cuts;
  }
  std::vector<SurfaceElement> elements(count);
  for_each_index(0, pieces.size(), [&](std::size_t i) {
    if (pieces[i].cuts > 0)
      cut(corners(meshes, pieces[i]), pieces[i], seed, &elements[pieces[i].first]);
  });
  return elements;
}

/// Elements in random order, in which any two of them come whatever the others are.
std::vector<std::uint32_t> random_order(const std::vector<SurfaceElement>& elements,
                                        std::uint64_t seed) {
  std::vector<std::uint64_t> keys(elements.size());
  for_each_index(0, keys.size(), [&](std::size_t i) {
    const std::uint64_t mixed =
        (element_key(elements[i]) ^ seed * 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
    keys[i] = mixed >> 32 << 32 | i;
  });
  std::ranges::sort(keys);
  return {keys.begin(), keys.end()};
}

/// A maximal Poisson-disk set of the places, taken in an order.
SeedGrid choose_seeds(const std::vector<Place>& places, const std::vector<std::uint32_t>& order,
                      float spacing) {
  const std::size_t count = places.size();
  SeedGrid seeds(count / static_cast<std::size_t>(elements_per_cell), seed_distance * spacing);
  // All threads look at a batch; what no earlier seed is near is looked at again, one by one,
  // beside the new seeds of its batch. So the set is that of one thread.
  std::vector<char> may_be_seed;
  for (std::size_t begin = 0; begin < count;) {
    const std::size_t end =
        std::min(count, begin + std::clamp<std::size_t>(seeds.size(), 256, 65536));
    may_be_seed.assign(end - begin, 0);
    for_each_index(begin, end, [&](std::size_t i) {
      may_be_seed[i - begin] = seeds.nearest(places[order[i]], true) == none;
    });
    for (std::size_t i = begin; i < end; ++i)
      if (may_be_seed[i - begin] && seeds.nearest(places[order[i]], true) == none)
        seeds.add(places[order[i]]);
    begin = end;
  }
  return seeds;
}

SurfaceCells make_cells(const std::vector<Mesh>& meshes,
                        const std::vector<SurfaceElement>& elements, float spacing,
                        std::uint64_t seed) {
  const std::size_t count = elements.size();
  SurfaceCells result;
  std::vector<std::uint32_t> owner(count);
  {
    std::vector<Place> places(count);
    for_each_index(0, count, [&](std::size_t i) { places[i] = place_of(meshes, elements[i]); });
    const SeedGrid seeds = choose_seeds(places, random_order(elements, seed), spacing);
    for_each_index(0, count, [&](std::size_t i) { owner[i] = seeds.nearest(places[i], false); });
    result.cells.resize(seeds.size());
    for (std::size_t i = 0; i < count; ++i) {
      SurfaceCell& cell = result.cells[owner[i]];
      const float area = elements[i].area;
      ++cell.count;
      cell.area += area;
      cell.position += area * places[i].position;
      cell.normal += area * places[i].normal;
    }
  }
  // Elements side by side by cell: a counting sort, with `first` as the place of the next.
  std::uint32_t filled = 0;
  for (SurfaceCell& cell : result.cells) {
    cell.first = filled;
    filled += cell.count;
  }
  result.elements.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    result.elements[result.cells[owner[i]].first++] = elements[i];
  for (SurfaceCell& cell : result.cells) {
    cell.first -= cell.count;
    cell.position *= 1.0f / cell.area;
    cell.normal = normalize(cell.normal);
    result.area += static_cast<double>(cell.area);
  }
  return result;
}

}  // namespace

std::vector<SurfaceCells> make_surface_cells(const std::vector<Mesh>& meshes,
                                             std::uint32_t material, const SpacingField& field,
                                             std::uint64_t seed) {
  std::vector<SurfaceCells> cells;
  for (const std::vector<Piece>& pieces : make_pieces(meshes, material, field)) {
    const float spacing = field.spacing(static_cast<int>(cells.size()));
    cells.push_back(make_cells(meshes, cut_pieces(meshes, pieces, spacing, seed), spacing, seed));
  }
  return cells;
}

SurfaceCells make_surface_cells(const std::vector<Mesh>& meshes, std::uint32_t material,
                                float spacing, std::uint64_t seed) {
  return std::move(make_surface_cells(meshes, material, SpacingField(spacing), seed).front());
}

SurfaceCells make_surface_cells_of_first_level(const std::vector<Mesh>& meshes,
                                               std::uint32_t material, const SpacingField& field,
                                               std::uint64_t seed) {
  const float spacing = field.spacing(0);
  auto pieces = make_pieces_of_first_level(meshes, material, field);
  return make_cells(meshes, cut_pieces(meshes, std::move(pieces), spacing, seed), spacing, seed);
}

std::vector<double> expected_cells(const std::vector<Mesh>& meshes, std::uint32_t material,
                                   const SpacingField& field) {
  std::vector<double> counts;
  for (const std::vector<Piece>& pieces : make_pieces(meshes, material, field)) {
    const auto spacing = static_cast<double>(field.spacing(static_cast<int>(counts.size())));
    double area = 0.0;
    for (const Piece& piece : pieces)
      area += static_cast<double>(area_of_corners(corners(meshes, piece)));
    counts.push_back(area / (spacing * spacing));
  }
  return counts;
}

}  // namespace lamina
