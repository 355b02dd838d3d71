// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/image.h"
#include "lamina/base/io/npz_bytes.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"

namespace lamina::detail {
namespace {

/// Angles in degrees: 0, step, ... up to last.
std::vector<double> degrees(double step, double last) {
  std::vector<double> angles;
  for (int i = 0; i * step <= last; ++i) angles.push_back(i * step);
  return angles;
}

std::vector<double> radians(std::vector<double> angles) {
  for (double& angle : angles) angle *= std::numbers::pi / 180.0;
  return angles;
}

/// The BSDF over angles, per channel.
struct BsdfGrid {
  std::vector<double> theta_i, theta_o, phi_o;  ///< [deg]
  std::vector<double> brdf, btdf;               ///< [theta_i][theta_o][phi_o][channel]
  std::vector<double> unscattered_reflectance, unscattered_transmittance;  ///< [theta_i][channel]
  double largest_error = 0.0;
};

BsdfGrid bsdf_grid(const ExportInput& input) {
  BsdfGrid grid{
      .theta_i = degrees(15.0, 75.0), .theta_o = degrees(5.0, 85.0), .phi_o = degrees(15.0, 180.0)};
  std::vector<LayerStack> smooth;
  for (const LayerStack& stack : input.stacks) smooth.push_back(with_smooth_ends(stack));
  const std::vector<double> theta_o = radians(grid.theta_o), phi_o = radians(grid.phi_o);
  const std::vector<double> theta_i = radians(grid.theta_i);
  const std::size_t bands = smooth.size(), size = theta_o.size() * phi_o.size();
  for (std::size_t i = 0; i < theta_i.size(); ++i) {
    constexpr double accuracy = 0.005;
    const std::vector<StackBsdf> solved =
        stack_bsdf(smooth, theta_i[i], theta_o, phi_o,
                   {.accuracy = accuracy, .progress = of_unknown_length(input.options.progress)});
    std::vector<double> reflected(size * bands), transmitted(size * bands), mirrored, passed;
    for (std::size_t b = 0; b < bands; ++b) {
      for (std::size_t o = 0; o < size; ++o) {
        reflected[o * bands + b] = solved[b].brdf[o];
        transmitted[o * bands + b] = solved[b].btdf[o];
      }
      mirrored.push_back(solved[b].unscattered_reflectance);
      passed.push_back(solved[b].unscattered_transmittance);
      grid.largest_error = std::max(grid.largest_error, solved[b].estimated_error);
    }
    const auto append = [&](std::vector<double>& to, const std::vector<double>& of_bands) {
      const std::vector<double> values = to_channels(input.channels, of_bands);
      to.insert(to.end(), values.begin(), values.end());
    };
    append(grid.brdf, reflected);
    append(grid.btdf, transmitted);
    append(grid.unscattered_reflectance, mirrored);
    append(grid.unscattered_transmittance, passed);
  }
  return grid;
}

std::vector<std::string> image_channels(const Channels& channels) {
  std::vector<std::string> names = channels.names;
  if (!channels.wavelengths.empty())
    for (std::string& name : names) name += "nm";
  return names;
}

ExportedFile image_file(const ExportInput& input, const std::string& name, int width, int height,
                        const std::vector<double>& values, const std::string& meaning) {
  Image image = make_image(width, height, image_channels(input.channels));
  for (std::size_t i = 0; i < values.size(); ++i) image.pixels[i] = static_cast<float>(values[i]);
  const std::vector<std::byte> bytes = encode_exr(
      image, ExrPrecision::single_float, std::vector<ImageNote>{{"laminaMeaning", meaning}});
  return {input.stem + name,
          std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())};
}

std::string profile_csv(const ExportInput& input, const std::vector<std::string>& lines) {
  const Profile& profile = input.light->profile;
  std::string text = comment(lines, "# ") + "r_mm";
  for (const char* const side : {"R_", "T_"})
    for (const std::string& channel : input.channels.names)
      text += std::string(",") + side + channel;
  text += "\n";
  for (std::size_t i = 0; i < profile.r.size(); ++i) {
    text += number_text(profile.r[i]);
    for (std::size_t c = 0; c < profile.bands; ++c)
      text += "," + number_text(profile.reflectance_at(i, c));
    for (std::size_t c = 0; c < profile.bands; ++c)
      text += "," + number_text(profile.transmittance_at(i, c));
    text += "\n";
  }
  return text;
}

}  // namespace

ExportedMaterial write_table(const ExportInput& input) {
  const Profile& profile = input.light->profile;
  const BsdfGrid grid = bsdf_grid(input);
  const std::size_t channels = input.channels.size(), radii = profile.r.size();
  ExportedMaterial result;
  const double profile_error = *std::ranges::max_element(input.light->mean_error);
  result.notes.push_back("estimated errors: of the profile " + printf_text("%.2g", profile_error) +
                         " on average, of the BSDF " + printf_text("%.2g", grid.largest_error) +
                         " at most, relative");
  if (!std::ranges::all_of(input.stacks, [](const LayerStack& s) { return is_smooth(s); }))
    result.notes.emplace_back(
        "the upper and the lowest boundary are smooth in the table; their roughness is that of the "
        "target's surface");
  const std::vector<std::size_t> angles{grid.theta_i.size(), grid.theta_o.size(), grid.phi_o.size(),
                                        channels};
  std::vector<NpzArray> arrays{
      {"r_mm", {radii}, profile.r},
      {"reflectance_profile", {radii, channels}, profile.reflectance_profile},
      {"transmittance_profile", {radii, channels}, profile.transmittance_profile},
      {"total_reflectance", {channels}, profile.total_reflectance},
      {"total_transmittance", {channels}, profile.total_transmittance},
      {"theta_i_deg", {grid.theta_i.size()}, grid.theta_i},
      {"theta_o_deg", {grid.theta_o.size()}, grid.theta_o},
      {"phi_o_deg", {grid.phi_o.size()}, grid.phi_o},
      {"brdf", angles, grid.brdf},
      {"btdf", angles, grid.btdf},
      {"unscattered_reflectance", {grid.theta_i.size(), channels}, grid.unscattered_reflectance},
      {"unscattered_transmittance",
       {grid.theta_i.size(), channels},
       grid.unscattered_transmittance}};
  if (!input.channels.wavelengths.empty())
    arrays.push_back({"wavelengths_nm", {channels}, input.channels.wavelengths});
  result.files.push_back({input.stem + ".npz", npz_bytes(arrays)});
  std::vector<std::string> lines = head_lines(input, "tables");
  lines.emplace_back(
      "R and T at distance r from a point of diffuse light, in 1/mm^2 per arriving flux");
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  result.files.push_back({input.stem + "_profile.csv", profile_csv(input, lines)});
  std::vector<double> both = profile.reflectance_profile;
  both.insert(both.end(), profile.transmittance_profile.begin(),
              profile.transmittance_profile.end());
  result.files.push_back(image_file(
      input, "_profile.exr", static_cast<int>(radii), 2, both,
      "row 0 R(r), row 1 T(r) in 1/mm^2; r in a geometric series from " +
          number_text(profile.r.front()) + " to " + number_text(profile.r.back()) + " mm"));
  result.files.push_back(image_file(
      input, "_brdf.exr", static_cast<int>(grid.theta_o.size() * grid.phi_o.size()),
      static_cast<int>(grid.theta_i.size()), grid.brdf,
      "BRDF in 1/sr; rows theta_i from 0 by 15 degrees; columns theta_o from 0 by 5, in each phi_o "
      "from 0 (forward) by 15"));
  return result;
}

}  // namespace lamina::detail
