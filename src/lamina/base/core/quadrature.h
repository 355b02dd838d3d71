// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace lamina {

/// Nodes and weights of a quadrature rule: sum of weights[i] * f(nodes[i]).
struct Quadrature {
  std::vector<double> nodes;    ///< ascending
  std::vector<double> weights;  ///< of the same size
};

/// Gauss-Legendre rule with n >= 1 nodes on [a, b]; exact for polynomials of degree 2n - 1.
[[nodiscard]] Quadrature gauss_legendre(int n, double a = -1.0, double b = 1.0);

/// Integral of f over [a, b] by adaptive Gauss-Kronrod (7, 15) bisection.
///
/// @param tolerance  stops where the estimated error is below tolerance * (1 + |integral|).
/// At most 2000 panels are cut, worst first, so the call ends for every integrand.
template <class F>
[[nodiscard]] double integrate(const F& f, double a, double b, double tolerance = 1e-10);

namespace detail {

struct KronrodPanel {
  double integral;
  double error;  ///< |Kronrod 15 - Gauss 7|
};

/// Source: [Piessens1983] QUADPACK, table of QK15.
template <class F>
KronrodPanel kronrod_panel(const F& f, double a, double b) {
  static constexpr std::array<double, 8> x = {
      0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
      0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
      0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
      0.207784955007898467600689403773245, 0.0};
  static constexpr std::array<double, 8> w_kronrod = {
      0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
      0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
      0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
      0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
  static constexpr std::array<double, 4> w_gauss = {
      0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
      0.381830050505118944950369775488975, 0.417959183673469387755102040816327};
  const double center = 0.5 * (a + b), half = 0.5 * (b - a);
  const double f_center = f(center);
  double kronrod = w_kronrod[7] * f_center, gauss = w_gauss[3] * f_center;
  for (std::size_t i = 0; i < 7; ++i) {
    const double pair = f(center - half * x[i]) + f(center + half * x[i]);
    kronrod += w_kronrod[i] * pair;
    if (i % 2 == 1) gauss += w_gauss[i / 2] * pair;
  }
  return {kronrod * half, std::abs(kronrod - gauss) * std::abs(half)};
}

}  // namespace detail

template <class F>
double integrate(const F& f, double a, double b, double tolerance) {
  struct Piece {
    double a, b;
    detail::KronrodPanel panel;
    bool operator<(const Piece& other) const { return panel.error < other.panel.error; }
  };
  std::vector<Piece> pieces = {{a, b, detail::kronrod_panel(f, a, b)}};  // a heap, worst first
  double integral = pieces[0].panel.integral, error = pieces[0].panel.error;
  for (int cuts = 0; cuts < 2000 && error > tolerance * (1.0 + std::abs(integral)); ++cuts) {
    std::pop_heap(pieces.begin(), pieces.end());
    const Piece worst = pieces.back();
    pieces.pop_back();
    const double middle = 0.5 * (worst.a + worst.b);
    for (const auto& [from, to] : {std::pair{worst.a, middle}, std::pair{middle, worst.b}}) {
      pieces.push_back({from, to, detail::kronrod_panel(f, from, to)});
      std::push_heap(pieces.begin(), pieces.end());
    }
    integral = error = 0.0;
    for (const Piece& piece : pieces) {
      integral += piece.panel.integral;
      error += piece.panel.error;
    }
  }
  return integral;
}

}  // namespace lamina
