// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_orientation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh_edges.h"

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

/// Faces that edges join.
struct Surface {
  std::vector<std::uint32_t> faces;
  bool is_closed = true;
  double volume = 0.0;  // signed, for the winding that the faces have now; an open one with a cone
                        // from each open edge to the middle of all
  double area = 0.0, open_area = 0.0;  // of the faces, of that cone
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
      if (!surface.is_closed) turn_open_surface(surface);
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

  /// 1 if the face of a corner runs from there along its edge upward in the order of vertices, as
  /// it is wound now, -1 if downward.
  [[nodiscard]] int direction(std::uint32_t corner) const {
    const bool starts_low = result_.mesh.corners[corner].position ==
                            edges_.edges[edges_.edge_of_corner[corner]].vertex[0];
    return starts_low != is_turned_[face_of_corner_[corner]] ? 1 : -1;
  }

  /// Finds what edges of two faces join, and decides for each face whether it is turned to agree
  /// with most others there.
  std::vector<std::vector<std::uint32_t>> wind_pieces() {
    std::vector<std::vector<std::uint32_t>> pieces;
    piece_of_.assign(is_turned_.size(), no_index);
    for (std::uint32_t first = 0; first < is_turned_.size(); ++first) {
      if (piece_of_[first] != no_index) continue;
      const auto here = static_cast<std::uint32_t>(pieces.size());
      std::vector<std::uint32_t> faces = {first};
      piece_of_[first] = here;
      for (std::size_t i = 0; i < faces.size(); ++i)  // grows on the way
        for (std::size_t c = begin(faces[i]); c < begin(faces[i] + 1); ++c) {
          const MeshEdge& edge = edges_.edges[edges_.edge_of_corner[c]];
          if (edge.face_count != 2) continue;
          const std::uint32_t other = edge.corner[0] == c ? edge.corner[1] : edge.corner[0];
          const std::uint32_t there = face_of_corner_[other];
          if (piece_of_[there] != no_index) continue;
          piece_of_[there] = here;
          if (direction(other) == direction(static_cast<std::uint32_t>(c)))
            is_turned_[there] = !is_turned_[there];
          faces.push_back(there);
        }
      turn_if_most_are(faces);
      pieces.push_back(std::move(faces));
    }
    return pieces;
  }

  void turn_if_most_are(const std::vector<std::uint32_t>& faces) {
    const auto turned = std::ranges::count_if(faces, [&](auto f) { return is_turned_[f]; });
    if (2 * static_cast<std::size_t>(turned) > faces.size()) turn(faces);
  }

  /// How often the faces of a piece run along an edge upward, less how often downward.
  struct Imbalance {
    std::uint32_t edge, piece;
    int sum;
  };

  /// Of edges of more than two faces, as far as it is not 0; in the order of edges.
  [[nodiscard]] std::vector<Imbalance> imbalances() const {
    std::vector<Imbalance> all;
    for (std::uint32_t c = 0; c < edges_.edge_of_corner.size(); ++c)
      if (const std::uint32_t e = edges_.edge_of_corner[c]; edges_.edges[e].face_count > 2)
        all.push_back({e, piece_of_[face_of_corner_[c]], direction(c)});
    std::ranges::sort(all, {}, [](const Imbalance& i) { return std::pair(i.edge, i.piece); });
    std::vector<Imbalance> summed;
    for (const Imbalance& one : all)
      if (!summed.empty() && summed.back().edge == one.edge && summed.back().piece == one.piece)
        summed.back().sum += one.sum;
      else
        summed.push_back(one);
    std::erase_if(summed, [](const Imbalance& i) { return i.sum == 0; });
    return summed;
  }

  /// Joins pieces that are not balanced by themselves along edges of more than two faces; where two
  /// of them meet, they are wound so that together they are.
  std::vector<Surface> join_pieces(std::vector<std::vector<std::uint32_t>> pieces) {
    const std::vector<Imbalance> unbalanced = imbalances();
    std::vector<std::vector<std::size_t>> of_piece(pieces.size());  // indices into `unbalanced`
    for (std::size_t i = 0; i < unbalanced.size(); ++i) of_piece[unbalanced[i].piece].push_back(i);
    std::vector<Surface> surfaces;
    std::vector<bool> is_seen(pieces.size()), is_turned(pieces.size());
    for (std::uint32_t first = 0; first < pieces.size(); ++first) {
      if (is_seen[first]) continue;
      is_seen[first] = true;
      std::vector<std::uint32_t> joined = {first};
      Surface surface;
      for (std::size_t j = 0; j < joined.size(); ++j) {  // grows on the way
        const std::uint32_t here = joined[j];
        for (const std::size_t i : of_piece[here]) {
          std::size_t start = i, end = i + 1;
          while (start > 0 && unbalanced[start - 1].edge == unbalanced[i].edge) --start;
          while (end < unbalanced.size() && unbalanced[end].edge == unbalanced[i].edge) ++end;
          for (std::size_t other = start; other < end; ++other) {
            const std::uint32_t there = unbalanced[other].piece;
            if (is_seen[there]) continue;
            is_seen[there] = true;
            if (end - start == 2)
              is_turned[there] = is_turned[here] != (unbalanced[i].sum * unbalanced[other].sum > 0);
            joined.push_back(there);
          }
        }
      }
      for (const std::uint32_t piece : joined) {
        if (is_turned[piece]) turn(pieces[piece]);
        surface.faces.insert(surface.faces.end(), pieces[piece].begin(), pieces[piece].end());
      }
      if (joined.size() > 1) turn_if_most_are(surface.faces);
      surfaces.push_back(std::move(surface));
    }
    return surfaces;
  }

