// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/skin_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/float_within.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/smooth_step.h"
#include "lamina/base/image/bilinear.h"
#include "lamina/skin/maps/internal/skin_canvas.h"
#include "lamina/skin/maps/vessel_fork.h"

namespace lamina {
namespace {

/// Smooth noise of mean 0 and variance about 1 whose features are `size` apart: cubic blends of
/// random numbers on a lattice, three octaves.
class Noise {
 public:
  Noise(std::uint64_t seed, double size) : seed_(seed), size_(size) {}

  [[nodiscard]] double operator()(CanvasPoint p) const {
    double sum = 0.0, amount = 1.0, size = size_;
    for (std::uint64_t octave = 0; octave < 3; ++octave, amount *= 0.5, size *= 0.5)
      sum += amount * lattice_noise({p.x / size, p.y / size}, octave);
    return 1.6 * sum;
  }

 private:
  [[nodiscard]] double lattice_noise(CanvasPoint p, std::uint64_t octave) const {
    const double left = std::floor(p.x), top = std::floor(p.y);
    const double u = smooth_step(p.x - left), v = smooth_step(p.y - top);
    const auto at = [&](double x, double y) {
      const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(x));
      const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(y));
      Random random = make_random(seed_ + octave, column * 0x9e3779b97f4a7c15u ^ row);
      return 2.0 * random.uniform() - 1.0;
    };
    return (1.0 - v) * ((1.0 - u) * at(left, top) + u * at(left + 1.0, top)) +
           v * ((1.0 - u) * at(left, top + 1.0) + u * at(left + 1.0, top + 1.0));
  }

  std::uint64_t seed_;
  double size_;
};

double sample_span(Random& random, const Span2& span) {
  return span[0] + random.uniform() * (span[1] - span[0]);
}
double between_logarithms(Random& random, const Span2& span) {
  return std::exp(sample_span(random, {std::log(span[0]), std::log(span[1])}));
}

void apply_feature(const MelaninSpots& spots, std::uint64_t seed, SkinCanvas& canvas) {
  const CanvasGrid& grid = canvas.grid;
  Random random = make_random(seed, 0);
  const double area = grid.across() * grid.down() / 100.0;  // [cm²]
  const auto count = static_cast<int>(std::lround(spots.density * area));
  std::vector<double> added(grid.size(), 0.0);
  for (int i = 0; i < count; ++i) {
    const CanvasPoint middle = {random.uniform() * grid.across(), random.uniform() * grid.down()};
    const double radius = 0.5 * between_logarithms(random, spots.diameter);
    const double melanin = sample_span(random, spots.melanin);
    const double stretch = 1.0 + 0.25 * random.uniform(),
                 turn = std::numbers::pi * random.uniform();
    const Noise ragged(seed + 1 + static_cast<std::uint64_t>(i), 1.3 * radius);
    const double rim = std::min(spots.rim, 2.0 / 3.0 * radius);
    grid.within(middle, 2.0 * radius + rim, [&](std::size_t texel, CanvasPoint p) {
      const double dx = p.x - middle.x, dy = p.y - middle.y;
      const double along = dx * std::cos(turn) + dy * std::sin(turn);
      const double aside = dy * std::cos(turn) - dx * std::sin(turn);
      const double distance = std::hypot(along / stretch, aside * stretch);
      const double unevenness = ragged(p);
      const double inside = radius * (1.0 + 0.15 * unevenness) - distance;
      const double dark = melanin * std::max(0.0, 1.0 + 0.2 * unevenness);
      added[texel] = std::max(added[texel], dark * smooth_step(0.5 + 0.5 * inside / rim));
    });
  }
  for (std::size_t i = 0; i < added.size(); ++i)
    mix_in(canvas.skin[i].melanin, canvas.skin[i].melanin_blend, added[i], spots.melanin_blend);
}

/// Draws vessels into a map of their blood, 1 in the middle of one at no depth.
class VeinPen {
 public:
  VeinPen(const CanvasGrid& grid, Random& random, std::vector<double>& blood)
      : grid_(grid), random_(random), blood_(blood) {}

  /// One vessel from a point on, and its branches.
  void draw(CanvasPoint p, double direction, double diameter, double depth, int branches,
            int levels) {
    const double reach = 1.2 * std::hypot(grid_.across(), grid_.down());
    double heading = direction, bend = 0.0;
    int left = levels > 0 ? branches : 0;
    for (double s = 0.0; s < reach;) {
      const double step = 0.25 * diameter;
      s += step;
      // Winding, but on its way: a spring pulls it back to where it headed.
      bend = 0.95 * bend + 0.4 * (random_.uniform() - 0.5) * std::sqrt(step);
      direction += (bend - 0.08 * (direction - heading)) * step;
      p = {p.x + step * std::cos(direction), p.y + step * std::sin(direction)};
      dot(p, diameter, depth);
      if (left == 0 || random_.uniform() > branches_per_mm * step) continue;
      --left;
      const VesselFork fork = sample_fork(diameter, random_);
      const double side = random_.uniform() < 0.5 ? 1.0 : -1.0;
      draw(p, direction + side * fork.narrow_angle, fork.narrow, depth,
           branches_of_branch(branches), levels - 1);
      diameter = fork.wide;
      direction -= side * fork.wide_angle;
      heading -= side * fork.wide_angle;
    }
  }

