// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace lamina {

/// A list of a length that stays, whose elements live inside it where they are few: for what is
/// made at every hit of a ray. Elements are not initialized.
template <class T, std::size_t Few>
class InlineVector {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  InlineVector() = default;
  explicit InlineVector(std::size_t size) { reset(size); }
  InlineVector(const InlineVector& other) : InlineVector(other.size_) {
    for (std::size_t i = 0; i < size_; ++i) (*this)[i] = other[i];
  }
  InlineVector(InlineVector&& other) noexcept : size_(other.size_), many_(std::move(other.many_)) {
    if (size_ <= Few)
      for (std::size_t i = 0; i < size_; ++i) (*this)[i] = other[i];
  }
  InlineVector& operator=(InlineVector other) noexcept {
    size_ = other.size_;
    many_ = std::move(other.many_);
    if (size_ <= Few)
      for (std::size_t i = 0; i < size_; ++i) (*this)[i] = other[i];
    return *this;
  }

  /// Makes it that long, elements not initialized. It must be empty.
  void reset(std::size_t size) {
    assert(size_ == 0);
    size_ = size;
    if (size > Few) many_ = std::make_unique_for_overwrite<Slot[]>(size);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// All elements, one after the other.
  [[nodiscard]] T* data() { return &slot(0).value; }
  [[nodiscard]] const T* data() const { return const_cast<InlineVector*>(this)->data(); }
  [[nodiscard]] T& operator[](std::size_t i) { return slot(i).value; }
  [[nodiscard]] const T& operator[](std::size_t i) const {
    return const_cast<InlineVector*>(this)->slot(i).value;
  }

 private:
  union Slot {
    Slot() {}
    T value;
  };
  static_assert(sizeof(Slot) == sizeof(T));
  Slot& slot(std::size_t i) { return size_ > Few ? many_[i] : few_[i]; }

  std::size_t size_ = 0;
  std::array<Slot, Few> few_;
  std::unique_ptr<Slot[]> many_;
};

}  // namespace lamina