  /// Finds the surfaces, and decides for each face whether it is turned to agree with most others.
  std::vector<Surface> wind_alike() {
    std::vector<Surface> surfaces = join_pieces(wind_pieces());
    std::vector<int> sum(edges_.edges.size());
    for (std::uint32_t c = 0; c < edges_.edge_of_corner.size(); ++c)
      sum[edges_.edge_of_corner[c]] += direction(c);
    is_open_.resize(sum.size());
    for (std::size_t e = 0; e < sum.size(); ++e) is_open_[e] = sum[e] != 0;
    // A piece that is balanced by itself touches an open edge and is not opened by it.
    std::set<std::pair<std::uint32_t, std::uint32_t>> opened;  // edges of many faces and pieces
    for (const Imbalance& one : imbalances()) opened.emplace(one.edge, one.piece);
    opens_.resize(edges_.edge_of_corner.size());
    for (std::uint32_t c = 0; c < opens_.size(); ++c) {
      const std::uint32_t e = edges_.edge_of_corner[c];
      opens_[c] = is_open_[e] && (edges_.edges[e].face_count <= 2 ||
                                  opened.contains({e, piece_of_[face_of_corner_[c]]}));
    }
    for (Surface& surface : surfaces) measure(surface);
    return surfaces;
  }

  /// Where surfaces are open, by part.
  void find_open_edges(const std::vector<Surface>& surfaces) {
    const PolygonMesh& mesh = result_.mesh;
    std::vector<std::uint32_t> entry_of(mesh.parts.size(), no_index);  // [part], in result_.open
    std::vector<bool> is_counted(edges_.edges.size());
    for (const Surface& surface : surfaces) {
      if (surface.is_closed) continue;
      std::set<std::uint32_t> parts, opening;
      for (const std::uint32_t f : surface.faces) {
        parts.insert(mesh.part[f]);
        for (std::size_t c = begin(f); c < begin(f + 1); ++c) {
          const std::uint32_t e = edges_.edge_of_corner[c];
          if (!opens_[c] || is_counted[e]) continue;
          is_counted[e] = true;
          const MeshEdge& edge = edges_.edges[e];
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

  void turn(const std::vector<std::uint32_t>& faces) {
    for (const std::uint32_t f : faces) is_turned_[f] = !is_turned_[f];
  }

  void measure(Surface& surface) const {
    const auto position = [&](std::uint32_t index) {
      return to_double(result_.mesh.positions[index]);
    };
    Vec3 sum_of_open;
    double open = 0.0;
    for (const std::uint32_t f : surface.faces)
      for (std::uint32_t c = begin(f); c < begin(f + 1); ++c) {
        surface.box.add(position(result_.mesh.corners[c].position));
        if (!opens_[c]) continue;
        surface.is_closed = false;
        sum_of_open += position(result_.mesh.corners[c].position);
        open += 1.0;
      }
    const Vec3 middle = open > 0.0 ? sum_of_open / open
                                   : 0.5 * (surface.box.low + surface.box.high);  // not to cancel
    for (const std::uint32_t f : surface.faces) {
      const Vec3 doubled = doubled_area(result_.mesh, f);
      const double part = dot(position(face(result_.mesh, f)[0].position) - middle, doubled) / 6.0;
      surface.volume += is_turned_[f] ? -part : part;
      surface.area += 0.5 * length(doubled);
      for (std::uint32_t c = begin(f); c < begin(f + 1); ++c)
        if (opens_[c]) {
          const MeshEdge& edge = edges_.edges[edges_.edge_of_corner[c]];
          surface.open_area += 0.5 * length(cross(position(edge.vertex[0]) - middle,
                                                  position(edge.vertex[1]) - middle));
        }
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
      turn(surface.faces);
      ++result_.inside_out;
    }
  }

  /// By its normals; without any, by the volume that it nearly encloses.
  void turn_open_surface(const Surface& surface) {
    constexpr double little = 0.2;  // of its area; a bowl, open by half of it, has no outside
    std::size_t for_it = 0, against = 0;
    for (const std::uint32_t f : surface.faces) {
      if (!has_normals(f)) continue;
      (contradicts_[f] != is_turned_[f] ? against : for_it) += 1;
    }
    if (against > for_it) turn(surface.faces);
    if (against + for_it > 0 || !(surface.volume < 0.0) ||
        surface.open_area > little * surface.area)
      return;
    count_turned_with(surface);
    turn(surface.faces);
    ++result_.open_inside_out;
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
  std::vector<std::uint32_t> piece_of_;  // [face], what edges of two faces join
  std::vector<bool> is_open_;            // [edge], faces run along it more often one way
  std::vector<bool> opens_;              // [corner], its edge is open, and the surface there
  std::vector<bool> is_turned_;          // [face], against the winding of the file
  std::vector<bool> contradicts_;        // [face], its normals against the winding of the file
  std::size_t turned_with_surface_ = 0;
};

}  // namespace

OrientedMesh orient_mesh(PolygonMesh mesh) { return Orienter(std::move(mesh)).run(); }

}  // namespace lamina
