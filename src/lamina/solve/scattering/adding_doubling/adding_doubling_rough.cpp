// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_rough.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_facets.h"
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_heights.h"

namespace lamina::detail {
namespace {

constexpr int most_facets = 1000;
constexpr double negligible = 1e-14;        ///< in mode 0, whose energy is kept to rounding
constexpr double negligible_turned = 1e-9;  ///< in the others

/// One side of the boundary with what the heights of its light need.
struct Side {
  FacetSide facets;
  Matrix leaving;  ///< [node][height] fraction of rising light that leaves
  Matrix next;     ///< [direction][height from * heights + height] share
};

Side make_side(const DirectionGrid& grid, const Interface& boundary, double ior,
               double ior_beyond) {
  Side side{.facets = make_facet_side(grid, boundary, ior, ior_beyond)};
  const std::vector<double>& lambda = side.facets.lambda;
  const std::vector<std::size_t>& regular = side.facets.regular;
  side.leaving = Matrix(lambda.size(), heights);
  side.next = Matrix(2 * regular.size(), heights * heights);
  for (std::size_t l = 0; l < heights; ++l) {
    const double u = facet_heights()[l];
    for (std::size_t node = 0; node < lambda.size(); ++node)
      side.leaving(node, l) = std::pow(u, lambda[node]);
    for (std::size_t d = 0; d < side.next.rows; ++d) {
      const auto shares = next_heights(u, lambda[regular[d % regular.size()]], d < regular.size());
      for (std::size_t k = 0; k < heights; ++k) side.next(d, l * heights + k) = shares[k];
    }
  }
  return side;
}

/// Light between facets, on each side: [direction][source * heights + height]. Sources are the
/// regular nodes above, then below, then the extra ones above and below.
using Light = std::array<Matrix, 2>;

/// Takes the light to its next facets; what leaves on the way is added to out[side](node, source).
void advance(const std::array<Side, 2>& sides, Light& light, Light& out) {
  for (std::size_t s = 0; s < 2; ++s) {
    const Side& side = sides[s];
    const std::vector<std::size_t>& regular = side.facets.regular;
    const std::size_t directions = 2 * regular.size();
    std::vector<double> arriving(directions * heights);
    for (std::size_t source = 0; source < out[s].columns; ++source) {
      double* const moving = &light[s](0, source * heights);
      std::ranges::fill(arriving, 0.0);
      for (std::size_t l = 0; l < heights; ++l) {
        const double* const from = moving + l * directions;
        for (std::size_t d = 0; d < regular.size(); ++d)
          out[s](d, source) += from[d] * side.leaving(regular[d], l);
        for (std::size_t k = 0; k < heights; ++k) {
          const double* const share = &side.next.values[(l * heights + k) * directions];
          double* const to = &arriving[k * directions];
          for (std::size_t d = 0; d < directions; ++d) to[d] += from[d] * share[d];
        }
      }
      std::ranges::copy(arriving, moving);
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

Light scattered(const std::array<FacetOperators, 2>& facets, const Light& light) {
  Light next{product(facets[0].reflection, light[0]), product(facets[1].reflection, light[1])};
  add(next[0], product(facets[1].transmission, seen_from_beyond(light[1])));
  add(next[1], product(facets[0].transmission, seen_from_beyond(light[0])));
  return next;
}

double largest(const Light& light) {
  double value = 0.0;
  for (const Matrix& side : light)
    for (const double amount : side.values) value = std::max(value, std::abs(amount));
  return value;
}

/// Where the sources stand in the order of Light.
struct Sources {
  std::array<std::vector<std::size_t>, 2> of_node;  ///< [side][node]
  std::size_t count = 0, first_extra = 0;
};

Sources number_sources(const std::array<Side, 2>& sides) {
  Sources sources;
  for (std::size_t s = 0; s < 2; ++s) sources.of_node[s].resize(sides[s].facets.cos.size());
  for (const auto nodes : {&FacetSide::regular, &FacetSide::extra}) {
    sources.first_extra = sources.count;
    for (std::size_t s = 0; s < 2; ++s)
      for (const std::size_t node : sides[s].facets.*nodes)
        sources.of_node[s][node] = sources.count++;
  }
  return sources;
}

/// Light from outside that has met its first facet.
Light first_met(const std::array<Side, 2>& sides, const std::array<FacetOperators, 2>& facets,
                const Sources& sources) {
  Light light;
  for (std::size_t s = 0; s < 2; ++s)
    light[s] = Matrix(2 * sides[s].facets.regular.size(), sources.count * heights);
  for (std::size_t s = 0; s < 2; ++s) {
    const auto put = [](const Matrix& from, std::size_t node, double share, Matrix& to,
                        std::size_t column) {
      for (std::size_t d = 0; d < from.rows; ++d) to(d, column) = share * from(d, node);
    };
    for (std::size_t node = 0; node < sides[s].facets.cos.size(); ++node) {
      const auto met = next_heights(1.0, sides[s].facets.lambda[node], false);
      const std::size_t column = sources.of_node[s][node] * heights;
      for (std::size_t l = 0; l < heights; ++l) {
        put(facets[s].arriving_reflection, node, met[l], light[s], column + l);
        put(facets[s].arriving_transmission, node, met[l], light[1 - s],
            column + heights - 1 - l);  // height u on one side is 1 - u on the other
      }
    }
  }
  return light;
}

/// Flux that one facet sends towards the extra nodes of side `to`, over the node's etendue, per
/// flux from each direction of the side that it comes from: [extra node][direction]. By detailed
/// balance: the way back is known, and both ways weigh with etendue and with the facets seen.
Matrix towards_extra(const DirectionGrid& grid, const Side& from, const Side& to,
                     const Matrix& way_back) {
  const std::size_t n = from.facets.regular.size();
  Matrix towards(to.facets.extra.size(), 2 * n);
  for (std::size_t d = 0; d < 2 * n; ++d) {
    const bool is_rising = d < n;
    const std::size_t node = from.facets.regular[d % n];
    const double seen = from.facets.lambda[node] + (is_rising ? 0.0 : 1.0);
    if (seen < negligible) continue;
    const std::size_t back = is_rising ? d + n : d - n;
    for (std::size_t k = 0; k < to.facets.extra.size(); ++k) {
      const std::size_t extra = to.facets.extra[k];
      towards(k, d) =
          (1.0 + to.facets.lambda[extra]) * way_back(back, extra) / (grid.etendue[node] * seen);
    }
  }
  return towards;
}

/// Flux leaving by each node, per unit flux arriving: [regular node][source]. Between extra nodes
/// it is over the node's etendue, and of light that meets two facets or more: [extra][extra].
struct Leaving {
  Light regular, extra;
};

Leaving follow(const DirectionGrid& grid, const std::array<Side, 2>& sides,
               const std::array<FacetOperators, 2>& facets, const Sources& sources, double enough) {
  Leaving leaving;
  std::array<std::array<Matrix, 2>, 2> towards;  // [to][from]
  const std::size_t extras = sources.count - sources.first_extra;
  for (std::size_t s = 0; s < 2; ++s) {
    leaving.regular[s] = Matrix(sides[s].facets.regular.size(), sources.count);
    leaving.extra[s] = Matrix(sides[s].facets.extra.size(), extras);
    towards[s][s] = towards_extra(grid, sides[s], sides[s], facets[s].arriving_reflection);
    towards[s][1 - s] =
        towards_extra(grid, sides[1 - s], sides[s], facets[s].arriving_transmission);
  }
  const auto add_towards_extra = [&](const Light& light) {
    for (std::size_t from = 0; from < 2; ++from) {
      const std::size_t rows = light[from].rows, begin = sources.first_extra * heights * rows;
      Matrix of_extra(rows, extras * heights);
      std::copy_n(&light[from].values[begin], of_extra.values.size(), of_extra.values.data());
      for (std::size_t to = 0; to < 2; ++to) {
        const Matrix sent = product(towards[to][from], of_extra);
        for (std::size_t column = 0; column < sent.columns; ++column) {
          const std::size_t l = column % heights, height = to == from ? l : heights - 1 - l;
          for (std::size_t k = 0; k < sent.rows; ++k)
            leaving.extra[to](k, column / heights) +=
                sent(k, column) * sides[to].leaving(sides[to].facets.extra[k], height);
        }
      }
    }
  };
  Light light = first_met(sides, facets, sources);
  for (int met = 1; met < most_facets; ++met) {
    advance(sides, light, leaving.regular);
    if (largest(light) <= enough) break;
    if (extras > 0) add_towards_extra(light);
    light = scattered(facets, light);
  }
  return leaving;
}

/// Flux fractions to states of flux over root etendue. From regular to extra nodes reciprocity
/// serves: the way back from them is known.
RoughBoundary to_states(const DirectionGrid& grid, const std::array<Side, 2>& sides,
                        const Sources& sources, const Leaving& leaving) {
  std::array<std::vector<std::size_t>, 2> number;  // [side][node] among the regular or extra ones
  for (std::size_t s = 0; s < 2; ++s) {
    number[s].resize(sides[s].facets.cos.size());
    for (const auto* nodes : {&sides[s].facets.regular, &sides[s].facets.extra})
      for (std::size_t k = 0; k < nodes->size(); ++k) number[s][(*nodes)[k]] = k;
  }
  const auto is_extra = [&](std::size_t i) { return grid.etendue[i] <= extra_node_etendue; };
  const auto states = [&](std::size_t to, std::size_t from) {
    Matrix made(number[to].size(), number[from].size());
    const auto root = [&](std::size_t a, std::size_t b) {
      return std::sqrt(grid.etendue[a] / grid.etendue[b]);
    };
    for (std::size_t j = 0; j < made.columns; ++j)
      for (std::size_t i = 0; i < made.rows; ++i) {
        const std::size_t source = sources.of_node[from][j], back = sources.of_node[to][i];
        made(i, j) = !is_extra(i) ? leaving.regular[to](number[to][i], source) * root(j, i)
                     : !is_extra(j)
                         ? leaving.regular[from](number[from][j], back) * root(i, j)
                         : leaving.extra[to](number[to][i], source - sources.first_extra) *
                               std::sqrt(grid.etendue[i] * grid.etendue[j]);
      }
    return made;
  };
  return {states(0, 0), states(1, 0), states(1, 1), states(0, 1)};
}

}  // namespace

bool is_rough(const Interface& boundary, double ior_above, double ior_below) {
  return !is_specular(make_rough_interface<double>(boundary, ior_above, ior_below));
}

std::vector<RoughBoundary> rough_boundary_modes(const DirectionGrid& grid,
                                                const Interface& boundary, double ior_above,
                                                double ior_below, int first, int count,
                                                const Progress& progress) {
  assert(is_rough(boundary, ior_above, ior_below));
  const std::array<Side, 2> sides{make_side(grid, boundary, ior_above, ior_below),
                                  make_side(grid, boundary, ior_below, ior_above)};
  std::array<std::vector<FacetOperators>, 2> facets;
  const auto make_facets = [&](std::size_t s) {
    facets[s] = facet_operators(grid, sides[s].facets, sides[1 - s].facets, first, count);
  };
  parallel_for(2, make_facets, progress);
  const Sources sources = number_sources(sides);
  std::vector<RoughBoundary> modes(static_cast<std::size_t>(count));
  const auto make_mode = [&](std::size_t m) {
    const double enough = first == 0 && m == 0 ? negligible : negligible_turned;
    modes[m] = to_states(grid, sides, sources,
                         follow(grid, sides, {facets[0][m], facets[1][m]}, sources, enough));
  };
  parallel_for(modes.size(), make_mode, progress);
  return modes;
}

}  // namespace lamina::detail
