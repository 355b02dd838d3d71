// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Dense matrices of adding-doubling in SIMD, compiled once per instruction set: products and
// Cholesky factors of one matrix, whose rows fill the lanes of a vector, or of a batch of matrices,
// one per lane. Matrices of 40 to 100 states are too small to use the whole width of a processor
// one by one.
#if defined(LAMINA_DENSE_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_DENSE_KERNELS_INL_H_
#undef LAMINA_DENSE_KERNELS_INL_H_
#else
#define LAMINA_DENSE_KERNELS_INL_H_
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace lamina::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

inline std::size_t lanes() { return hn::Lanes(D()); }

using AlignedDoubles = hwy::AlignedFreeUniquePtr<double[]>;

/// @throws std::bad_alloc, where Highway's own function returns null
inline AlignedDoubles aligned_doubles(std::size_t count) {
  AlignedDoubles doubles = hwy::AllocateAligned<double>(count);
  if (!doubles) throw std::bad_alloc();
  return doubles;
}

/// One matrix: a vector holds rows of a column.
struct AlongRows {
  static std::size_t rows_of_vector() { return lanes(); }
  static std::size_t element_size() { return 1; }
  /// An element, in all lanes that it multiplies.
  static HWY_INLINE V factor(const double* element) { return hn::Set(D(), *element); }
};

/// A batch: a vector holds one element of every matrix.
struct AcrossMatrices {
  static std::size_t rows_of_vector() { return 1; }
  static std::size_t element_size() { return lanes(); }
  static HWY_INLINE V factor(const double* element) { return hn::Load(D(), element); }
};