 private:
  static constexpr double branches_per_mm = 0.08;

  /// Across a tube the chord falls off like a Gaussian of a fourth of the diameter; light spreads
  /// by about half the depth on its way up.
  void dot(CanvasPoint p, double diameter, double depth) {
    const double spread = std::hypot(0.25 * diameter, 0.5 * depth);
    const double most = 0.25 * diameter / spread;
    grid_.within(p, 3.0 * spread, [&](std::size_t texel, CanvasPoint at) {
      const double d2 = (at.x - p.x) * (at.x - p.x) + (at.y - p.y) * (at.y - p.y);
      blood_[texel] = std::max(blood_[texel], most * std::exp(-0.5 * d2 / (spread * spread)));
    });
  }

  const CanvasGrid& grid_;
  Random& random_;
  std::vector<double>& blood_;
};

void apply_feature(const Veins& veins, std::uint64_t seed, SkinCanvas& canvas) {
  const CanvasGrid& grid = canvas.grid;
  Random random = make_random(seed, 0);
  std::vector<double> blood(grid.size(), 0.0);
  VeinPen pen(grid, random, blood);
  for (int i = 0; i < veins.count; ++i) {
    const double angle = 2.0 * std::numbers::pi * random.uniform();
    const double half = 0.55 * std::hypot(grid.across(), grid.down());
    const double aside = 0.8 * (random.uniform() - 0.5) * std::min(grid.across(), grid.down());
    const CanvasPoint start = {
        0.5 * grid.across() - half * std::cos(angle) - aside * std::sin(angle),
        0.5 * grid.down() - half * std::sin(angle) + aside * std::cos(angle)};
    const double diameter = sample_span(random, veins.diameter),
                 depth = sample_span(random, veins.depth);
    pen.draw(start, angle, diameter, depth, 3, veins.levels);
  }
  for (std::size_t i = 0; i < blood.size(); ++i) {
    SkinParameters& skin = canvas.skin[i];
    mix_in(skin.hemoglobin_dermis, skin.saturation_dermis, veins.hemoglobin * blood[i],
           veins.saturation);
    skin.junction_absorption += veins.absorbance * blood[i];
  }
}

void apply_feature(const Blotches& blotches, std::uint64_t seed, SkinCanvas& canvas) {
  const Noise noise(seed, blotches.size);
  std::vector<double> levels(canvas.grid.size());
  canvas.grid.everywhere([&](std::size_t texel, CanvasPoint p) { levels[texel] = noise(p); });
  std::vector<double> sorted = levels;  // to find the level that so much of the noise exceeds
  std::ranges::sort(sorted);
  const double rim = sorted[static_cast<std::size_t>((1.0 - blotches.coverage) *
                                                     static_cast<double>(sorted.size() - 1))];
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double inside = smooth_step(0.5 + 0.8 * (levels[i] - rim));
    canvas.skin[i].hemoglobin_dermis += inside * blotches.hemoglobin_dermis;
    canvas.skin[i].melanin += inside * blotches.melanin;
  }
}

void apply_feature(const Tattoo& tattoo, std::uint64_t, SkinCanvas& canvas) {
  const double height = tattoo.width * tattoo.image.height / tattoo.image.width;
  canvas.grid.within({tattoo.at[0], tattoo.at[1]}, 0.5 * std::max(tattoo.width, height),
                     [&](std::size_t texel, CanvasPoint p) {
                       absorbance_of(tattoo, canvas.skin[texel]) +=
                           tattoo.absorbance * ink_at(tattoo.image,
                                                      (p.x - tattoo.at[0]) / tattoo.width + 0.5,
                                                      (p.y - tattoo.at[1]) / height + 0.5);
                     });
}

void apply_feature(const PressedDisc& disc, std::uint64_t seed, SkinCanvas& canvas) {
  const Noise ragged(seed, 0.5 * disc.diameter);
  canvas.grid.everywhere([&](std::size_t texel, CanvasPoint p) {
    SkinParameters& skin = canvas.skin[texel];
    const double distance = std::hypot(p.x - disc.at[0], p.y - disc.at[1]);
    const double left = share_left(disc, distance, ragged(p));
    skin.hemoglobin_dermis *= left;
    skin.hemoglobin_epidermis *= left;
  });
}

