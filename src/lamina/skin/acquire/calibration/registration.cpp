// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/symmetric_eigen.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"
#include "lamina/skin/acquire/calibration/internal/gradient_field.h"

namespace lamina {
namespace {

/// Shift, growth and turn; the latter two in pixels at the distance of a corner from the middle, so
/// that all are of one size.
using Coordinates = std::array<double, 4>;

double corner_distance(int width, int height) { return 0.5 * std::hypot(width, height); }

ImageMotion motion_of(const Coordinates& p, int width, int height) {
  const double corner = corner_distance(width, height);
  return {{p[0], p[1]}, std::exp(p[2] / corner), p[3] / corner};
}

/// Two gradients at one place, and how the second changes with the motion.
struct Pair {
  Vec2 fixed{}, moving{};
  std::array<Vec2, 4> derivatives{};        ///< of the moving one, [coordinate]
  std::array<Vec2, 4> fixed_derivatives{};  ///< of the fixed one, were it moved
  double weight = 0.0;
};

double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }

/// A place in a pixel, drawn from its number. Noise that is interpolated is least in the middle
/// between pixels; were one image looked at in the centres of its pixels alone, that would draw the
/// other to halves of pixels.
Vec2 place_in_pixel(int x, int y) {
  std::uint64_t state = (static_cast<std::uint64_t>(y) << 32) ^ static_cast<std::uint64_t>(x);
  const std::uint64_t bits = Random::splitmix(state);
  return {x + static_cast<double>(bits >> 32) * 0x1p-32,
          y + static_cast<double>(bits & 0xffffffffu) * 0x1p-32};
}

/// How a gradient changes with the coordinates of the motion.
/// @param arm  from the middle of the image, over the distance of a corner
std::array<Vec2, 4> derivatives_of(const GradientSample& sample, Vec2 arm) {
  return {sample.by_x, sample.by_y, arm.x * sample.by_x + arm.y * sample.by_y,
          arm.x * sample.by_y - arm.y * sample.by_x};
}

/// Absent if the place lies outside of the moving image.
std::optional<Pair> pair_at(const GradientField& fixed, const GradientField& moving,
                            const ImageMotion& motion, int x, int y) {
  constexpr double rim = 6.0;  // of gradients
  const Vec2 place = place_in_pixel(x, y);
  const Vec2 to = moved(motion, place, fixed.width, fixed.height);
  if (!(to.x >= rim && to.y >= rim && to.x <= moving.width - rim && to.y <= moving.height - rim))
    return std::nullopt;
  const float weight = fixed.weights[fixed.index(x, y)];
  if (!(weight > 0.0f)) return std::nullopt;
  const GradientSample at_fixed = sample_gradient(fixed, place);
  const GradientSample at_moving = sample_gradient(moving, to);
  const double corner = corner_distance(fixed.width, fixed.height);
  const Vec2 middle{0.5 * fixed.width, 0.5 * fixed.height};
  const Vec2 arm = (1.0 / corner) * (to - middle - motion.shift);
  return Pair{at_fixed.value, at_moving.value, derivatives_of(at_moving, arm),
              derivatives_of(at_fixed, arm), static_cast<double>(weight)};
}

/// Calls body(pair, x, y) for pixels of a grid, not more than some hundred thousand of them.
template <class Body>
void for_pairs(const GradientField& fixed, const GradientField& moving, const ImageMotion& motion,
               const Body& body) {
  constexpr double most_pixels = 3e5;
  const double pixels = static_cast<double>(fixed.width) * fixed.height;
  const int step = std::max(1, static_cast<int>(std::sqrt(pixels / most_pixels)));
  for (int y = 6; y < fixed.height - 6; y += step)
    for (int x = 6; x < fixed.width - 6; x += step)
      if (const auto pair = pair_at(fixed, moving, motion, x, y)) body(*pair, x, y);
}

double agreement(const GradientField& fixed, const GradientField& moving,
                 const ImageMotion& motion) {
  double sum = 0.0, all = 0.0;
  for_pairs(fixed, moving, motion, [&](const Pair& pair, int, int) {
    const double lengths = dot(pair.fixed, pair.fixed) * dot(pair.moving, pair.moving);
    const double product = dot(pair.fixed, pair.moving);
    sum += pair.weight * (2.0 * product * product - lengths);
    all += pair.weight * lengths;
  });
  return all > 0.0 ? sum / all : 0.0;
}

/// Sums of a Gauss-Newton step over pixels.
struct NormalEquations {
  DenseMatrix squares;   ///< of derivatives
  DenseMatrix products;  ///< of those of both images: of what both show, not of their noise
  Coordinates slope{};   ///< derivatives times residuals
  std::map<std::array<int, 2>, Coordinates> blocks;  ///< the same of blocks of pixels
};

/// Residuals are fixed - s moving with s the sign of their product, of Cauchy's weights.
NormalEquations normal_equations(const GradientField& fixed, const GradientField& moving,
                                 const ImageMotion& motion, std::size_t free) {
  constexpr int block_side = 16;
  constexpr double limit = 0.5;  // of residuals that count in full
  NormalEquations sums{.squares = DenseMatrix(free, free), .products = DenseMatrix(free, free)};
  for_pairs(fixed, moving, motion, [&](const Pair& pair, int x, int y) {
    const double sign = dot(pair.fixed, pair.moving) < 0.0 ? -1.0 : 1.0;
    const Vec2 residual = pair.fixed - sign * pair.moving;
    const double weight = pair.weight / (1.0 + dot(residual, residual) / (limit * limit));
    Coordinates& block = sums.blocks[{x / block_side, y / block_side}];
    for (std::size_t a = 0; a < free; ++a) {
      const double slope = weight * sign * dot(pair.derivatives[a], residual);
      sums.slope[a] += slope;
      block[a] += slope;
      for (std::size_t b = 0; b < free; ++b) {
        sums.squares(a, b) += weight * dot(pair.derivatives[a], pair.derivatives[b]);
        sums.products(a, b) += 0.5 * weight * sign *
                               (dot(pair.derivatives[a], pair.fixed_derivatives[b]) +
                                dot(pair.fixed_derivatives[a], pair.derivatives[b]));
      }
    }
  });
  return sums;
}

DenseMatrix inverse_of(const DenseMatrix& a) {
  DenseMatrix one(a.rows, a.rows);
  for (std::size_t i = 0; i < a.rows; ++i) one(i, i) = 1.0;
  return solve_linear(a, one);
}

void improve(const GradientField& fixed, const GradientField& moving, std::size_t free,
             Coordinates& p) {
  constexpr int most_steps = 25;
  constexpr double longest_step = 1.5, no_step = 1e-4;  // [pixel]
  for (int i = 0; i < most_steps; ++i) {
    const NormalEquations sums =
        normal_equations(fixed, moving, motion_of(p, fixed.width, fixed.height), free);
    const DenseMatrix inverse = inverse_of(sums.squares);
    Coordinates step{};
    double length = 0.0;
    for (std::size_t a = 0; a < free; ++a) {
      for (std::size_t b = 0; b < free; ++b) step[a] += inverse(a, b) * sums.slope[b];
      length = std::max(length, std::abs(step[a]));
    }
    if (!std::isfinite(length)) return;
    for (std::size_t a = 0; a < free; ++a) p[a] += step[a] * std::min(1.0, longest_step / length);
    if (length < no_step) return;
  }
}

/// The root of the largest variance of the place of a corner: H^-1 (sum of g g^T) H^-1 with g of
/// blocks, whose errors are independent, and H of products of both images: squares of one would
/// count its noise as contrast.
double expected_error(const GradientField& fixed, const GradientField& moving,
                      const ImageMotion& motion, std::size_t free) {
  const NormalEquations sums = normal_equations(fixed, moving, motion, free);
  constexpr double least_told = 1e-3;  // of the motion that is told least: stripes tell one shift
  const std::vector<double> told = symmetric_eigen(sums.products).values;
  if (!(told.front() > least_told * told.back())) return std::numeric_limits<double>::infinity();
  const DenseMatrix inverse = inverse_of(sums.products);
  DenseMatrix scatter(free, free);
  for (const auto& [place, g] : sums.blocks)
    for (std::size_t a = 0; a < free; ++a)
      for (std::size_t b = 0; b < free; ++b) scatter(a, b) += g[a] * g[b];
  const DenseMatrix covariance = multiply(multiply(inverse, scatter), inverse);
  const double corner = corner_distance(fixed.width, fixed.height);
  double largest = 0.0;
  for (const double side : {-1.0, 1.0}) {
    const double x = 0.5 * fixed.width / corner, y = side * 0.5 * fixed.height / corner;
    const std::array<Coordinates, 2> moves = {{{1.0, 0.0, x, -y}, {0.0, 1.0, y, x}}};
    double variance = 0.0;
    for (const Coordinates& move : moves)
      for (std::size_t a = 0; a < free; ++a)
        for (std::size_t b = 0; b < free; ++b) variance += move[a] * covariance(a, b) * move[b];
    largest = std::max(largest, variance);
  }
  return std::isfinite(largest) ? std::sqrt(largest) : std::numeric_limits<double>::infinity();
}

/// The whole-pixel shift of the best agreement.
Coordinates best_shift(const GradientField& fixed, const GradientField& moving, double most) {
  const int reach = static_cast<int>(std::ceil(most));
  Coordinates best{};
  double highest = -2.0;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const Vec2 shift{static_cast<double>(x), static_cast<double>(y)};
      const double value = agreement(fixed, moving, {.shift = shift});
      if (value <= highest) continue;
      highest = value;
      best = {shift.x, shift.y, 0.0, 0.0};
    }
  return best;
}

}  // namespace

