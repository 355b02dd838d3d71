// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Part of adding_doubling_matrix.cpp, compiled with it for each kind of processor: slabs at several
// spatial frequencies at once, one per lane of a vector. Matrices of 40 to 100 states are too small
// to use the whole width of a processor one by one.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lamina::detail {
namespace {

#if defined(__AVX512F__)
constexpr int lanes = 8;
#elif defined(__AVX__)
constexpr int lanes = 4;
#else
constexpr int lanes = 2;
#endif
typedef double Lanes __attribute__((vector_size(lanes * sizeof(double))));

Lanes all_lanes(double x) {
  Lanes v;
  for (int l = 0; l < lanes; ++l) v[l] = x;
  return v;
}

/// A matrix per lane, column after column.
class Batch {
 public:
  Batch(int rows, int columns)
      : rows_(rows), values_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] Lanes* data() { return values_.data(); }
  [[nodiscard]] const Lanes* data() const { return values_.data(); }
  Lanes& operator()(int i, int j) {
    return values_[static_cast<std::size_t>(j) * static_cast<std::size_t>(rows_) +
                   static_cast<std::size_t>(i)];
  }
  const Lanes& operator()(int i, int j) const {
    return values_[static_cast<std::size_t>(j) * static_cast<std::size_t>(rows_) +
                   static_cast<std::size_t>(i)];
  }

 private:
  int rows_;
  std::vector<Lanes> values_;
};

/// Part of a matrix: element (i, j) at data[i * row + j * column].
template <class T>
struct Part {
  T* data;
  std::ptrdiff_t row, column;

  T& operator()(int i, int j) const { return data[i * row + j * column]; }
  [[nodiscard]] Part at(int i, int j) const { return {data + i * row + j * column, row, column}; }
  [[nodiscard]] Part transposed() const { return {data, column, row}; }
};
using Source = Part<const Lanes>;
using Target = Part<Lanes>;

Target part(Batch& m, int i = 0, int j = 0) { return Target{m.data(), 1, m.rows()}.at(i, j); }
Source view(const Batch& m, int i = 0, int j = 0) { return Source{m.data(), 1, m.rows()}.at(i, j); }

/// out += sign a b on an R x C block.
template <int R, int C>
void add_block(Target out, Source a, Source b, int inner, double sign) {
  Lanes sum[R][C] = {};
  for (int q = 0; q < inner; ++q)
    for (int j = 0; j < C; ++j) {
      const Lanes factor = b(q, j);
      for (int i = 0; i < R; ++i) sum[i][j] += a(i, q) * factor;
    }
  for (int j = 0; j < C; ++j)
    for (int i = 0; i < R; ++i) out(i, j) += sign * sum[i][j];
}

template <int C>
void add_columns(Target out, Source a, Source b, int from, int rows, int inner, double sign) {
  int i = from;
  for (; i + 4 <= rows; i += 4) add_block<4, C>(out.at(i, 0), a.at(i, 0), b, inner, sign);
  switch (rows - i) {
    case 3:
      add_block<3, C>(out.at(i, 0), a.at(i, 0), b, inner, sign);
      break;
    case 2:
      add_block<2, C>(out.at(i, 0), a.at(i, 0), b, inner, sign);
      break;
    case 1:
      add_block<1, C>(out.at(i, 0), a.at(i, 0), b, inner, sign);
      break;
    default:
      break;
  }
}

/// out += sign a b; of a symmetric result only what lies on and below the diagonal, and a little
/// above it.
void add_product(Target out, Source a, Source b, int rows, int inner, int columns, double sign,
                 bool lower_only = false) {
  int j = 0;
  for (; j + 3 <= columns; j += 3)
    add_columns<3>(out.at(0, j), a, b.at(0, j), lower_only ? j / 4 * 4 : 0, rows, inner, sign);
  for (; j < columns; ++j)
    add_columns<1>(out.at(0, j), a, b.at(0, j), lower_only ? j / 4 * 4 : 0, rows, inner, sign);
}

/// The lower Cholesky factor in place, with the inverse of its diagonal in `inverse`.
void cholesky(Target m, int n, std::vector<Lanes>& inverse) {
  inverse.resize(static_cast<std::size_t>(n));
  for (int j = 0; j < n; ++j) {
    add_columns<1>(m.at(0, j), Source{m.data, m.row, m.column},
                   Source{m.data, m.row, m.column}.at(j, 0).transposed(), j, n, j, -1.0);
    Lanes root;
    for (int l = 0; l < lanes; ++l) root[l] = std::sqrt(m(j, j)[l]);
    const Lanes reciprocal = 1.0 / root;
    inverse[static_cast<std::size_t>(j)] = reciprocal;
    for (int i = j; i < n; ++i) m(i, j) *= reciprocal;
  }
}

