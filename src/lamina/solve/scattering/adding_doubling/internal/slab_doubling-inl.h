// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Doubling of slabs, of one or of a batch, compiled once per instruction set.
#if defined(LAMINA_SLAB_DOUBLING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_SLAB_DOUBLING_INL_H_
#undef LAMINA_SLAB_DOUBLING_INL_H_
#else
#define LAMINA_SLAB_DOUBLING_INL_H_
#endif

#include "lamina/solve/scattering/adding_doubling/internal/dense_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {

/// factor * a, of a part of a matrix from element (i, j) on.
template <class Kind>
void copy_part(Dense<Kind>& to, const Dense<Kind>& from, std::size_t i, std::size_t j,
               double factor) {
  const D d;
  const V times = hn::Set(d, factor);
  for (std::size_t c = 0; c < to.columns(); ++c)
    for (std::size_t v = 0; v < to.vectors(); ++v)
      hn::Store(hn::Mul(times, hn::LoadU(d, from.element(i, j + c) + v * lanes())), d,
                target(to).place(v, c));
}

template <class Kind>
void add_to_diagonal(Dense<Kind>& m, double x) {
  for (std::size_t j = 0; j < m.columns(); ++j)
    for (std::size_t l = 0; l < Kind::element_size(); ++l) m.element(j, j)[l] += x;
}

/// The upper triangle from the lower one.
template <class Kind>
void mirror_lower(Dense<Kind>& m) {
  for (std::size_t j = 0; j < m.columns(); ++j)
    for (std::size_t i = j + 1; i < m.rows(); ++i)
      std::copy_n(m.element(i, j), Kind::element_size(), m.element(j, i));
}

/// K (J + sign H)^-1 K for symmetric H, K and the diagonal matrix J of the signs.
///
/// The matrix is quasi-definite: positive on the even states, negative on the odd ones, since no
/// reflector returns more than it gets. So two Cholesky factors do, without pivoting.
template <class Kind>
class Sandwich {
 public:
  Sandwich(std::size_t n, std::size_t even)
      : even_(even),
        odd_(n - even),
        first_(even),
        second_(odd_),
        Y_(n, even),
        W_(odd_, even),
        Z_(n, odd_),
        out_(n, n) {}

  /// The lower triangle.
  const Dense<Kind>& operator()(const Dense<Kind>& H, const Dense<Kind>& K, double sign) {
    const std::size_t vectors = out_.vectors(), n = out_.columns();
    copy_part(first_.root, H, 0, 0, sign);
    add_to_diagonal(first_.root, 1.0);
    first_.factor();
    copy_part(Y_, K, 0, 0, 1.0);
    first_.divide(Y_);
    add_product<Kind>(target(out_), source(Y_), transposed(Y_), vectors, even_, n, replace,
                      Shape::lower);
    if (odd_ == 0) return out_;
    copy_part(W_, H, even_, 0, sign);
    first_.divide(W_);
    copy_part(second_.root, H, even_, even_, -sign);
    add_to_diagonal(second_.root, 1.0);
    add_product<Kind>(target(second_.root), source(W_), transposed(W_), W_.vectors(), even_, odd_,
                      add, Shape::lower);
    second_.factor();
    copy_part(Z_, K, 0, even_, 1.0);
    add_product<Kind>(target(Z_), source(Y_), transposed(W_), vectors, even_, odd_, subtract);
    second_.divide(Z_);
    add_product<Kind>(target(out_), source(Z_), transposed(Z_), vectors, odd_, n, subtract,
                      Shape::lower);
    return out_;
  }

 private:
  std::size_t even_, odd_;
  Cholesky<Kind> first_, second_;
  Dense<Kind> Y_, W_, Z_, out_;
};

/// Two equal slabs on one another: lit alike from both sides, each sees a mirror at the joint, and
/// lit with opposite signs a mirror of reflectance -1.
///
///     R' + T' = R + T (1 - R)^-1 T,    R' - T' = R - T (1 + R)^-1 T
template <class Kind>
class Doubling {
 public:
  Doubling(std::size_t n, std::size_t even) : plus_(n, even), minus_(n, even) {}

  void operator()(Dense<Kind>& H, Dense<Kind>& K) {
    const D d;
    const Source P = source(plus_(H, K, -1.0)), Q = source(minus_(H, K, 1.0));
    const V half = hn::Set(d, 0.5);
    for (std::size_t j = 0; j < H.columns(); ++j)
      for (std::size_t v = j / Kind::rows_of_vector(); v < H.vectors(); ++v) {
        const V p = hn::Load(d, P.place(v, j)), q = hn::Load(d, Q.place(v, j));
        double* const of_H = target(H).place(v, j);
        hn::Store(hn::MulAdd(half, hn::Sub(p, q), hn::Load(d, of_H)), d, of_H);
        hn::Store(hn::Mul(half, hn::Add(p, q)), d, target(K).place(v, j));
      }
    mirror_lower(H);
    mirror_lower(K);
  }

 private:
  Sandwich<Kind> plus_, minus_;
};

/// Whether all elements of all matrices are less than this.
template <class Kind>
bool all_less(const Dense<Kind>& m, double limit) {
  const D d;
  V largest = hn::Zero(d);
  for (std::size_t j = 0; j < m.columns(); ++j)
    for (std::size_t v = 0; v < m.vectors(); ++v)
      largest = hn::Max(largest, hn::Abs(hn::Load(d, source(m).place(v, j))));
  return hn::AllTrue(d, hn::Lt(largest, hn::Set(d, limit)));
}

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
