// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling_rough.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "lamina/core/quadrature.h"
#include "lamina/optics/facet_lattice.h"
#include "lamina/optics/rough_interface.h"

namespace lamina::detail {
namespace {

constexpr std::size_t heights = 10;
constexpr int most_facets = 1000;
constexpr double negligible = 1e-14;

/// Shares light of any direction out among the nodes of its segment: the node's Lagrange
/// polynomials in the cosine of the segment, which add up to 1.
class NodeShares {
 public:
  explicit NodeShares(const DirectionGrid& grid) : grid_(grid), barycentric_(grid.size()) {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (segments_.empty() || grid.segment_ior[i] != segments_.back().ior)
        segments_.push_back({.ior = grid.segment_ior[i]});
      if (grid.etendue[i] > extra_node_etendue) segments_.back().nodes.push_back(i);
    }
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      const double below = s > 0 ? segments_[s - 1].ior / segments_[s].ior : 0.0;
      const double widest = std::sqrt((1.0 - below) * (1.0 + below));
      double sign = 1.0;
      for (const std::size_t i : segments_[s].nodes) {  // [BerrutTrefethen2004] for Gauss-Legendre
        const double x = 2.0 * grid.segment_cos[i] / widest - 1.0;
        const double weight = grid.etendue[i] / grid.segment_cos[i];
        barycentric_[i] = sign * std::sqrt((1.0 - x) * (1.0 + x) * weight);
        sign = -sign;
      }
    }
  }

  /// Adds `light` in a direction of cosine `mu` in a medium of index `ior` to row[node].
  void add(double ior, double mu, double light, double* row) const {
    const double p = ior * std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
    std::size_t s = 0;
    while (s + 1 < segments_.size() && segments_[s].ior < p && segments_[s + 1].ior <= ior) ++s;
    const double own = segments_[s].ior;
    const double x = own == ior ? mu : std::sqrt(std::max(0.0, (1.0 - p / own) * (1.0 + p / own)));
    double sum = 0.0;
    for (const std::size_t i : segments_[s].nodes) {
      const double distance = x - grid_.segment_cos[i];
      if (distance == 0.0) {
        row[i] += light;
        return;
      }
      sum += barycentric_[i] / distance;
    }
    const double scale = light / sum;
    for (const std::size_t i : segments_[s].nodes)
      row[i] += scale * barycentric_[i] / (x - grid_.segment_cos[i]);
  }

 private:
  struct Segment {
    double ior;
    std::vector<std::size_t> nodes = {};
  };
  const DirectionGrid& grid_;
  std::vector<double> barycentric_;
  std::vector<Segment> segments_;
};

/// Heights as Gauss nodes in u, and the Lagrange polynomials there by their coefficients.
struct Heights {
  std::array<double, heights> u;
  std::array<std::array<double, heights>, heights> coefficient;  ///< [height][power]
};

const Heights& height_nodes() {
  static const Heights made = [] {
    Heights h{};
    const Quadrature rule = gauss_legendre(static_cast<int>(heights), 0.0, 1.0);
    for (std::size_t l = 0; l < heights; ++l) h.u[l] = rule.nodes[l];
    for (std::size_t l = 0; l < heights; ++l) {
      auto& c = h.coefficient[l];
      c[0] = 1.0;
      for (std::size_t k = 0, degree = 0; k < heights; ++k) {
        if (k == l) continue;
        const double scale = 1.0 / (h.u[l] - h.u[k]);
        ++degree;
        for (std::size_t power = degree + 1; power-- > 0;)
          c[power] = scale * ((power > 0 ? c[power - 1] : 0.0) - h.u[k] * c[power]);
      }
    }
    return h;
  }();
  return made;
}

/// Shares of light from height u that meets its next facet at each height. Rising light is blocked
/// below u' with probability 1 - (u / u')^Lambda, falling light above it with 1 - (u' / u)^(1 +
/// Lambda). Source: [Heitz2016].
std::array<double, heights> next_heights(double u, double lambda, bool is_rising) {
  const double log_u = std::log(u);
  std::array<double, heights> moment;  // mean of u'^k over the light that meets one
  for (std::size_t k = 0; k < heights; ++k) {
    const auto power = static_cast<double>(k);
    if (!is_rising) {
      moment[k] = std::pow(u, power) * (1.0 + lambda) / (1.0 + lambda + power);
      continue;
    }
    // lambda (u^lambda - u^power) / (power - lambda), from the larger of the two powers
    const double y = std::abs((power - lambda) * log_u);
    moment[k] = -lambda * log_u * std::pow(u, std::min(lambda, power)) *
                (y == 0.0 ? 1.0 : -std::expm1(-y) / y);
  }
  std::array<double, heights> shares{};
  for (std::size_t l = 0; l < heights; ++l)
    for (std::size_t k = 0; k < heights; ++k)
      shares[l] += height_nodes().coefficient[l][k] * moment[k];
  return shares;
}

