// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/internal/both_ends.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace lamina::detail {
namespace {

constexpr std::size_t entry_nodes = 16;  // Chebyshev points in [-1, 1]

double angle_of(std::size_t node) {
  return std::numbers::pi * (static_cast<double>(node) + 0.5) / entry_nodes;
}

using NodeValues = std::vector<double>;

double product(const NodeValues& a, const NodeValues& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// The eigenvectors of the largest eigenvalues of a symmetric matrix that has no negative ones, by
/// orthogonal iteration.
std::vector<NodeValues> largest_eigenvectors(const std::vector<NodeValues>& matrix,
                                             std::size_t count) {
  std::vector<NodeValues> vectors;
  for (std::size_t v = 0; v < count; ++v) {
    vectors.emplace_back(entry_nodes);
    for (std::size_t k = 0; k < entry_nodes; ++k)
      vectors[v][k] = std::cos(static_cast<double>(v) * angle_of(k));
  }
  constexpr int iterations = 60;
  for (int i = 0; i < iterations; ++i)
    for (std::size_t v = 0; v < count; ++v) {
      NodeValues next;
      for (const NodeValues& row : matrix) next.push_back(product(row, vectors[v]));
      for (std::size_t before = 0; before < v; ++before) {
        const double part = product(next, vectors[before]);
        for (std::size_t k = 0; k < entry_nodes; ++k) next[k] -= part * vectors[before][k];
      }
      const double length = std::sqrt(product(next, next));
      if (length == 0.0) return {vectors.begin(), vectors.begin() + static_cast<std::ptrdiff_t>(v)};
      for (double& value : next) value /= length;
      vectors[v] = std::move(next);
    }
  return vectors;
}

}  // namespace

BothEnds::BothEnds(WeightsOfOperators weights, std::size_t terms) : weights_(std::move(weights)) {
  std::vector<NodeValues> gram(entry_nodes, NodeValues(entry_nodes));
  for (std::size_t j = 0; j < entry_nodes; ++j) {
    std::vector<std::array<std::vector<double>, 4>> row;
    for (std::size_t k = 0; k < entry_nodes; ++k)
      row.push_back(weights_(0.5 * (std::cos(angle_of(j)) + std::cos(angle_of(k)))));
    for (std::size_t k = 0; k < entry_nodes; ++k)
      for (std::size_t l = 0; l < entry_nodes; ++l)
        for (std::size_t which = 0; which < 4; ++which)
          gram[k][l] += product(row[k][which], row[l][which]);
  }
  entry_ = largest_eigenvectors(gram, terms);
}

double BothEnds::entry(std::size_t term, double y) const {
  // Interpolation at Chebyshev points, barycentric.
  double above = 0.0, below = 0.0;
  for (std::size_t k = 0; k < entry_nodes; ++k) {
    const double distance = y - std::cos(angle_of(k));
    if (distance == 0.0) return entry_[term][k];
    const double share = (k % 2 == 0 ? 1.0 : -1.0) * std::sin(angle_of(k)) / distance;
    above += share * entry_[term][k];
    below += share;
  }
  return above / below;
}

std::vector<double> BothEnds::exit(std::size_t term, std::size_t which, double x) const {
  const auto projection = [&](std::size_t t) {
    std::vector<double> sum;
    for (std::size_t k = 0; k < entry_nodes; ++k) {
      const std::vector<double> at = weights_(0.5 * (x + std::cos(angle_of(k))))[which];
      sum.resize(at.size());
      for (std::size_t i = 0; i < at.size(); ++i) sum[i] += entry_[t][k] * at[i];
    }
    return sum;
  };
  if (term > 0) return projection(term);
  // The first: what the others leave of the profile where both ends are alike.
  std::vector<double> rest = weights_(x)[which];
  for (std::size_t t = 1; t < terms(); ++t) {
    const std::vector<double> part = projection(t);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= entry(t, x) * part[i];
  }
  for (double& weight : rest) weight /= entry(0, x);
  return rest;
}

}  // namespace lamina::detail
