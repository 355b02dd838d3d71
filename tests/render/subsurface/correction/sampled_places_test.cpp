// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/sampled_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "lamina/render/subsurface/correction/corrected_transport.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

/// Light that leaves by a formula of the place and a random number in [0, 1).
class LightByFormula final : public SubsurfaceMethod<4> {
 public:
  using Formula = std::function<float(const Vec3f&, float)>;
  explicit LightByFormula(Formula formula) : formula_(std::move(formula)) {}
  [[nodiscard]] BandValues<4> leaving_radiance(const ExitPoint& exit, const LightGatherer<4>&,
                                               PixelSamples& samples) const override {
    return BandValues<4>::filled(formula_(exit.point.position, samples.next_1d()));
  }
  [[nodiscard]] BandValues<4> local_reflectance(const SurfacePoint&) const override { return {}; }

 private:
  Formula formula_;
};

class NoLight final : public LightGatherer<4> {
 public:
  [[nodiscard]] BandValues<4> entering_irradiance(const SurfacePoint&,
                                                  PixelSamples&) const override {
    return {};
  }
  [[nodiscard]] BandValues<4> shadow_transmittance(const Ray&, float) const override { return {}; }
  [[nodiscard]] BandValues<4> arriving_radiance(const Ray&, PixelSamples&) const override {
    return {};
  }
};

/// A square of 20 mm, seen from above but for the part below x = -5 mm, and places 1 mm apart on
/// it.
struct SampledSquare {
  static constexpr float unseen_end = -5.0f;

  SampledSquare(const SubsurfaceMethod<4>& planar, const SubsurfaceMethod<4>& walk,
                const std::vector<Vec3f>& eyes = {{0.0f, 0.0f, 60.0f}}, float seen_from = unseen_end)
      : methods{planar, walk, BandValues<4>::filled(1.0f), 1.3f, 3},
        scene(make_scene()),
        render_scene(scene),
        camera(scene.camera, 8, 8),
        cache(render_scene, options),
        with{render_scene, light, camera, seen, cache, progress, report},
        places(render_scene, 0, 1.0f, methods, see(seen_from), eyes) {}

  static Scene make_scene() {
    Scene scene;
    scene.camera = camera_above(60.0);
    scene.materials = {
        {.name = "skin", .surface = SubsurfaceSurface{.material = find_material("jensen_skin1")}}};
    scene.meshes = {make_square(20.0f)};
    return scene;
  }
  const Preparation<4>& see(float from) {
    seen.points.resize(1);
    for (float y = -10.0f; y <= 10.0f; y += 0.5f)
      for (float x = from; x <= 10.0f; x += 0.5f) {
        SurfacePoint point{};
        point.position = {x, y, 0.0f};
        point.smooth_normal = {0.0f, 0.0f, 1.0f};
        seen.points[0].push_back(point);
      }
    return with;
  }

  SampledPlaces<4>::Methods methods;
  Scene scene;
  RenderScene render_scene;
  NoLight light;
  CameraRays camera;
  SeenSurface seen;
  RenderOptions options;
  LightCache cache;
  Progress progress;
  PreparationReport report;
  Preparation<4> with;
  SampledPlaces<4> places;
};

