// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/mesh/mesh_orientation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "lamina/core/vec_precision.h"
#include "lamina/mesh/mesh_edges.h"

namespace lamina {
namespace {

struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  void add(const Vec3& p) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  [[nodiscard]] bool holds(const Box& other) const {
    for (int a = 0; a < 3; ++a)
      if (other.low[a] < low[a] || other.high[a] > high[a]) return false;
    return true;
  }
};

/// Faces that are joined by edges of two faces.
struct Surface {
  std::vector<std::uint32_t> faces;
  bool is_closed = true;
  double volume = 0.0;  // signed, for the winding that the faces have now
  Box box;
};

class Orienter {
 public:
  explicit Orienter(PolygonMesh mesh) {
    result_.mesh = std::move(mesh);
    std::vector<std::uint32_t> vertices;
    vertices.reserve(result_.mesh.corners.size());
    for (const MeshCorner& corner : result_.mesh.corners) vertices.push_back(corner.position);
    edges_ = make_mesh_edges(result_.mesh.face_begin, vertices, result_.mesh.positions.size());
    face_of_corner_.resize(vertices.size());
    for (std::uint32_t f = 0; f < face_count(result_.mesh); ++f)
      for (std::size_t c = begin(f); c < begin(f + 1); ++c) face_of_corner_[c] = f;
    is_turned_.resize(face_count(result_.mesh));
    contradicts_.resize(face_count(result_.mesh));
    for (std::uint32_t f = 0; f < face_count(result_.mesh); ++f)
      contradicts_[f] = normals_contradict(f);
  }

