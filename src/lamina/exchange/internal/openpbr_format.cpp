// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/core/number_text.h"
#include "lamina/exchange/albedo_inversion/half_space_color.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/thin_sheet.h"
#include "lamina/exchange/internal/renderer_albedos.h"
#include "lamina/optics/fresnel.h"

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

/// The colors that the media have by OpenPBR's definition, if the table of half-spaces has them.
std::vector<double> colors_by_definition(const HomogeneousFit& fit, double eta) {
  if (!(lowest_look_ior <= eta && eta <= highest_look_ior && lowest_look_g <= fit.g() &&
        fit.g() <= highest_look_g))
    return {};
  const HalfSpaceColor look({.ior = eta, .g = fit.g(), .top = fit.top});
  std::vector<double> colors;
  for (const Medium& medium : fit.media) colors.push_back(look.color(albedo(medium)));
  return colors;
}

std::string colors_text(const std::vector<double>& colors) {
  std::string text;
  for (const double color : colors) text += (text.empty() ? "" : ", ") + printf_text("%.5f", color);
  return text;
}

/// The medium below the surface.
void add_medium(Inputs& to, const HomogeneousFit& fit, double mm_per_unit) {
  double longest = 0.0;
  for (const Medium& medium : fit.media) longest = std::max(longest, mfp(medium));
  std::vector<double> colors, scales;
  for (const Medium& medium : fit.media) {
    colors.push_back(van_de_hulst_color(albedo(medium), fit.g()));
    scales.push_back(mfp(medium) / longest);
  }
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
    add_medium(inputs, fit, mm_per_unit);
    lines.push_back("subsurface_radius times its scale is the mean free path, in scene units of " +
                    number_text(mm_per_unit) + " mm");
    lines.emplace_back(
        "subsurface_color is that from which the formula that OpenPBR 1.1.1 prints makes the "
        "albedo of the medium");
    if (const std::vector<double> colors = colors_by_definition(fit, eta); !colors.empty())
      lines.push_back("by the definition in its text the medium has the color " +
                      colors_text(colors) +
                      ": for a renderer that inverts the definition, use that");
  }
  inputs.add_flag("geometry_thin_walled", fit.is_thin());
  for (const std::string& line : misfit_lines(result.misfits)) lines.push_back(line);
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  const std::string name = node_name(input.stem);
  std::string text = "<?xml version=\"1.0\"?>\n<!--\n" + comment(lines, "  ") + "-->\n";
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
