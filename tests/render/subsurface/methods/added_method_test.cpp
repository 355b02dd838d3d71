// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How to add a method of subsurface transport: a class, a row of the table, and how it is made.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/render/render.h"
#include "lamina/render/subsurface/leaving_fraction.h"
#include "lamina/render/subsurface/methods/make_methods.h"
#include "lamina/scene/description/method_settings.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// All light leaves where it entered.
template <int N>
class WhiteTransport final : public SubsurfaceMethod<N> {
 public:
  [[nodiscard]] BandValues<N> leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                               PixelSamples& samples) const override {
    return leaving_fraction(exit, false) * light.entering_irradiance(exit.point, samples);
  }
  [[nodiscard]] BandValues<N> local_reflectance(const SurfacePoint& /*point*/) const override {
    return BandValues<N>::filled(1.0f);
  }
};

constexpr SubsurfaceMethodInfo white_info = {.name = "white",
                                             .how = "lets all light leave where it entered",
                                             .noise = "falls with samples",
                                             .error = "all that is below the surface",
                                             .honours = {"thickness"}};
constexpr SceneMethod white(white_info);

const SubsurfaceMethodMaker make_white(white, []<int N>(const MethodContext<N>& context) {
  return make_for_each_material(
      context, [](std::uint32_t /*material*/) { return std::make_unique<WhiteTransport<N>>(); });
});

TEST(AddedMethod, IsInHelpTableAndSchema) {
  const auto methods = subsurface_methods(std::span(&white_info, 1));
  EXPECT_NE(describe_methods(methods).find("; white lets all light leave where it entered"),
            std::string::npos);
  EXPECT_NE(methods_table(methods).find("\n| `white` | lets all light leave where it entered | "
                                        "falls with samples | all that is below the surface | – |"),
            std::string::npos);
  EXPECT_NE(methods_schema(methods).find(R"("random_walk", "white"])"), std::string::npos);
  EXPECT_EQ(find_method("white", methods), white);
  EXPECT_EQ(find_method("white", subsurface_methods()), std::nullopt);
}

TEST(AddedMethod, IsNamedByASceneFileAndRefusesWhatItDoesNotHonour) {
  const fs::path folder = fs::path(testing::TempDir()) / "added_method";
  fs::create_directories(folder);
  const auto load = [&](const std::string& key) {
    std::ofstream(folder / "scene.json") << R"({"lamina": "scene", "version": 1, "mm_per_unit": 1,
      "camera": {"position": [0, 0, 10], "look_at": [0, 0, 0]},
      "materials": {"ball": {"subsurface": "marble")" +
                                                key + R"(}},
      "meshes": [{"shape": "sphere", "radius": 2, "material": "ball"}], "lights": [],
      "render": {"method": "white"}})";
    return load_scene(folder / "scene.json", {}, {}, std::span(&white_info, 1));
  };
  EXPECT_EQ(load("").render.method, white);
  EXPECT_NO_THROW(require_honoured(load(R"(, "thickness": 2)")));
  EXPECT_THROW(require_honoured(load(R"(, "color": 0.5)")), InvalidInput);
  EXPECT_THROW((void)load_scene(folder / "scene.json"), InvalidInput);
}

// In even light it shows just that light.
TEST(AddedMethod, Renders) {
  Scene scene = translucent_scene(white, make_plate(100.0f, 10.0f),
                                  half_space({0.1, 0.1, 0.1}, 2.0, 1.4), EnvironmentLight{});
  scene.render.samples_per_pixel = 256;
  EXPECT_THROW((void)render(scene), InvalidInput);  // nobody has said how it is made
  const RenderResult result = render(scene, {.more_methods = {&make_white}});
  EXPECT_EQ(result.statistics.method, white);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean_of(result.image, c), 1.0, 0.01);
}

TEST(AddedMethod, EveryRowOfTheTableIsMade) {
  std::vector<SceneMethod> made;
  for (const SubsurfaceMethodMaker& maker : subsurface_method_makers())
    made.push_back(maker.method);
  EXPECT_EQ(made, subsurface_methods());
}

}  // namespace
}  // namespace lamina
