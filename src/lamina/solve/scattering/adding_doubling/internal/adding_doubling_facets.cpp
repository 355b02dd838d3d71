// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_facets.h"

#include <algorithm>
#include <cmath>

#include "lamina/layers/optics/rough/facet_lattice.h"

namespace lamina::detail {
namespace {

constexpr double negligible_lambda = 1e-14;

/// Shares light of any direction out among the regular nodes of its segment: the nodes' Lagrange
/// polynomials in the cosine of the segment, which add up to 1.
class NodeShares {
 public:
  explicit NodeShares(const DirectionGrid& grid) {
    std::size_t number = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (segments_.empty() || grid.segment_ior[i] != segments_.back().ior)
        segments_.push_back({.ior = grid.segment_ior[i], .first = number});
      if (grid.etendue[i] <= extra_node_etendue) continue;
      segments_.back().cos.push_back(grid.segment_cos[i]);
      segments_.back().barycentric.push_back(grid.etendue[i] / grid.segment_cos[i]);
      ++number;
    }
    double below = 0.0;
    for (Segment& segment : segments_) {
      const double ratio = below / segment.ior;
      const double widest = std::sqrt((1.0 - ratio) * (1.0 + ratio));
      double sign = 1.0;
      for (std::size_t i = 0; i < segment.cos.size(); ++i) {  // [BerrutTrefethen2004] for Gauss
        const double x = 2.0 * segment.cos[i] / widest - 1.0, weight = segment.barycentric[i];
        segment.barycentric[i] = sign * std::sqrt((1.0 - x) * (1.0 + x) * weight);
        sign = -sign;
      }
      below = segment.ior;
    }
  }

  /// Calls visit(regular node, share) for light of cosine `mu` in a medium of index `ior`.
  template <class Visit>
  void share(double ior, double mu, const Visit& visit) const {
    const double p = ior * std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
    std::size_t s = 0;
    while (s + 1 < segments_.size() && segments_[s].ior < p && segments_[s + 1].ior <= ior) ++s;
    const Segment& segment = segments_[s];
    const double own = segment.ior;
    const double x = own == ior ? mu : std::sqrt(std::max(0.0, (1.0 - p / own) * (1.0 + p / own)));
    double sum = 0.0;
    for (std::size_t i = 0; i < segment.cos.size(); ++i) {
      const double distance = x - segment.cos[i];
      if (distance == 0.0) return visit(segment.first + i, 1.0);
      sum += segment.barycentric[i] / distance;
    }
    const double scale = 1.0 / sum;
    for (std::size_t i = 0; i < segment.cos.size(); ++i)
      visit(segment.first + i, scale * segment.barycentric[i] / (x - segment.cos[i]));
  }

 private:
  struct Segment {
    double ior;
    std::size_t first;  ///< number of its first regular node
    std::vector<double> cos = {}, barycentric = {};
  };
  std::vector<Segment> segments_;
};

/// What leaves a facet towards each direction, [direction][mode].
struct Sent {
  std::vector<double> here, beyond;
};

/// Light from `view` meets a facet.
Sent send_on(const NodeShares& shares, const FacetSide& here, const FacetSide& beyond,
             const Vec3& view, int first, std::size_t count) {
  Sent sent{std::vector<double>(2 * here.regular.size() * count),
            std::vector<double>(2 * beyond.regular.size() * count)};
  std::vector<double> turned(count);  // light * cos(m phi), phi from the azimuth of travel
  const auto send = [&](const Vec3& to, const FacetSide& side, double light,
                        std::vector<double>& by) {
    const double across = std::hypot(to.x, to.y);
    const double cos_phi = across > 0.0 ? std::clamp(-to.x / across, -1.0, 1.0) : 1.0;
    if (first == 0 && count == 1) {
      turned[0] = light;
    } else {
      const double phi = std::acos(cos_phi);
      double before = light * std::cos((first - 1) * phi), now = light * std::cos(first * phi);
      for (double& amount : turned) {
        amount = now;
        now = 2.0 * cos_phi * amount - before;
        before = amount;
      }
      // Odd modes are the sine of the angle times what is smooth in its cosine.
      for (std::size_t m = first % 2 == 0 ? 1 : 0; m < count; m += 2)
        turned[m] *= side.ior * across;
    }
    double* const rows = &by[to.z > 0.0 ? 0 : side.regular.size() * count];
    shares.share(side.ior, std::min(std::abs(to.z), 1.0), [&](std::size_t node, double share) {
      double* const row = rows + node * count;
      for (std::size_t m = 0; m < count; ++m) row[m] += share * turned[m];
    });
  };
  for_each_visible_facet(here.interface.facets, view, [&](const Vec3& h, double weight) {
    const double f = fresnel(std::clamp(dot(view, h), 0.0, 1.0), here.interface.eta);
    send(reflect(view, h), here, weight * f, sent.here);
    if (f == 1.0) return;
    if (const auto on = refract(view, h, here.interface.eta))
      send({on->x, on->y, -on->z}, beyond, weight * (1.0 - f), sent.beyond);
  });
  return sent;
}

}  // namespace