  OrientedMesh run() {
    std::vector<Surface> surfaces = wind_alike();
    turn_closed_surfaces(surfaces);
    for (const Surface& surface : surfaces)
      if (!surface.is_closed) follow_normals(surface);
    result_.turned_faces +=
        static_cast<std::size_t>(std::ranges::count(is_turned_, true)) - turned_with_surface_;
    result_.is_closed = std::ranges::all_of(surfaces, &Surface::is_closed);
    find_open_edges(surfaces);
    for (std::uint32_t f = 0; f < is_turned_.size(); ++f) {
      const bool is_turned = is_turned_[f], contradicts = contradicts_[f];
      if (contradicts != is_turned && has_normals(f)) turn_normals(f);
      if (is_turned)
        std::reverse(result_.mesh.corners.begin() + begin(f),
                     result_.mesh.corners.begin() + begin(f + 1));
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::uint32_t begin(std::uint32_t f) const { return result_.mesh.face_begin[f]; }

  [[nodiscard]] bool has_normals(std::uint32_t f) const {
    return std::ranges::all_of(face(result_.mesh, f),
                               [](const MeshCorner& c) { return c.normal != no_index; });
  }

  /// Whether the normals of a face, as the file has them, point to the back of its winding.
  [[nodiscard]] bool normals_contradict(std::uint32_t f) const {
    if (!has_normals(f)) return false;
    Vec3 sum;
    for (const MeshCorner& corner : face(result_.mesh, f))
      sum += to_double(result_.mesh.normals[corner.normal]);
    return dot(sum, doubled_area(result_.mesh, f)) < 0.0;
  }

  /// Whether two faces run along their common edge in the same direction.
  [[nodiscard]] bool disagree(const MeshEdge& edge) const {
    const auto starts_low = [&](std::uint32_t corner) {
      return result_.mesh.corners[corner].position == edge.vertex[0];
    };
    return starts_low(edge.corner[0]) == starts_low(edge.corner[1]);
  }

  /// Finds the surfaces and decides for each face whether it is turned to agree with most others.
  std::vector<Surface> wind_alike() {
    std::vector<Surface> surfaces;
    std::vector<bool> is_seen(is_turned_.size());
    for (std::uint32_t first = 0; first < is_turned_.size(); ++first) {
      if (is_seen[first]) continue;
      is_seen[first] = true;
      Surface surface{.faces = {first}};
      std::size_t turned = 0;
      for (std::size_t i = 0; i < surface.faces.size(); ++i) {  // grows on the way
        const std::uint32_t here = surface.faces[i];
        if (is_turned_[here]) ++turned;
        for (std::size_t c = begin(here); c < begin(here + 1); ++c) {
          const MeshEdge& edge = edges_.edges[edges_.edge_of_corner[c]];
          if (edge.face_count != 2) {
            surface.is_closed = false;
            continue;
          }
          const std::uint32_t one = face_of_corner_[edge.corner[0]];
          const std::uint32_t there = one == here ? face_of_corner_[edge.corner[1]] : one;
          if (is_seen[there]) continue;
          is_seen[there] = true;
          is_turned_[there] = is_turned_[here] != disagree(edge);
          surface.faces.push_back(there);
        }
      }
      if (2 * turned > surface.faces.size()) turn(surface);
      measure(surface);
      surfaces.push_back(std::move(surface));
    }
    return surfaces;
  }

  /// Where surfaces are open, by part.
  void find_open_edges(const std::vector<Surface>& surfaces) {
    const PolygonMesh& mesh = result_.mesh;
    std::vector<std::uint32_t> entry_of(mesh.parts.size(), no_index);  // [part], in result_.open
    for (const Surface& surface : surfaces) {
      if (surface.is_closed) continue;
      std::set<std::uint32_t> parts, opening;
      for (const std::uint32_t f : surface.faces) {
        parts.insert(mesh.part[f]);
        for (std::size_t c = begin(f); c < begin(f + 1); ++c) {
          const MeshEdge& edge = edges_.edges[edges_.edge_of_corner[c]];
          if (edge.face_count == 2 || edge.corner[0] != c) continue;  // each once
          std::uint32_t& entry = entry_of[mesh.part[f]];
          if (entry == no_index) {
            entry = static_cast<std::uint32_t>(result_.open.size());
            result_.open.push_back({.part = mesh.part[f],
                                    .place = 0.5F * (mesh.positions[edge.vertex[0]] +
                                                     mesh.positions[edge.vertex[1]])});
          }
          ++result_.open[entry].count;
          opening.insert(entry);
        }
      }
      for (const std::uint32_t entry : opening)
        result_.open[entry].opened.insert(result_.open[entry].opened.end(), parts.begin(),
                                          parts.end());
    }
  }

  void turn(const Surface& surface) {
    for (const std::uint32_t f : surface.faces) is_turned_[f] = !is_turned_[f];
  }

  void measure(Surface& surface) const {
    for (const std::uint32_t f : surface.faces)
      for (const MeshCorner& corner : face(result_.mesh, f))
        surface.box.add(to_double(result_.mesh.positions[corner.position]));
    const Vec3 center = 0.5 * (surface.box.low + surface.box.high);  // against cancellation
    for (const std::uint32_t f : surface.faces) {
      const Vec3 p = to_double(result_.mesh.positions[face(result_.mesh, f)[0].position]) - center;
      const double part = dot(p, doubled_area(result_.mesh, f)) / 6.0;
      surface.volume += is_turned_[f] ? -part : part;
    }
  }

  void turn_closed_surfaces(std::vector<Surface>& surfaces) {
    // The largest that are right side out, in which another one is a cavity.
    std::vector<const Surface*> outer;
    for (const Surface& surface : surfaces)
      if (surface.is_closed && surface.volume > 0.0) outer.push_back(&surface);
    std::ranges::sort(outer, {}, [](const Surface* s) { return -s->volume; });
    constexpr std::size_t most = 64;  // so that a crowd of small surfaces costs no square of them
    if (outer.size() > most) outer.resize(most);
    for (const Surface& surface : surfaces) {
      if (!surface.is_closed || !(surface.volume < 0.0)) continue;
      if (std::ranges::any_of(outer, [&](auto* o) { return o->box.holds(surface.box); })) continue;
      count_turned_with(surface);
      turn(surface);
      ++result_.inside_out;
    }
  }

  void follow_normals(const Surface& surface) {
    std::size_t for_it = 0, against = 0;
    for (const std::uint32_t f : surface.faces) {
      if (!has_normals(f)) continue;
      (contradicts_[f] != is_turned_[f] ? against : for_it) += 1;
    }
    if (against > for_it) turn(surface);
  }

  /// Faces that only go with their whole surface are counted as that surface.
  void count_turned_with(const Surface& surface) {
    for (const std::uint32_t f : surface.faces)
      if (is_turned_[f])
        ++result_.turned_faces;  // wound otherwise than the rest
      else
        ++turned_with_surface_;
  }

  void turn_normals(std::uint32_t f) {
    ++result_.turned_normals;
    PolygonMesh& mesh = result_.mesh;
    for (std::size_t c = begin(f); c < begin(f + 1); ++c) {
      const Vec3f turned = -mesh.normals[mesh.corners[c].normal];
      mesh.corners[c].normal = static_cast<std::uint32_t>(mesh.normals.size());
      mesh.normals.push_back(turned);
    }
  }

  OrientedMesh result_;
  MeshEdges edges_;
  std::vector<std::uint32_t> face_of_corner_;
  std::vector<bool> is_turned_;    // [face], against the winding of the file
  std::vector<bool> contradicts_;  // [face], its normals against the winding of the file
  std::size_t turned_with_surface_ = 0;
};

}  // namespace

OrientedMesh orient_mesh(PolygonMesh mesh) { return Orienter(std::move(mesh)).run(); }

}  // namespace lamina