/// One side of the boundary. Its frame has +z towards its medium, as FacetWalk has it: light "up"
/// leaves. Directions of travel: the nodes up, then the nodes down.
struct Side {
  double ior = 1.0;
  std::size_t nodes = 0;
  RoughInterface<double> interface;  ///< as seen from here
  std::vector<double> cos, lambda;   ///< [node]
  Matrix reflection, transmission;   ///< [to direction here, beyond][from direction here]
  std::vector<double> leaving;       ///< [height][node] share of rising light that leaves
  std::vector<std::array<double, heights>> next;  ///< [direction][height from] shares by height
};

/// What the facets do to light of each direction: to which directions they send it, one facet met.
void add_facets(const NodeShares& shares, const DirectionGrid& grid, int m, double ior_beyond,
                std::size_t nodes_beyond, Side& side) {
  const std::size_t n = side.nodes;
  side.reflection = Matrix(2 * n, 2 * n);
  side.transmission = Matrix(2 * nodes_beyond, 2 * n);
  for (std::size_t d = 0; d < 2 * n; ++d) {
    const bool is_rising = d < n;
    const std::size_t node = is_rising ? d : d - n;
    const bool is_extra = grid.etendue[node] <= extra_node_etendue;
    // Light goes on from facet to facet in the directions of the regular nodes alone.
    if (is_rising && (is_extra || side.lambda[node] < negligible)) continue;
    const double mu = side.cos[node], sine = std::sqrt((1.0 - mu) * (1.0 + mu));
    if (m > 0 && sine == 0.0) continue;
    const Vec3 view{sine, 0.0, is_rising ? -mu : mu};  // from where it comes
    const auto send = [&](const Vec3& to, double ior, std::size_t count, double light, Matrix& by) {
      const double across = std::hypot(to.x, to.y);
      if (m > 0)
        light *=
            across > 0.0 ? std::cos(m * std::acos(std::clamp(-to.x / across, -1.0, 1.0))) : 0.0;
      double* column = &by(0, d);
      shares.add(ior, std::min(std::abs(to.z), 1.0), light, to.z > 0.0 ? column : column + count);
    };
    for_each_visible_facet(side.interface.facets, view, [&](const Vec3& h, double weight) {
      const double f = fresnel(std::clamp(dot(view, h), 0.0, 1.0), side.interface.eta);
      send(reflect(view, h), side.ior, n, weight * f, side.reflection);
      if (f == 1.0) return;
      if (const auto on = refract(view, h, side.interface.eta))
        send({on->x, on->y, -on->z}, ior_beyond, nodes_beyond, weight * (1.0 - f),
             side.transmission);
    });
  }
}

Side make_side(const NodeShares& shares, const DirectionGrid& grid, const Interface& boundary,
               double ior, double ior_beyond, int m) {
  Side side{.ior = ior,
            .nodes = active_count(grid, ior),
            .interface = make_rough_interface<double>(boundary, ior, ior_beyond)};
  for (std::size_t i = 0; i < side.nodes; ++i) {
    const double mu = cosine(grid, i, ior);
    side.cos.push_back(mu);
    side.lambda.push_back(
        smith_lambda(side.interface.facets, Vec3{std::sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu}));
  }
  for (const double u : height_nodes().u)
    for (const double lambda : side.lambda) side.leaving.push_back(std::pow(u, lambda));
  for (const bool is_rising : {true, false})
    for (const double lambda : side.lambda)
      for (const double u : height_nodes().u)
        side.next.push_back(next_heights(u, lambda, is_rising));
  add_facets(shares, grid, m, ior_beyond, active_count(grid, ior_beyond), side);
  return side;
}

/// Light between facets: [direction][source * heights + height], on each side.
using Light = std::array<Matrix, 2>;