Vec2 moved(const ImageMotion& motion, Vec2 place, int width, int height) {
  const Vec2 middle{0.5 * width, 0.5 * height}, arm = place - middle;
  const double c = motion.scale * std::cos(motion.rotation);
  const double s = motion.scale * std::sin(motion.rotation);
  return middle + motion.shift + Vec2{c * arm.x - s * arm.y, s * arm.x + c * arm.y};
}

Registration register_images(const Image& fixed, std::size_t fixed_channel, const Image& moving,
                             std::size_t moving_channel, const PixelMask& mask,
                             const RegistrationOptions& options) {
  require_size(mask, fixed, "registration: the mask");
  if (moving.width != fixed.width || moving.height != fixed.height ||
      std::min(fixed.width, fixed.height) < 32)
    throw InvalidInput("registration: images must be of one size, of 32 pixels or more, but are " +
                       std::to_string(fixed.width) + " x " + std::to_string(fixed.height) +
                       " and " + std::to_string(moving.width) + " x " +
                       std::to_string(moving.height));
  if (!(options.most_shift >= 0.0))
    throw InvalidInput("registration: most_shift must be >= 0 pixels, but is " +
                       number_text(options.most_shift));
  require_used_pixels(mask, "registration: the mask");
  const auto fixed_fields = gradient_pyramid(fixed, fixed_channel, mask);
  const auto moving_fields = gradient_pyramid(moving, moving_channel, mask);
  const double most_shift = options.most_shift > 0.0
                                ? options.most_shift
                                : std::max(8.0, 0.05 * std::max(fixed.width, fixed.height));
  const std::size_t free = options.with_scale_and_rotation ? 4 : 2, levels = fixed_fields.size();
  Coordinates p = best_shift(fixed_fields.back(), moving_fields.back(),
                             most_shift / std::exp2(static_cast<double>(levels - 1)));
  for (std::size_t level = levels; level-- > 0;) {
    // At the coarsest level few pixels tell of turns.
    improve(fixed_fields[level], moving_fields[level], level + 1 == levels ? 2 : free, p);
    if (level > 0)
      for (double& each : p) each *= 2.0;
  }
  Registration result{.motion = motion_of(p, fixed.width, fixed.height)};
  result.error = expected_error(fixed_fields[0], moving_fields[0], result.motion, free);
  result.agreement = agreement(fixed_fields[0], moving_fields[0], result.motion);
  result.is_good = result.error <= options.largest_error &&
                   result.agreement >= options.least_agreement &&
                   std::max(std::abs(p[0]), std::abs(p[1])) <= 1.5 * most_shift;
  return result;
}

std::vector<Registration> register_channels(const Image& image, std::size_t reference,
                                            const PixelMask& mask,
                                            const RegistrationOptions& options) {
  if (reference >= image.channel_count())
    throw InvalidInput("registration: the reference must be one of the " +
                       std::to_string(image.channel_count()) + " channels, but is number " +
                       std::to_string(reference));
  std::vector<Registration> result;
  for (std::size_t c = 0; c < image.channel_count(); ++c)
    result.push_back(c == reference ? Registration{.error = 0.0, .agreement = 1.0, .is_good = true}
                                    : register_images(image, reference, image, c, mask, options));
  return result;
}

void require_registered(const Registration& registration, const std::string& what) {
  if (registration.is_good) return;
  const auto& [shift, scale, rotation] = registration.motion;
  throw InvalidInput(what + " cannot be registered: it seems moved by (" +
                     printf_text("%.2f, %.2f", shift.x, shift.y) +
                     ") pixels, but the error may be " + printf_text("%.2f", registration.error) +
                     " pixels, and edges agree by " + printf_text("%.2f", registration.agreement) +
                     " (1: all of them)");
}

}  // namespace lamina