// Four times as bright on the right: twice as many samples there, few of what is not seen, and none
// far from what is. With the area of the places they count as the same light as even ones.
TEST(SampledPlaces, TakesMoreSamplesWhereItIsBrightAndFewWhereNobodyLooks) {
  const auto brightness = [](const Vec3f& at, float) { return at.x < 2.5f ? 1.0f : 4.0f; };
  const LightByFormula planar(brightness), walk(brightness);
  SampledSquare square(planar, walk);
  ASSERT_TRUE(square.places.sample(60.0, {}));
  const auto areas = std::vector(square.places.areas());
  const auto at = std::vector(square.places.places());
  const auto samples = square.places.samples(0.0f);
  double seen_area = 0.0, count = 0.0, seen = 0.0, light = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const float x = at[i].at.position.x;
    EXPECT_GT(x, SampledSquare::unseen_end - 4.5f);
    if (x < SampledSquare::unseen_end - 1.5f) {
      EXPECT_EQ(areas[i], 0.0f);
      EXPECT_EQ(samples[i].size(), 20u);
    } else if (x > SampledSquare::unseen_end + 0.5f) {
      EXPECT_GT(areas[i], 0.0f);
      if (std::abs(x - 2.5f) > 1.0f) {
        EXPECT_NEAR(static_cast<double>(samples[i].size()), x < 2.5f ? 40.0 : 80.0, 4.0);
      }
    }
    seen_area += areas[i];
    if (areas[i] > 0.0f) {
      ++seen;
      count += static_cast<double>(samples[i].size());
    }
    for (const auto& sample : samples[i]) light += sample.walked[0];
  }
  EXPECT_NEAR(count / seen, 60.0, 2.0);
  EXPECT_NEAR(seen_area, 20.0 * (10.0 - SampledSquare::unseen_end), 30.0);
  EXPECT_NEAR(light, 20.0 * (2.5 + 4.0 - SampledSquare::unseen_end + 7.5 * 4.0), 0.02 * 830.0);
}

// Walks of twice the light, evenly between none and double that: a standard deviation of 1/sqrt(3).
TEST(SampledPlaces, KnowsHowNoisyWalksAre) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  const LightByFormula walk([](const Vec3f&, float random) { return 4.0f * random; });
  SampledSquare square(planar, walk);
  ASSERT_TRUE(square.places.sample(16.0, {}));
  const std::size_t first = square.places.sample_count();
  EXPECT_NEAR(square.places.noise(), std::numbers::inv_sqrt3, 0.02);
  ASSERT_TRUE(square.places.sample(32.0, {}));  // those there are count
  EXPECT_NEAR(static_cast<double>(square.places.sample_count()), 2.0 * static_cast<double>(first),
              0.2 * static_cast<double>(first));
}

// A quarter of the square is dark to the planar method; all of it counts as a tenth of the mean
// more.
TEST(SampledPlaces, CountsPlanarLightAsMoreEvenly) {
  const LightByFormula planar([](const Vec3f& at, float) { return at.x < 5.0f ? 1.0f : 0.0f; });
  SampledSquare square(planar, planar);
  ASSERT_TRUE(square.places.sample(16.0, {}));
  const float exitance = square.places.exitance_of_mean(0.1f);
  EXPECT_GT(exitance, 0.0f);
  double raised = 0.0, walked = 0.0;
  for (const auto& of_place : square.places.samples(exitance))
    for (const auto& sample : of_place) {
      raised += sample.planar[0];
      walked += sample.walked[0];
    }
  EXPECT_NEAR(raised / walked, 1.1, 1e-3);

  const LightByFormula dark([](const Vec3f&, float) { return 0.0f; });
  SampledSquare night(dark, dark);
  ASSERT_TRUE(night.places.sample(4.0, {}));
  EXPECT_EQ(night.places.noise(), 0.0);
  EXPECT_EQ(night.places.exitance_of_mean(0.1f), 0.0f);
}

/// How a fit does with planar light that counts as so much of its mean more.
SampledPlaces<4>::Assessment assess(const SampledSquare& square, float more_of_mean) {
  const float exitance = square.places.exitance_of_mean(more_of_mean);
  const auto fit = fit_correction<4>(PlaceGraph(square.places.places()), square.places.areas(),
                                     square.places.samples(exitance), 3);
  return square.places.assess(fit, exitance);
}