/// Column after column, each of whole vectors; the lanes below the last row are 0.
template <class Kind>
class Dense {
 public:
  Dense(std::size_t rows, std::size_t columns)
      : rows_(rows),
        columns_(columns),
        // An odd number of vectors: columns shall not all start at the same place of a cache.
        column_((((rows + Kind::rows_of_vector() - 1) / Kind::rows_of_vector()) | 1) * lanes()),
        size_(column_ * columns),
        // What starts within a column may be read in vectors, and so beyond the last.
        values_(aligned_doubles(size_ + lanes())) {
    const std::size_t end = rows * Kind::element_size();
    for (std::size_t j = 0; j < columns; ++j)
      std::fill_n(values_.get() + j * column_ + end, column_ - end, 0.0);
    std::fill_n(values_.get() + size_, lanes(), 0.0);
  }
  /// Fills all elements with one number.
  void fill(double factor) {
    for (std::size_t j = 0; j < columns_; ++j)
      std::fill_n(element(0, j), rows_ * Kind::element_size(), factor);
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t vectors() const {
    return (rows_ + Kind::rows_of_vector() - 1) / Kind::rows_of_vector();
  }
  /// Doubles from one column to the next.
  [[nodiscard]] std::size_t column() const { return column_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double* data() { return values_.get(); }
  [[nodiscard]] const double* data() const { return values_.get(); }
  [[nodiscard]] double* element(std::size_t i, std::size_t j) {
    return data() + j * column_ + i * Kind::element_size();
  }
  [[nodiscard]] const double* element(std::size_t i, std::size_t j) const {
    return data() + j * column_ + i * Kind::element_size();
  }

 private:
  std::size_t rows_, columns_, column_, size_;
  AlignedDoubles values_;
};

/// Columns of whole vectors.
template <class T>
struct Columns {
  T* data;
  std::size_t column;  ///< doubles from one column to the next

  [[nodiscard]] HWY_INLINE Columns at(std::size_t vector, std::size_t j) const {
    return {data + vector * lanes() + j * column, column};
  }
  [[nodiscard]] HWY_INLINE T* place(std::size_t vector, std::size_t j) const {
    return data + vector * lanes() + j * column;
  }
};
using Source = Columns<const double>;
using Target = Columns<double>;

/// Single elements: factor (q, j) is at data + q * row + j * column.
struct Factors {
  const double* data;
  std::size_t row, column;

  [[nodiscard]] HWY_INLINE const double* place(std::size_t q, std::size_t j) const {
    return data + q * row + j * column;
  }
  [[nodiscard]] Factors at(std::size_t q, std::size_t j) const {
    return {place(q, j), row, column};
  }
};

template <class Kind>
Target target(Dense<Kind>& m) {
  return {m.data(), m.column()};
}
template <class Kind>
Source source(const Dense<Kind>& m) {
  return {m.data(), m.column()};
}
template <class Kind>
Factors factors(const Dense<Kind>& m) {
  return {m.data(), Kind::element_size(), m.column()};
}
template <class Kind>
Factors transposed(const Dense<Kind>& m) {
  return {m.data(), m.column(), Kind::element_size()};
}

enum class To { replace, add };

/// A product that is done: out = sign a b, or added to it.
struct Sum {
  To to = To::replace;
  double sign = 1.0;
};

/// The sum of a b on R vectors of C columns, held in registers.
template <class Kind, std::size_t R, std::size_t C>
HWY_INLINE void add_tile(Target out, Source a, Factors b, std::size_t inner, Sum sum) {
  const D d;
  V sums[R * C];
  const auto each = [&]<std::size_t... I>(std::index_sequence<I...>) HWY_ATTR {
    ((sums[I] = hn::Zero(d)), ...);
    for (std::size_t q = 0; q < inner; ++q) {
      V of_a[R];
      const auto load = [&]<std::size_t... K>(std::index_sequence<K...>) HWY_ATTR {
        ((of_a[K] = hn::Load(d, a.place(K, q))), ...);
      };
      load(std::make_index_sequence<R>());
      // One factor at a time: with 12 sums and 3 vectors of a, AVX2 has one register left.
      const auto add = [&]<std::size_t... K>(auto column, std::index_sequence<K...>) HWY_ATTR {
        const V of_b = Kind::factor(b.place(q, column));
        ((sums[column * R + K] = hn::MulAdd(of_a[K], of_b, sums[column * R + K])), ...);
      };
      const auto add_all = [&]<std::size_t... K>(std::index_sequence<K...>) HWY_ATTR {
        (add(std::integral_constant<std::size_t, K>(), std::make_index_sequence<R>()), ...);
      };
      add_all(std::make_index_sequence<C>());
    }
    const V sign = hn::Set(d, sum.sign);
    if (sum.to == To::replace)
      (hn::StoreU(hn::Mul(sign, sums[I]), d, out.place(I % R, I / R)), ...);
    else
      (hn::StoreU(hn::MulAdd(sign, sums[I], hn::LoadU(d, out.place(I % R, I / R))), d,
                  out.place(I % R, I / R)),
       ...);
  };
  each(std::make_index_sequence<R * C>());
}

template <class Kind, std::size_t C>
void add_columns(Target out, Source a, Factors b, std::size_t from, std::size_t vectors,
                 std::size_t inner, Sum sum) {
  std::size_t v = from;
  for (; v + 3 <= vectors; v += 3) add_tile<Kind, 3, C>(out.at(v, 0), a.at(v, 0), b, inner, sum);
  if (v + 2 == vectors) add_tile<Kind, 2, C>(out.at(v, 0), a.at(v, 0), b, inner, sum);
  if (v + 1 == vectors) add_tile<Kind, 1, C>(out.at(v, 0), a.at(v, 0), b, inner, sum);
}

inline constexpr Sum add{To::add, 1.0}, subtract{To::add, -1.0}, replace{To::replace, 1.0};

enum class Shape { full, lower };

/// a b; of a symmetric result only what lies on and below the diagonal, and a little above it.
template <class Kind>
void add_product(Target out, Source a, Factors b, std::size_t vectors, std::size_t inner,
                 std::size_t columns, Sum sum, Shape shape = Shape::full) {
  const auto first = [&](std::size_t j) {
    return shape == Shape::lower ? j / Kind::rows_of_vector() : 0;
  };
  std::size_t j = 0;
  for (; j + 4 <= columns; j += 4)
    add_columns<Kind, 4>(out.at(0, j), a, b.at(0, j), first(j), vectors, inner, sum);
  switch (columns - j) {
    case 3:
      return add_columns<Kind, 3>(out.at(0, j), a, b.at(0, j), first(j), vectors, inner, sum);
    case 2:
      return add_columns<Kind, 2>(out.at(0, j), a, b.at(0, j), first(j), vectors, inner, sum);
    case 1:
      return add_columns<Kind, 1>(out.at(0, j), a, b.at(0, j), first(j), vectors, inner, sum);
    default:
      return;
  }
}

/// x(:, j) -= x(:, q) r(j, q) for q in [first, j).
template <class Kind>
HWY_INLINE void subtract_columns(Target x, std::size_t vectors, Factors r, std::size_t first,
                                 std::size_t j) {
  const D d;
  for (std::size_t q = first; q < j; ++q) {
    const V factor = Kind::factor(r.place(j, q));
    for (std::size_t v = 0; v < vectors; ++v)
      hn::Store(hn::NegMulAdd(hn::Load(d, x.place(v, q)), factor, hn::Load(d, x.place(v, j))), d,
                x.place(v, j));
  }
}

HWY_INLINE void scale_column(Target x, std::size_t vectors, std::size_t j, V scale) {
  const D d;
  for (std::size_t v = 0; v < vectors; ++v)
    hn::Store(hn::Mul(hn::Load(d, x.place(v, j)), scale), d, x.place(v, j));
}

/// The lower Cholesky factor L of a matrix.
template <class Kind>
struct Cholesky {
  static constexpr std::size_t block = 4;  ///< columns that are worked on together
  Dense<Kind> root;                        ///< L; what lies above its diagonal is arbitrary
  AlignedDoubles inverse;                  ///< of the diagonal, a vector each

  explicit Cholesky(std::size_t n) : root(n, n), inverse(aligned_doubles((n + 1) * lanes())) {}

  /// Replaces the matrix that `root` holds by its factor.
  void factor() {
    const D d;
    const std::size_t n = root.columns();
    for (std::size_t first = 0; first < n; first += block) {
      const std::size_t last = std::min(n, first + block);
      const std::size_t above = first / Kind::rows_of_vector();
      const std::size_t vectors = root.vectors() - above;
      const Target below = target(root).at(above, 0);
      add_product<Kind>(below.at(0, first), source(root).at(above, 0),
                        transposed(root).at(0, first), vectors, first, last - first, subtract);
      for (std::size_t j = first; j < last; ++j) {
        subtract_columns<Kind>(below, vectors, factors(root), first, j);
        // Of a slab that lets less than rounding through, a pivot may come out 0 or less.
        const V pivot = hn::Max(Kind::factor(root.element(j, j)), hn::Set(d, 1e-15));
        const V scale = hn::Div(hn::Set(d, 1.0), hn::Sqrt(pivot));
        hn::Store(scale, d, inverse.get() + j * lanes());
        scale_column(below, vectors, j, scale);
      }
    }
  }

  /// x <- x L^-T.
  void divide(Dense<Kind>& x) const {
    const std::size_t n = root.columns();
    for (std::size_t first = 0; first < n; first += block) {
      const std::size_t last = std::min(n, first + block);
      add_product<Kind>(target(x).at(0, first), source(x), transposed(root).at(0, first),
                        x.vectors(), first, last - first, subtract);
      for (std::size_t j = first; j < last; ++j) {
        subtract_columns<Kind>(target(x), x.vectors(), factors(root), first, j);
        scale_column(target(x), x.vectors(), j, hn::Load(D(), inverse.get() + j * lanes()));
      }
    }
  }
};

}  // namespace lamina::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
