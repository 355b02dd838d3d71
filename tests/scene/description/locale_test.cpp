// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// A program that uses lamina may write numbers as its user's language does. What lamina writes and
// reads must not follow it.
#include <gtest/gtest.h>

#include <clocale>
#include <filesystem>
#include <functional>
#include <locale>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/compare.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/plot/plot.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/render/subsurface/internal/irradiance_cloud_file.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"
#include "lamina/solve/scattering/monte_carlo/mcml_output.h"

namespace lamina {
namespace {

/// 1.234,5 for C++ streams; for C, too, if the machine has such a locale.
class DecimalComma {
 public:
  DecimalComma() : before_(std::locale::global(std::locale(std::locale::classic(), new Comma))) {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "fr_FR.utf8"})
      if (std::setlocale(LC_ALL, name)) break;
  }
  ~DecimalComma() {
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
  }
  DecimalComma(const DecimalComma&) = delete;
  DecimalComma& operator=(const DecimalComma&) = delete;

 private:
  struct Comma : std::numpunct<char> {
    [[nodiscard]] char do_decimal_point() const override { return ','; }
    [[nodiscard]] char do_thousands_sep() const override { return '.'; }
    [[nodiscard]] std::string do_grouping() const override { return "\3"; }
  };
  std::locale before_;
};

/// What is written is the same in both locales.
void expect_equal_text(const std::string& what, const std::function<std::string()>& written) {
  const std::string expected = written();
  EXPECT_FALSE(expected.empty()) << what;
  const DecimalComma elsewhere;
  EXPECT_EQ(written(), expected) << what;
}

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::vector<IrradianceCloud> clouds() {
  IrradianceCloud cloud{.material = 1234, .bands = 1, .spacing = 0.125f};
  for (int i = 0; i < 1500; ++i) {
    cloud.points.push_back({.position = {0.5f, 1.5f, 2.5f}, .normal = {0, 0, 1}, .area = 0.25f});
    cloud.irradiance.push_back(1.5f);
  }
  return {cloud};
}

McmlRun mcml_run() {
  return parse_mcml(
             "1.0\n1\nx.mco A\n12345\n.01 0.02\n3 2 2\n1\n1.0\n1.37 1.5 100.25 .9 0.125\n1.0\n",
             "x.mci")
      .front();
}

TEST(Locale, DoesNotChangeWhatIsWritten) {
  expect_equal_text(
      "numbers", [] { return number_text(1234.5) + printf_text(" %.2f %12.4E", 1234.5, 1234.5); });
  expect_equal_text("SVG", [] {
    return format_svg(
        {.title = "x", .panels = {{.curves = {{.x = {0.25, 1234.5}, .y = {1e-5, 98765.5}}}}}});
  });
  expect_equal_text("a material", [] { return format_material(find_material("jade")); });
  expect_equal_text("an MCML file", [] {
    const McmlRun run = mcml_run();
    MonteCarloOptions options = monte_carlo_options(run);
    options.photons = 2000;
    return format_mcml(run, trace_photons(layer_stack(run), options), 1234.5);
  });
  expect_equal_text("the names of bands", [] { return band_name(BandSet({1064.5}), 0); });
  expect_equal_text("a comparison", [] { return ImageComparison{.rmse = 0.5}.report(); });
  expect_equal_text("messages", [] {
    return message_of(
               [] { (void)LayerStack({{.medium = {.sigma_a = -1234.5}, .thickness = 1.0}}); }) +
           message_of(
               [] { (void)parse_json("1234.5", "f").root().number({.low = 0.25, .high = 0.75}); });
  });
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "locale_test.ply";
  expect_equal_text("a cloud", [&] {
    save_irradiance_clouds(clouds(), {}, {}, file);
    return read_file_bytes(file);
  });
}

TEST(Locale, DoesNotChangeWhatIsRead) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "locale_test.ply";
  save_irradiance_clouds(clouds(), {}, {}, file);
  const DecimalComma elsewhere;
  const auto read = load_irradiance_clouds(file, {}).clouds;
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].spacing, 0.125f);
  EXPECT_EQ(read[0].points.size(), 1500u);
  EXPECT_EQ(parse_json("1234.5", "f").root().number({}), 1234.5);
  EXPECT_EQ(parse_json("[0.25]", "f").root().array()[0].number({}), 0.25);
  EXPECT_EQ(mcml_run().layers[0].mus, 100.25);
  const PolygonMesh obj = parse_obj("v 0.5 0 1e-400\nv 1.25 0 0\nv 0 1 0\nf 1 2 3\n", "f.obj");
  EXPECT_EQ(obj.positions[0].x, 0.5f);
  EXPECT_EQ(obj.positions[0].z, 0.0f);
  EXPECT_EQ(obj.positions[1].x, 1.25f);
  EXPECT_EQ(rounded_number("-1.5e400"), -HUGE_VAL);
  const PolygonMesh ply = parse_ply(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0.5 0 0\n1.25 0 0\n0 1 0\n3 0 1 2\n",
      "f.ply");
  EXPECT_EQ(ply.positions[1].x, 1.25f);
}

}  // namespace
}  // namespace lamina