// Stripes narrower than places: as dark as a third and as bright as three.
TEST(SampledPlaces, TellWhetherDetailOfThePlanarLightIsRight) {
  const auto striped = [](const Vec3f& at) {
    return std::exp(std::log(3.0f) * std::sin(12.0f * at.y));
  };
  const auto noise = [](float random) { return 0.5f + random; };
  const LightByFormula planar([&](const Vec3f& at, float) { return striped(at); });
  const LightByFormula smooth([&](const Vec3f&, float random) { return 2.0f * noise(random); });
  const LightByFormula doubled(
      [&](const Vec3f& at, float random) { return 2.0f * noise(random) * striped(at); });
  SampledSquare wrong(planar, smooth), right(planar, doubled);
  ASSERT_TRUE(wrong.places.sample(32.0, {}));
  ASSERT_TRUE(right.places.sample(32.0, {}));
  EXPECT_LT(assess(wrong, 1.0f).left, assess(wrong, 0.01f).left - 0.05);
  EXPECT_LT(assess(right, 0.01f).left, assess(right, 1.0f).left - 0.05);
  const auto share_better = [](const SampledSquare& square) {
    const auto better =
        assess(square, 1.0f)
            .is_better_than(assess(square, 0.01f), PlaceGraph(square.places.places()));
    return static_cast<double>(std::ranges::count(better, true)) /
           static_cast<double>(better.size());
  };
  EXPECT_GT(share_better(wrong), 0.95);
  EXPECT_LT(share_better(right), 0.05);
  // What is added is half of what there is then.
  EXPECT_NEAR(assess(right, 0.01f).change, 0.5, 0.05);
}

// Of a row of places the left third is better, the right third by chance: every other one.
TEST(SampledPlaces, TakeNoFitForBetterByChance) {
  std::vector<PlaceGraph::Place> places;
  for (int i = 0; i < 90; ++i)
    places.push_back({{{static_cast<float>(i), 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}}, 1.0f});
  SampledPlaces<4>::Assessment before{.left_at = std::vector(places.size(), 0.0)}, after = before;
  for (std::size_t i = 0; i < 30; ++i) after.left_at[i] = -1.0;
  for (std::size_t i = 60; i < 90; ++i) after.left_at[i] = i % 2 == 0 ? -1.0 : 1.0;
  const std::vector<bool> is_better = after.is_better_than(before, PlaceGraph(places));
  for (std::size_t i = 0; i < 90; ++i) {
    if (i < 28 || (i > 38 && i < 54) || i > 66) {
      EXPECT_EQ(is_better[i], i < 28) << i;
    }
  }
}

// A fit that follows the noise of each half at each place suits that half best, and the other
// least.
TEST(SampledPlaces, JudgeTheFitToEachHalfByTheOther) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  const LightByFormula walk([](const Vec3f&, float random) { return 4.0f * random; });
  SampledSquare square(planar, walk);
  ASSERT_TRUE(square.places.sample(16.0, {}));
  const auto samples = square.places.samples(0.0f);
  CorrectionFit<4> even, noisy;
  even.shape[0] = BandValues<4>::filled(1.0f);
  DirectionalRatio<4> two{};
  two[0] = BandValues<4>::filled(2.0f);
  even.ratios.assign(samples.size(), two);
  for (auto& of_half : even.of_halves) of_half = even.ratios;
  noisy = even;
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t half = 0; half < 2; ++half) {
      BandValues<4> walked, of_planar;
      for (std::size_t s = half; s < samples[i].size(); s += 2) {
        walked += samples[i][s].walked;
        of_planar += samples[i][s].planar;
      }
      noisy.of_halves[half][i][0] = walked / max(of_planar, BandValues<4>::filled(1e-6f));
    }
  const auto is_better =
      square.places.assess(even, 0.0f)
          .is_better_than(square.places.assess(noisy, 0.0f), PlaceGraph(square.places.places()));
  // By a standard error: chance may hide it at some.
  EXPECT_LT(std::ranges::count(is_better, false), std::ssize(is_better) / 50);
}