FacetSide make_facet_side(const DirectionGrid& grid, const Interface& boundary, double ior,
                          double ior_beyond) {
  FacetSide side{.ior = ior, .interface = make_rough_interface<double>(boundary, ior, ior_beyond)};
  for (std::size_t i = 0; i < active_count(grid, ior); ++i) {
    (grid.etendue[i] > extra_node_etendue ? side.regular : side.extra).push_back(i);
    const double mu = cosine(grid, i, ior);
    side.cos.push_back(mu);
    side.lambda.push_back(
        smith_lambda(side.interface.facets, Vec3{std::sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu}));
  }
  return side;
}

std::vector<FacetOperators> facet_operators(const DirectionGrid& grid, const FacetSide& here,
                                            const FacetSide& beyond, int first, int count) {
  const NodeShares shares(grid);
  const std::size_t n = here.regular.size(), n_beyond = beyond.regular.size();
  const std::size_t nodes = here.cos.size();
  const auto& regular = n > n_beyond ? here.regular : beyond.regular;  // one begins with the other
  std::vector<FacetOperators> modes(static_cast<std::size_t>(count));
  for (FacetOperators& mode : modes)
    mode = {Matrix(2 * n, 2 * n), Matrix(2 * n_beyond, 2 * n), Matrix(2 * n, nodes),
            Matrix(2 * n_beyond, nodes)};
  const auto sent_from = [&](std::size_t node, bool is_rising) {
    const double mu = here.cos[node], sine = std::sqrt((1.0 - mu) * (1.0 + mu));
    return send_on(shares, here, beyond, {sine, 0.0, is_rising ? -mu : mu}, first, modes.size());
  };
  const auto put = [&](const std::vector<double>& sent, std::size_t mode, double* column) {
    const bool is_odd = (first + static_cast<int>(mode)) % 2 != 0;
    const std::size_t directions = sent.size() / modes.size();
    for (std::size_t d = 0; d < directions; ++d) {
      const std::size_t node = regular[d % (directions / 2)];
      column[d] = sent[d * modes.size() + mode] / (is_odd ? grid.p[node] : 1.0);
    }
  };
  for (std::size_t node = 0; node < nodes; ++node) {
    const Sent sent = sent_from(node, false);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      // Light along the normal has no azimuth, so it is in mode 0 alone.
      if (first + static_cast<int>(m) > 0 && here.cos[node] == 1.0) continue;
      put(sent.here, m, &modes[m].arriving_reflection(0, node));
      put(sent.beyond, m, &modes[m].arriving_transmission(0, node));
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    if (here.lambda[here.regular[k]] < negligible_lambda) continue;  // rises and meets nothing
    const Sent sent = sent_from(here.regular[k], true);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      put(sent.here, m, &modes[m].reflection(0, k));
      put(sent.beyond, m, &modes[m].transmission(0, k));
    }
  }
  for (FacetOperators& mode : modes)
    for (std::size_t k = 0; k < n; ++k) {
      std::copy_n(&mode.arriving_reflection(0, here.regular[k]), 2 * n, &mode.reflection(0, n + k));
      std::copy_n(&mode.arriving_transmission(0, here.regular[k]), 2 * n_beyond,
                  &mode.transmission(0, n + k));
    }
  return modes;
}

}  // namespace lamina::detail