/// x <- x L^-T for the lower factor L.
void divide(Target x, int rows, Source root, int n, const std::vector<Lanes>& inverse) {
  constexpr int block = 3;
  for (int first = 0; first < n; first += block) {
    const int last = std::min(n, first + block);
    add_product(x.at(0, first), Source{x.data, x.row, x.column}, root.at(first, 0).transposed(),
                rows, first, last - first, -1.0);
    for (int j = first; j < last; ++j) {
      for (int q = first; q < j; ++q) {
        const Lanes l = root(j, q);
        for (int i = 0; i < rows; ++i) x(i, j) -= x(i, q) * l;
      }
      for (int i = 0; i < rows; ++i) x(i, j) *= inverse[static_cast<std::size_t>(j)];
    }
  }
}

struct BatchWork {
  Batch first, second, Y, W, Z;
  std::vector<Lanes> inverse;
  BatchWork(int n, int even)
      : first(even, even),
        second(n - even, n - even),
        Y(n, even),
        W(n - even, even),
        Z(n, n - even) {}
};

/// K (J + sign H)^-1 K, lower triangle, as for one matrix.
void sandwich(const Batch& H, const Batch& K, double sign, int even, BatchWork& work, Batch& out) {
  const int n = H.rows(), odd = n - even;
  const Lanes one = all_lanes(1.0);
  for (int j = 0; j < even; ++j) {
    for (int i = 0; i < even; ++i) work.first(i, j) = sign * H(i, j);
    work.first(j, j) += one;
    for (int i = 0; i < odd; ++i) work.W(i, j) = sign * H(even + i, j);
    for (int i = 0; i < n; ++i) work.Y(i, j) = K(i, j);
  }
  for (int j = 0; j < odd; ++j) {
    for (int i = 0; i < odd; ++i) work.second(i, j) = -sign * H(even + i, even + j);
    work.second(j, j) += one;
    for (int i = 0; i < n; ++i) work.Z(i, j) = K(i, even + j);
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) out(i, j) = Lanes{};
  cholesky(part(work.first), even, work.inverse);
  divide(part(work.Y), n, view(work.first), even, work.inverse);
  add_product(part(out), view(work.Y), view(work.Y).transposed(), n, even, n, 1.0, true);
  if (odd == 0) return;
  divide(part(work.W), odd, view(work.first), even, work.inverse);
  add_product(part(work.second), view(work.W), view(work.W).transposed(), odd, even, odd, 1.0,
              true);
  add_product(part(work.Z), view(work.Y), view(work.W).transposed(), n, even, odd, -1.0);
  cholesky(part(work.second), odd, work.inverse);
  divide(part(work.Z), n, view(work.second), odd, work.inverse);
  add_product(part(out), view(work.Z), view(work.Z).transposed(), n, odd, n, -1.0, true);
}

/// Two equal slabs on one another, `doublings` times, as `slab` has it; in every lane until the
/// most transparent one lets through no more than `opaque`.
void double_slabs(Batch& H, Batch& K, int even, int doublings, double opaque) {
  const int n = H.rows();
  Batch P(n, n), Q(n, n);
  BatchWork work(n, even);
  for (int done = 0; done < doublings; ++done) {
    sandwich(H, K, -1.0, even, work, P);
    sandwich(H, K, 1.0, even, work, Q);
    Lanes largest{};
    for (int j = 0; j < n; ++j)
      for (int i = j; i < n; ++i) {
        H(j, i) = H(i, j) += 0.5 * (P(i, j) - Q(i, j));
        K(j, i) = K(i, j) = 0.5 * (P(i, j) + Q(i, j));
        const Lanes size = K(i, j) < 0.0 ? -K(i, j) : K(i, j);
        largest = size > largest ? size : largest;
      }
    bool is_opaque = opaque > 0.0;
    for (int l = 0; l < lanes; ++l) is_opaque = is_opaque && largest[l] < opaque;
    if (is_opaque) break;
  }
}

}  // namespace
}  // namespace lamina::detail
