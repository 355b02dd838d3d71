// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/ocio_view.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/image/scratch_folder.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"

namespace lamina {
namespace {

/// Views whose transforms have closed forms.
constexpr const char* studio = R"(ocio_profile_version: 2
search_path: ""
roles: {default: raw, scene_linear: lin_rec709}
displays:
  Monitor:
    - !<View> {name: Half, colorspace: half}
    - !<View> {name: Gamma, colorspace: gamma}
  Projector:
    - !<View> {name: Double, colorspace: double}
colorspaces:
  - !<ColorSpace> {name: raw, isdata: true}
  - !<ColorSpace> {name: lin_rec709}
  - !<ColorSpace>
    name: half
    from_scene_reference: !<MatrixTransform> {matrix: [.5, 0, 0, 0, 0, .5, 0, 0, 0, 0, .5, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: double
    from_scene_reference: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: gamma
    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1], direction: inverse}
)";

/// One that knows ACES2065-1, its reference, and shows it as it is.
constexpr const char* aces = R"(ocio_profile_version: 2
search_path: ""
roles: {default: AP0, scene_linear: AP0, aces_interchange: AP0}
displays:
  Monitor:
    - !<View> {name: As it is, colorspace: AP0}
colorspaces:
  - !<ColorSpace> {name: AP0}
)";

class OcioViewTest : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    try {
      (void)OcioView({.config = write("aces.ocio", aces)});
    } catch (const InvalidInput& error) {
      GTEST_SKIP() << error.what();
    }
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
};

/// The code values in the PNG of a picture seen through a view.
std::vector<double> codes(const OcioView& view, const Image& image, double exposure = 0.0) {
  const Image stored =
      decode_image(encode_png(view.see(image, exposure)), "seen.png", ColorEncoding::linear);
  return {stored.pixels.begin(), stored.pixels.end()};
}

Image gray_ramp() {
  Image image = make_image(3, 1, {"R", "G", "B", "A", "depth.Z"});
  image.pixels = {.25f, .5f, 1, 1, 7, 0, .1f, .2f, .5f, 7, 4, -1, NAN, 1, 7};
  return image;
}

TEST_F(OcioViewTest, CodeValuesOfThePngAreThoseOfTheView) {
  const std::string config = write("studio.ocio", studio);
  const OcioView half({.config = config});  // the first one of each
  EXPECT_EQ(half.display() + " " + half.view(), "Monitor Half");
  const OcioView gamma({.config = config, .view = "Gamma"});
  const OcioView twice({.config = config, .display = "Projector"});
  constexpr double step = 0.5 / 255.0 + 1e-6;
  const std::vector<double> expected_half = {.125, .25, .5, 1, 0, .05, .1, .5, 1, 0, 0, 1};
  const std::vector<double> expected_gamma = {
      .5, std::sqrt(.5), 1, 1, 0, std::sqrt(.1), std::sqrt(.2), .5, 1, 0, 0, 1};
  const std::vector<double> expected_twice = {.5, 1, 1, 1, 0, .2, .4, .5, 1, 0, 0, 1};
  for (const auto& [view, expected, stops] : {std::tuple{&half, &expected_half, 0.0},
                                              {&gamma, &expected_gamma, 0.0},
                                              {&twice, &expected_twice, 0.0},
                                              {&twice, &expected_half, -2.0}}) {
    const std::vector<double> found = codes(*view, gray_ramp(), stops);
    ASSERT_EQ(found.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) {
      const double wanted = i == 8 && stops < 0.0 ? 1.0 : (*expected)[i];
      EXPECT_NEAR(found[i], wanted, step) << view->view() << ' ' << i;
    }
  }
}

// Of Rec.709's red, what ACES's own tools print.
TEST_F(OcioViewTest, LightEntersByAces2065WhereTheConfigKnowsNoRec709) {
  const OcioView view({.config = write("aces.ocio", aces)});
  Image red = make_image(1, 1, {"R", "G", "B"});
  red.pixels = {1, 0, 0};
  const std::vector<double> found = codes(view, red);
  for (const auto& [c, expected] : {std::pair{0, .4396}, {1, .0898}, {2, .0175}})
    EXPECT_NEAR(found[static_cast<std::size_t>(c)], expected, 0.5 / 255.0 + 1e-4);
}

std::string refusal(const OcioChoice& choice) {
  try {
    (void)OcioView(choice);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_F(OcioViewTest, RefusesInOneLine) {
  const std::string config = write("studio.ocio", studio);
  EXPECT_EQ(refusal({.config = config, .view = "Gama"}),
            config +
                ": the view of Monitor must be one of Half, Gamma, but is Gama; did you mean "
                "\"Gamma\"?");
  EXPECT_EQ(refusal({.config = config, .display = "TV"}),
            config + ": the display must be one of Monitor, Projector, but is TV");
  const std::string unknown =
      write("unknown.ocio",
            "ocio_profile_version: 2\nroles: {default: x}\ndisplays:\n  M:\n    - "
            "!<View> {name: V, colorspace: x}\ncolorspaces:\n  - !<ColorSpace> "
            "{name: x}\n");
  EXPECT_NE(refusal({.config = unknown}).find("has no linear Rec.709"), std::string::npos);
  for (const std::string& broken :
       {path("none.ocio").string(), write("text.ocio", "no config\n"), write("empty.ocio", "")}) {
    const std::string message = refusal({.config = broken});
    EXPECT_EQ(message.find(broken + ": cannot be read by OpenColorIO: "), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace lamina