void apply_feature(const Unevenness& uneven, std::uint64_t seed, SkinCanvas& canvas) {
  const Noise melanin(seed, uneven.melanin_size), blood(seed + 1000, uneven.hemoglobin_size);
  canvas.grid.everywhere([&](std::size_t texel, CanvasPoint p) {
    SkinParameters& skin = canvas.skin[texel];
    skin.melanin *= std::exp(uneven.melanin * melanin(p));
    const double more = std::exp(uneven.hemoglobin * blood(p));
    skin.hemoglobin_dermis *= more;
    skin.hemoglobin_epidermis *= more;
  });
}

/// Maps of what is not the same everywhere, brought into its range.
std::vector<SkinMap> varying_maps(SkinCanvas& canvas) {
  std::vector<SkinMap> maps = varying_numbers(canvas.skin);
  for (SkinMap& map : maps) {
    map.values = make_image(canvas.grid.width, canvas.grid.height, {"Y"});
    for (std::size_t i = 0; i < canvas.skin.size(); ++i)
      map.values.pixels[i] = clamped_number(canvas.skin[i], map);
  }
  return maps;
}

}  // namespace

double& absorbance_of(const Tattoo& tattoo, SkinParameters& skin) {
  if (tattoo.ink.empty()) return skin.junction_absorption;
  const auto ink = std::ranges::find(skin.inks, tattoo.ink, &SkinInk::name);
  if (ink == skin.inks.end()) throw InvalidInput("the skin has no ink \"" + tattoo.ink + "\"");
  return ink->absorbance;
}

float clamped_number(SkinParameters& skin, const SkinMap& map) {
  const auto ranges = skin_parameter_ranges();
  const auto range = std::ranges::find(ranges, map.parameter, &SkinParameterRange::value);
  const bool is_ink = range == ranges.end();
  return float_within(mapped_number(skin, map), is_ink ? 0.0 : range->low,
                      is_ink ? largest_absorbance : range->high);
}

std::vector<SkinMap> varying_numbers(std::span<SkinParameters> skin) {
  std::vector<SkinMap> numbers, varying;
  for (const SkinParameterRange& range : skin_parameter_ranges())
    numbers.push_back({std::string(range.name), range.value, {}});
  for (std::size_t i = 0; i < skin.front().inks.size(); ++i)
    numbers.push_back({"ink_" + ink_name(skin.front(), i), nullptr, {}, i});
  for (SkinMap& map : numbers)
    if (std::ranges::any_of(skin, [&](SkinParameters& one) {
          return mapped_number(one, map) != mapped_number(skin.front(), map);
        }))
      varying.push_back(std::move(map));
  return varying;
}

void mix_in(double& amount, double& composition, double added, double composition_of_it) {
  if (added <= 0.0) return;
  composition = (amount * composition + added * composition_of_it) / (amount + added);
  amount += added;
}

double ink_at(const Image& image, double u, double v) {
  if (!(0.0 <= u && u < 1.0 && 0.0 <= v && v < 1.0)) return 0.0;
  return bilinear_clamped(u * image.width, v * image.height, image.width, image.height)
      .interpolate([&](int x, int y) { return static_cast<double>(*image.at(x, y)); });
}

double share_left(const PressedDisc& disc, double distance, double raggedness) {
  const double rim = (0.15 + 0.3 * disc.refill) * disc.diameter;
  const double inside =
      0.5 * disc.diameter * (1.0 + (0.05 + 0.15 * disc.refill) * raggedness) - distance;
  const double left = 1.0 - disc.share * smooth_step(0.5 + 0.5 * inside / rim);
  if (disc.hyperemia == 0.0) return left;
  const double from_ring = inside / disc.diameter + 0.2;
  return left * (1.0 + disc.hyperemia * std::exp(-from_ring * from_ring / (0.15 * 0.15)));
}

std::vector<SkinMap> make_skin_maps(const SkinMapRecipe& recipe, const Progress& progress) {
  const CanvasGrid grid{recipe.width, recipe.height, recipe.mm_per_texel};
  SkinCanvas canvas{grid, std::vector<SkinParameters>(grid.size(), recipe.base.skin)};
  std::uint64_t seed = recipe.seed * 1'000'003u;
  double done = 0.0;
  for (const SkinFeature& feature : recipe.features) {
    std::visit([&](const auto& each) { apply_feature(each, seed, canvas); }, feature);
    seed += 10'007;
    report_or_throw(progress, ++done / static_cast<double>(recipe.features.size()));
  }
  return varying_maps(canvas);
}

}  // namespace lamina