// Walks find even light where the planar method has narrow stripes of a third and of three: they
// go.
TEST(CorrectedTransport, TakesDetailAwayThatWalksDoNotFind) {
  const auto striped = [](const Vec3f& at, float) {
    return std::exp(std::log(3.0f) * std::sin(12.0f * at.y));
  };
  const auto noisy = [](const Vec3f&, float random) { return 1.0f + 2.0f * random; };
  const LightByFormula planar(striped);
  SampledSquare square(planar, planar);
  CorrectedTransport<4> corrected(square.render_scene, 0, std::make_unique<LightByFormula>(striped),
                                  std::make_unique<LightByFormula>(noisy));
  ASSERT_TRUE(corrected.prepare(square.with));
  corrected.refine(square.with);
  PixelSamples random(1, 0, 0);
  const float quarter = 0.5f * std::numbers::pi_v<float> / 12.0f;
  for (const float y : {-quarter, quarter}) {
    SurfacePoint point{};
    point.position = {3.0f, y, 0.0f};
    point.normal = point.smooth_normal = point.geometric_normal = {0.0f, 0.0f, 1.0f};
    const Vec3f up{0.0f, 0.0f, 1.0f};
    const ExitPoint exit{point, boundary_at(square.render_scene, point), 1.0f, up};
    EXPECT_NEAR(corrected.leaving_radiance(exit, square.light, random)[0], 2.0f, 0.5f) << y;
  }
}

/// A lamp seen straight through, beside an even light.
class LampBehind final : public SubsurfaceMethod<4> {
 public:
  [[nodiscard]] BandValues<4> leaving_radiance(const ExitPoint&, const LightGatherer<4>&,
                                               PixelSamples&) const override {
    return BandValues<4>::filled(5.0f);
  }
  [[nodiscard]] BandValues<4> scattered_radiance(const ExitPoint&, const LightGatherer<4>&,
                                                 PixelSamples&) const override {
    return BandValues<4>::filled(1.0f);
  }
  [[nodiscard]] BandValues<4> local_reflectance(const SurfacePoint&) const override { return {}; }
};

TEST(SampledPlaces, CountLightThatComesStraightThroughTowardsTheEyeAlone) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  const LampBehind walk;
  SampledSquare for_eye(planar, walk), for_all(planar, walk, {});
  for (const auto& [square, expected] : {std::pair{&for_eye, 5.0f}, {&for_all, 1.0f}}) {
    ASSERT_TRUE(square->places.sample(16.0, {}));
    for (const auto& of_place : square->places.samples(0.0f))
      for (const auto& sample : of_place) {
        ASSERT_GT(sample.planar[0], 0.0f);
        EXPECT_NEAR(sample.walked[0] / sample.planar[0], expected, 1e-3f);
      }
  }
}

TEST(SampledPlaces, LookAtTheEyeThatTheyAreForOrElseAllAround) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  SampledSquare for_eye(planar, planar), for_all(planar, planar, {});
  ASSERT_TRUE(for_eye.places.sample(16.0, {}));
  ASSERT_TRUE(for_all.places.sample(16.0, {}));
  for (const auto& of_place : for_eye.places.samples(0.0f))
    for (const auto& sample : of_place) EXPECT_NEAR(sample.terms[1], 0.71f, 0.05f);  // steep
  EXPECT_GT(for_all.places.places().size(), for_eye.places.places().size() + 10);
  double along = 0.0, count = 0.0;
  for (const auto& of_place : for_all.places.samples(0.0f))
    for (const auto& sample : of_place) {
      along += static_cast<double>(sample.terms[2] * sample.terms[2]);
      ++count;
    }
  EXPECT_NEAR(along / count, 0.25 / (1.3 * 1.3), 0.01);  // sin² cos² in the mean, inside
}