/// Takes the light to its next facets; what leaves on the way is added to out[side](node, source).
void advance(const std::array<Side, 2>& sides, Light& light, Light& out) {
  for (std::size_t s = 0; s < 2; ++s) {
    const Side& side = sides[s];
    Matrix& moving = light[s];
    const std::size_t directions = 2 * side.nodes;
    for (std::size_t source = 0; source < out[s].columns; ++source)
      for (std::size_t d = 0; d < directions; ++d) {
        std::array<double, heights> arriving{};
        for (std::size_t l = 0; l < heights; ++l) {
          const double amount = moving(d, source * heights + l);
          if (amount == 0.0) continue;
          if (d < side.nodes) out[s](d, source) += amount * side.leaving[l * side.nodes + d];
          const auto& next = side.next[d * heights + l];
          for (std::size_t k = 0; k < heights; ++k) arriving[k] += amount * next[k];
        }
        for (std::size_t l = 0; l < heights; ++l) moving(d, source * heights + l) = arriving[l];
      }
  }
}

/// Height u on one side is 1 - u on the other.
Matrix seen_from_beyond(const Matrix& light) {
  Matrix turned(light.rows, light.columns);
  for (std::size_t column = 0; column < light.columns; ++column) {
    const std::size_t l = column % heights, other = column - l + heights - 1 - l;
    std::copy_n(&light.values[column * light.rows], light.rows, &turned.values[other * light.rows]);
  }
  return turned;
}

void add(Matrix& sum, const Matrix& more) {
  for (std::size_t k = 0; k < sum.values.size(); ++k) sum.values[k] += more.values[k];
}

Light scattered(const std::array<Side, 2>& sides, const Light& light) {
  Light next{product(sides[0].reflection, light[0]), product(sides[1].reflection, light[1])};
  add(next[0], product(sides[1].transmission, seen_from_beyond(light[1])));
  add(next[1], product(sides[0].transmission, seen_from_beyond(light[0])));
  return next;
}

double largest(const Light& light) {
  double value = 0.0;
  for (const Matrix& side : light)
    for (const double amount : side.values) value = std::max(value, std::abs(amount));
  return value;
}

/// Flux leaving by each node, per unit flux arriving: [node][source], sources above, then below.
Light follow(const std::array<Side, 2>& sides) {
  const std::size_t sources = sides[0].nodes + sides[1].nodes;
  Light light, out;
  for (std::size_t s = 0; s < 2; ++s) {
    const std::size_t first = s == 0 ? 0 : sides[0].nodes, n = sides[s].nodes;
    light[s] = Matrix(2 * n, sources * heights);
    out[s] = Matrix(n, sources);
    for (std::size_t i = 0; i < n; ++i) {
      const auto met = next_heights(1.0, sides[s].lambda[i], false);
      for (std::size_t l = 0; l < heights; ++l) light[s](n + i, (first + i) * heights + l) = met[l];
    }
  }
  for (int facets = 0; facets < most_facets && largest(light) > negligible; ++facets) {
    light = scattered(sides, light);
    advance(sides, light, out);
  }
  return out;
}

/// Flux fractions to states of flux over root etendue. Towards extra nodes reciprocity serves: the
/// way back from them, which is known.
void to_states(const DirectionGrid& grid, const Light& flux, std::size_t above,
               RoughBoundary& made) {
  const auto state = [&](const Matrix& from, std::size_t offset, std::size_t i, std::size_t j) {
    return from(i, offset + j) * std::sqrt(grid.etendue[j] / grid.etendue[i]);
  };
  const auto fill = [&](const Matrix& way, std::size_t offset, const Matrix& back,
                        std::size_t back_offset, std::size_t columns) {
    Matrix states(way.rows, columns);
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t i = 0; i < way.rows; ++i)
        states(i, j) = grid.etendue[i] > extra_node_etendue   ? state(way, offset, i, j)
                       : grid.etendue[j] > extra_node_etendue ? state(back, back_offset, j, i)
                                                              : 0.0;
    return states;
  };
  const std::size_t below = flux[1].rows;
  made.reflection_above = fill(flux[0], 0, flux[0], 0, above);
  made.transmission_down = fill(flux[1], 0, flux[0], above, above);
  made.reflection_below = fill(flux[1], above, flux[1], above, below);
  made.transmission_up = fill(flux[0], above, flux[1], 0, below);
}

}  // namespace

bool is_rough(const Interface& boundary, double ior_above, double ior_below) {
  return !is_specular(make_rough_interface<double>(boundary, ior_above, ior_below));
}

RoughBoundary rough_boundary(const DirectionGrid& grid, const Interface& boundary, double ior_above,
                             double ior_below, int m) {
  assert(is_rough(boundary, ior_above, ior_below));
  const NodeShares shares(grid);
  const std::array<Side, 2> sides{make_side(shares, grid, boundary, ior_above, ior_below, m),
                                  make_side(shares, grid, boundary, ior_below, ior_above, m)};
  RoughBoundary made;
  to_states(grid, follow(sides), sides[0].nodes, made);
  return made;
}

}  // namespace lamina::detail
