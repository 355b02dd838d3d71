// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/thin_sheet.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/albedo_inversion/renderer_albedos.h"
#include "lamina/solve/albedo_inversion/subsurface_color.h"

// Names and meanings: [OpenPBR] 1.1.1 and the node open_pbr_surface of MaterialX 1.39.

namespace lamina::detail {
namespace {

/// An identifier of MaterialX: letters, digits and '_', no digit first.
std::string node_name(std::string stem) {
  std::ranges::replace(stem, '-', '_');
  if (stem.front() >= '0' && stem.front() <= '9') stem.insert(0, 1, '_');
  return stem;
}

class Inputs {
 public:
  void add(const std::string& name, double value) { add(name, "float", number_text(value)); }
  void add(const std::string& name, std::span<const double> color) {
    add(name, "color3", numbers_text(color, ", "));
  }
  void add_flag(const std::string& name, bool value) {
    add(name, "boolean", value ? "true" : "false");
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(const std::string& name, const char* type, const std::string& value) {
    text_ += "    <input name=\"" + name + "\" type=\"" + type + "\" value=\"" + value + "\"/>\n";
  }
  std::string text_;
};

/// The colors that media have by a rule.
template <class Rule>
std::vector<double> colors_of(const HomogeneousFit& fit, const Rule& rule) {
  std::vector<double> colors;
  for (const Medium& medium : fit.media) colors.push_back(rule(albedo(medium)));
  return colors;
}

std::string colors_text(const std::vector<double>& colors) {
  std::string text;
  for (const double color : colors) text += (text.empty() ? "" : ", ") + printf_text("%.5f", color);
  return text;
}

/// The medium below the surface.
void add_medium(Inputs& to, const HomogeneousFit& fit, const std::vector<double>& colors,
                double mm_per_unit) {
  double longest = 0.0;
  for (const Medium& medium : fit.media) longest = std::max(longest, mfp(medium));
  std::vector<double> scales;
  for (const Medium& medium : fit.media) scales.push_back(mfp(medium) / longest);
  to.add("subsurface_color", colors);
  to.add("subsurface_radius", longest / mm_per_unit);
  to.add("subsurface_radius_scale", scales);
  to.add("subsurface_scatter_anisotropy", fit.g());
}

}  // namespace

ExportedMaterial write_openpbr(const ExportInput& input) {
  const HomogeneousFit& fit = *input.fit;
  require_rgb(input, "openpbr");
  const double eta = fit.ior() / fit.ior_above, mm_per_unit = input.options.mm_per_unit;
  const double enters = 1.0 - fresnel_diffuse(eta);
  ExportedMaterial result{.notes = {"not tested in a renderer; its names are of OpenPBR 1.1.1"},
                          .misfits = fit.misfits};
  std::vector<std::string> lines = head_lines(input, "OpenPBR 1.1.1 in MaterialX 1.39");
  std::vector<double> base;
  for (const ChannelMisfit& misfit : fit.misfits)
    base.push_back(std::clamp(misfit.reflectance.wanted_total / enters, 0.0, 1.0));
  Inputs inputs;
  inputs.add("base_weight", 1.0);
  inputs.add("base_color", base);
  inputs.add("specular_weight", 1.0);
  inputs.add("specular_ior", eta);
  inputs.add("specular_roughness", std::sqrt(fit.top.roughness));
  inputs.add("subsurface_weight", 1.0);
  if (fit.is_thin()) {
    const ThinSheet sheet = make_thin_sheet(*input.light, enters);
    result.misfits = sheet.misfits;
    result.notes.emplace_back(
        "thin-walled: R and T have one color between them, in parts by "
        "subsurface_scatter_anisotropy; for two colors use a closed sheet and the medium in "
        "pbrt-v4 or mitsuba3");
    inputs.add("subsurface_color", sheet.colors);
    inputs.add("subsurface_scatter_anisotropy", sheet.forward);
  } else {
    const HalfSpaceLook look{.ior = eta, .g = fit.g(), .top = fit.top};
    const std::vector<double> colors = colors_of(
        fit, [&](double of) { return subsurface_color(SubsurfaceColor::openpbr, of, look); });
    const std::vector<double> printed =
        colors_of(fit, [&](double of) { return van_de_hulst_color(of, fit.g()); });
    add_medium(inputs, fit, colors, mm_per_unit);
    lines.push_back("subsurface_radius times its scale is the mean free path, in scene units of " +
                    number_text(mm_per_unit) + " mm");
    lines.push_back("subsurface_color " + std::string(definition_text(SubsurfaceColor::openpbr)));
    lines.push_back(
        "a renderer that makes the albedo by the formula that OpenPBR 1.1.1 prints as an example, "
        "which ignores the boundary, wants the color " +
        colors_text(printed));
  }
  inputs.add_flag("geometry_thin_walled", fit.is_thin());
  for (const std::string& line : misfit_lines(result.misfits)) lines.push_back(line);
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  const std::string name = node_name(input.stem);
  std::string text = "<?xml version=\"1.0\"?>\n" + xml_comment(lines);
  text += "<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n";
  text += "  <open_pbr_surface name=\"" + name + "_surface\" type=\"surfaceshader\">\n" +
          inputs.text() + "  </open_pbr_surface>\n";
  text += "  <surfacematerial name=\"" + name +
          "\" type=\"material\">\n    <input name=\"surfaceshader\" type=\"surfaceshader\" "
          "nodename=\"" +
          name + "_surface\"/>\n  </surfacematerial>\n</materialx>\n";
  result.files.push_back({input.stem + ".mtlx", std::move(text)});
  return result;
}

}  // namespace lamina::detail
