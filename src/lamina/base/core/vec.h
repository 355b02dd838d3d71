// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lamina {

/// A point or displacement in the plane: texture coordinates, samples of the unit square.
template <class T>
struct BasicVec2 {
  T x{}, y{};

  friend constexpr BasicVec2 operator+(BasicVec2 a, BasicVec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr BasicVec2 operator-(BasicVec2 a, BasicVec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr BasicVec2 operator*(T s, BasicVec2 a) { return {s * a.x, s * a.y}; }
  friend constexpr BasicVec2 operator*(BasicVec2 a, T s) { return s * a; }
  friend constexpr bool operator==(const BasicVec2&, const BasicVec2&) = default;
};

/// A point, displacement or direction in space. In local frames the surface normal is +z.
template <class T>
struct BasicVec3 {
  T x{}, y{}, z{};

  constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr const T& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

  friend constexpr BasicVec3 operator+(const BasicVec3& a, const BasicVec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr BasicVec3 operator-(const BasicVec3& a, const BasicVec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr BasicVec3 operator-(const BasicVec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr BasicVec3 operator*(T s, const BasicVec3& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  friend constexpr BasicVec3 operator*(const BasicVec3& a, T s) { return s * a; }
  friend constexpr BasicVec3 operator/(const BasicVec3& a, T s) { return (T{1} / s) * a; }
  constexpr BasicVec3& operator+=(const BasicVec3& b) { return *this = *this + b; }
  constexpr BasicVec3& operator-=(const BasicVec3& b) { return *this = *this - b; }
  constexpr BasicVec3& operator*=(T s) { return *this = s * *this; }
  friend constexpr bool operator==(const BasicVec3&, const BasicVec3&) = default;
};

using Vec2 = BasicVec2<double>;
using Vec2f = BasicVec2<float>;
using Vec3 = BasicVec3<double>;
using Vec3f = BasicVec3<float>;

template <class T>
[[nodiscard]] constexpr T dot(const BasicVec3<T>& a, const BasicVec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
[[nodiscard]] constexpr BasicVec3<T> cross(const BasicVec3<T>& a, const BasicVec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
[[nodiscard]] T length(const BasicVec3<T>& a) {
  return std::sqrt(dot(a, a));
}

/// The direction of `a`, which must not be zero.
template <class T>
[[nodiscard]] BasicVec3<T> normalize(const BasicVec3<T>& a) {
  return a / length(a);
}

/// `w` mirrored about `n`; both point away from the surface, |n| = 1.
template <class T>
[[nodiscard]] constexpr BasicVec3<T> reflect(const BasicVec3<T>& w, const BasicVec3<T>& n) {
  return T{2} * dot(w, n) * n - w;
}

/// Right-handed orthonormal axes around a normal.
template <class T>
struct BasicFrame {
  BasicVec3<T> x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  [[nodiscard]] constexpr BasicVec3<T> to_local(const BasicVec3<T>& w) const {
    return {dot(w, x), dot(w, y), dot(w, z)};
  }
  [[nodiscard]] constexpr BasicVec3<T> to_world(const BasicVec3<T>& w) const {
    return w.x * x + w.y * y + w.z * z;
  }
};
using Frame = BasicFrame<double>;
using Framef = BasicFrame<float>;

/// Axes whose z is the unit vector `n`. Source: [Duff2017], branchless and stable everywhere.
template <class T>
[[nodiscard]] BasicFrame<T> make_frame(const BasicVec3<T>& n) {
  const T sign = std::copysign(T{1}, n.z);
  const T a = T{-1} / (sign + n.z);
  const T b = n.x * n.y * a;
  return {.x = {T{1} + sign * n.x * n.x * a, sign * b, -sign * n.x},
          .y = {b, sign + n.y * n.y * a, -n.y},
          .z = n};
}

[[nodiscard]] constexpr Vec3 to_double(const Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
[[nodiscard]] constexpr Vec3f to_float(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
[[nodiscard]] constexpr Vec2f to_float(const Vec2& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

}  // namespace lamina
