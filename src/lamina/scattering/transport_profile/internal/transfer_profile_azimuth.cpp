// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/transport_profile/internal/transfer_profile_azimuth.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numbers>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <Eigen/Eigenvalues>
#pragma GCC diagnostic pop

namespace lamina::detail {
namespace {

/// Last coupling but one, last coupling, damping.
struct ChainEnd {
  double coupling_before, coupling, damping;
};

constexpr std::array<ChainEnd, 11> chain_ends = {{
    {0.0, 1.0, 1.0},  // M = 1
    {0.7071, 0.6162, 0.5965},
    {0.5163, 0.6396, 0.6528},
    {0.5185, 0.6807, 0.7867},
    {0.5194, 0.6953, 0.8325},
    {0.5200, 0.7063, 0.8671},
    {0.5204, 0.7146, 0.8934},
    {0.5207, 0.7224, 0.9182},
    {0.5209, 0.7287, 0.9383},
    {0.5211, 0.7337, 0.9542},
    {0.5213, 0.7384, 0.9692},
}};

}  // namespace

AzimuthChain make_azimuth_chain(int modes, AzimuthEnd end_kind) {
  assert(modes >= 1 && (end_kind == AzimuthEnd::absorbing || modes % 2 == 1));
  AzimuthChain chain;
  const auto count = static_cast<std::size_t>(modes);
  chain.coupling.assign(count, 0.5);
  chain.coupling[0] = 0.5 * std::numbers::sqrt2;
  if (end_kind == AzimuthEnd::cut_off) return chain;
  const ChainEnd& end = chain_ends[std::min(count, chain_ends.size()) - 1];
  if (modes > 1) chain.coupling[count - 2] = end.coupling_before;
  chain.coupling[count - 1] = end.coupling;
  chain.damping = end.damping;
  return chain;
}

AzimuthWaves azimuth_waves(const AzimuthChain& chain) {
  const auto n = static_cast<Eigen::Index>(chain.coupling.size()) + 1;
  Eigen::MatrixXd flow = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index m = 0; m + 1 < n; ++m) {
    flow(m + 1, m) = chain.coupling[static_cast<std::size_t>(m)];
    flow(m, m + 1) = -flow(m + 1, m);
  }
  flow(n - 1, n - 1) = -chain.damping;
  const Eigen::EigenSolver<Eigen::MatrixXd> waves(flow);
  const Eigen::MatrixXcd shapes = waves.eigenvectors();
  const Eigen::VectorXcd start =
      shapes.partialPivLu().solve(Eigen::VectorXcd(Eigen::VectorXcd::Unit(n, 0)));
  AzimuthWaves result;
  result.weight.resize(static_cast<std::size_t>(n));
  for (Eigen::Index q = 0; q < n; ++q) {
    const std::complex<double> rate = waves.eigenvalues()[q];
    if (rate.imag() < 0.0) continue;  // the conjugate of another
    result.rate.push_back(rate);
    for (Eigen::Index m = 0; m < n; ++m)
      result.weight[static_cast<std::size_t>(m)].push_back((rate.imag() > 0.0 ? 2.0 : 1.0) *
                                                           shapes(m, q) * start[q]);
  }
  return result;
}

}  // namespace lamina::detail