// Walks find twice the light of the planar method. So much is made of it also where places are
// seen by mirrors alone: far from what the camera sees, and at a slant.
TEST(CorrectedTransport, CorrectsWhatTheCameraDoesNotSeeAsMuch) {
  const auto even = [](float light) {
    return std::make_unique<LightByFormula>([light](const Vec3f&, float) { return light; });
  };
  const auto one = even(1.0f);
  SampledSquare square(*one, *one);
  CorrectedTransport<4> corrected(square.render_scene, 0, even(1.0f), even(2.0f));
  ASSERT_TRUE(corrected.prepare(square.with));
  corrected.refine(square.with);
  PixelSamples random(1, 0, 0);
  for (const float x : {-9.9f, 0.0f, 9.0f}) {
    const Vec3f to_eye = normalize(Vec3f{3.0f, 0.0f, 1.0f});
    SurfacePoint point{};
    point.position = {x, 0.0f, 0.0f};
    point.normal = point.smooth_normal = point.geometric_normal = {0.0f, 0.0f, 1.0f};
    const ExitPoint exit{point, boundary_at(square.render_scene, point), to_eye.z, to_eye};
    EXPECT_NEAR(corrected.leaving_radiance(exit, square.light, random)[0], 2.0f, 0.02f) << x;
  }
}

// An eye that has turned by a degree, and sees half a millimetre more: the same places, and walks
// with the same random numbers.
TEST(SampledPlaces, AreThoseOfAnEyeNearby) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  const LightByFormula walk([](const Vec3f&, float random) { return 4.0f * random; });
  const float angle = 0.0175f;
  SampledSquare square(planar, walk),
      turned(planar, walk, {{60.0f * std::sin(angle), 0.0f, 60.0f * std::cos(angle)}},
             SampledSquare::unseen_end - 0.5f);
  ASSERT_TRUE(square.places.sample(32.0, {}));
  ASSERT_TRUE(turned.places.sample(32.0, {}));
  const auto samples = square.places.samples(0.0f), of_turned = turned.places.samples(0.0f);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3f at = square.places.places()[i].at.position;
    if (at.x < SampledSquare::unseen_end) continue;
    const auto found = std::ranges::find(turned.places.keys(), square.places.keys()[i]);
    ASSERT_NE(found, turned.places.keys().end()) << at.x << ' ' << at.y;
    const auto j = static_cast<std::size_t>(found - turned.places.keys().begin());
    EXPECT_EQ(length(turned.places.places()[j].at.position - at), 0.0f);
    if (samples[i].size() != of_turned[j].size()) continue;  // at the end of what is seen
    for (std::size_t s = 0; s < samples[i].size(); ++s)
      EXPECT_EQ(samples[i][s].walked[0], of_turned[j][s].walked[0]);
  }
}

// Two eyes, one from the left and one from the right: each gets half of both halves of the samples.
TEST(SampledPlaces, LookAtSeveralEyesInTurn) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  SampledSquare square(planar, planar, {{-500.0f, 0.0f, 500.0f}, {500.0f, 0.0f, 500.0f}});
  ASSERT_TRUE(square.places.sample(16.0, {}));
  for (const auto& of_place : square.places.samples(0.0f))
    for (std::size_t s = 0; s + 3 < of_place.size(); s += 4) {
      const float first = of_place[s].terms[2] + of_place[s].terms[3];
      EXPECT_GT(std::abs(first), 0.1f);
      EXPECT_EQ(std::signbit(of_place[s + 1].terms[2] + of_place[s + 1].terms[3]),
                std::signbit(first));
      EXPECT_NE(std::signbit(of_place[s + 2].terms[2] + of_place[s + 2].terms[3]),
                std::signbit(first));
    }
}

TEST(SampledPlaces, StopsWhenAskedTo) {
  const LightByFormula planar([](const Vec3f&, float) { return 1.0f; });
  SampledSquare square(planar, planar);
  EXPECT_FALSE(square.places.sample(16.0, [](double) { return false; }));
}

}  // namespace
}  // namespace lamina
