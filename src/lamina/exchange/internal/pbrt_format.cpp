// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/layers/optics/fresnel.h"

// Names and units: the input file format of pbrt-v4. Its facets are of Trowbridge and Reitz, which
// lamina calls ggx.

namespace lamina::detail {
namespace {

/// One statement, a parameter a line.
class Statement {
 public:
  Statement(const std::string& directive, const std::string& name, const std::string& type)
      : text_(directive + " \"" + name + "\"\n    \"string type\" \"" + type + "\"\n") {}

  void add(const std::string& name, double value) {
    text_ += "    \"float " + name + "\" [ " + number_text(value) + " ]\n";
  }
  void add_flag(const std::string& name, bool value) {
    text_ += "    \"bool " + name + "\" " + (value ? "true" : "false") + "\n";
  }
  void add(const std::string& name, const Channels& channels, std::span<const double> values) {
    if (channels.wavelengths.empty()) {
      text_ += "    \"rgb " + name + "\" [ " + numbers_text(values) + " ]\n";
      return;
    }
    constexpr double first = 360.0, last = 830.0;  // [nm], all that pbrt asks for
    text_ += "    \"spectrum " + name + "\" [";
    const auto put = [&](double wavelength, double value) {
      text_ += " " + number_text(wavelength) + " " + number_text(value);
    };
    if (channels.wavelengths.front() > first) put(first, values.front());
    for (std::size_t c = 0; c < values.size(); ++c) put(channels.wavelengths[c], values[c]);
    if (channels.wavelengths.back() < last) put(last, values.back());
    text_ += " ]\n";
  }
  void add_roughness(const Interface& top) {
    if (top.roughness == 0.0) return;
    add("roughness", top.roughness);
    add_flag("remaproughness", false);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

struct Coefficients {
  std::vector<double> sigma_a, sigma_s;
};

void add_coefficients(Statement& to, const Channels& channels, const Coefficients& numbers,
                      double g, double mm_per_unit) {
  to.add("sigma_a", channels, numbers.sigma_a);
  to.add("sigma_s", channels, numbers.sigma_s);
  to.add("scale", mm_per_unit);
  to.add("g", g);
}

/// The Lambertian base that under a smooth boundary returns this fraction of diffuse light.
double base_reflectance(double total, double eta) {
  const double enters = 1.0 - fresnel_diffuse(eta), leaves = 1.0 - fresnel_diffuse(1.0 / eta);
  const double value = total / (enters * leaves + total * (1.0 - leaves));
  return std::clamp(value, 0.0, 1.0);
}

/// The layers as media of their own, to be put between surfaces.
std::string layer_media(const ExportInput& input) {
  std::string text;
  const Channels bands = make_channels(input.material.bands, ExportChannels::bands);
  const std::size_t layers = input.stacks.front().layers().size();
  for (std::size_t l = 0; l < layers; ++l) {
    Coefficients numbers;
    double g = 0.0;
    for (const LayerStack& stack : input.stacks) {
      const Medium& medium = stack.layers()[l].medium;
      numbers.sigma_a.push_back(medium.sigma_a);
      numbers.sigma_s.push_back(medium.sigma_s);
      g += medium.g / static_cast<double>(input.stacks.size());
    }
    const double thickness = input.stacks.front().layers()[l].thickness;
    text += "\n# layer " + std::to_string(l + 1) + ", " + one_line(input.material.layers[l].name) +
            (std::isfinite(thickness)
                 ? ": " + number_text(thickness / input.options.mm_per_unit) + " units thick"
                 : ": all below") +
            ", index " + number_text(input.stacks.front().layers()[l].medium.ior) + "\n";
    Statement medium("MakeNamedMedium", input.stem + "_layer_" + std::to_string(l + 1),
                     "homogeneous");
    add_coefficients(medium, bands, numbers, g, input.options.mm_per_unit);
    text += medium.text();
  }
  return text;
}

}  // namespace

ExportedMaterial write_pbrt(const ExportInput& input) {
  const HomogeneousFit& fit = *input.fit;
  const double mm_per_unit = input.options.mm_per_unit, eta = fit.ior() / fit.ior_above;
  ExportedMaterial result{.notes = {"not tested in pbrt itself"}, .misfits = fit.misfits};
  if (fit.top.roughness > 0.0 && fit.top.distribution == MicrofacetDistribution::beckmann)
    result.notes.emplace_back(
        "facets of pbrt are Trowbridge and Reitz's; those of the material are Beckmann's");
  if (!input.channels.wavelengths.empty())
    result.notes.emplace_back(
        "the spectra go on to 360 and 830 nm with their first and last values");
  if (fit.is_thin())
    result.notes.push_back("thin: give it to a closed sheet of a thickness of " +
                           number_text(fit.thickness / mm_per_unit) + " units");
  Coefficients numbers;
  std::vector<double> base, reflectance, transmittance;
  for (std::size_t c = 0; c < fit.media.size(); ++c) {
    numbers.sigma_a.push_back(fit.media[c].sigma_a);
    numbers.sigma_s.push_back(fit.media[c].sigma_s);
    const double total = std::clamp(fit.misfits[c].reflectance.wanted_total, 0.0, 1.0);
    base.push_back(base_reflectance(total, eta));
    reflectance.push_back(total);
    if (fit.is_thin())
      transmittance.push_back(std::clamp(fit.misfits[c].transmittance->wanted_total, 0.0, 1.0));
  }
  std::string body;
  Statement medium("MakeNamedMedium", input.stem + "_medium", "homogeneous");
  add_coefficients(medium, fit.channels, numbers, fit.g(), mm_per_unit);
  body +=
      "\n# 1. As a medium, for the volpath integrator: on a closed shape,\n#   MediumInterface \"" +
      input.stem + "_medium\" \"\"\n#   NamedMaterial \"" + input.stem + "_boundary\"\n" +
      medium.text();
  if (eta == 1.0) {
    Statement boundary("MakeNamedMaterial", input.stem + "_boundary", "interface");
    body += boundary.text();
  } else {
    Statement boundary("MakeNamedMaterial", input.stem + "_boundary", "dielectric");
    boundary.add("eta", eta);
    boundary.add_roughness(fit.top);
    body += boundary.text();
  }
  if (fit.is_thin()) {
    body += "\n# The shape is a closed sheet, " + number_text(fit.thickness / mm_per_unit) +
            " units thick.\n\n# 2. As a sheet without thickness that scatters evenly:\n";
    Statement sheet("MakeNamedMaterial", input.stem + "_thin", "diffusetransmission");
    sheet.add("reflectance", fit.channels, reflectance);
    sheet.add("transmittance", fit.channels, transmittance);
    body += sheet.text();
  } else {
    body += "\n# 2. By pbrt's photon beam diffusion, faster and less right:\n";
    Statement subsurface("MakeNamedMaterial", input.stem + "_subsurface", "subsurface");
    add_coefficients(subsurface, fit.channels, numbers, fit.g(), mm_per_unit);
    subsurface.add("eta", eta);
    subsurface.add_roughness(fit.top);
    body += subsurface.text();
    body += "\n# 3. From afar, where light seems to leave where it entered:\n";
    if (eta == 1.0) {
      Statement coated("MakeNamedMaterial", input.stem + "_far", "diffuse");
      coated.add("reflectance", fit.channels, reflectance);
      body += coated.text();
    } else {
      Statement coated("MakeNamedMaterial", input.stem + "_far", "coateddiffuse");
      coated.add("reflectance", fit.channels, base);
      coated.add("eta", eta);
      coated.add_roughness(fit.top);
      body += coated.text();
    }
  }
  if (input.stacks.front().layers().size() > 1)
    body +=
        "\n# The layers themselves, for shapes inside one another, each with its MediumInterface "
        "and a dielectric\n# boundary of the ratio of the indices (an interface material where "
        "they are equal):\n" +
        layer_media(input);
  std::vector<std::string> lines = head_lines(input, "pbrt-v4");
  lines.push_back("sigma_a and sigma_s are in 1/mm; scale is mm per unit of the scene");
  for (const std::string& line : misfit_lines(fit.misfits)) lines.push_back(line);
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  result.files.push_back({input.stem + ".pbrt", comment(lines, "# ") + body});
  return result;
}

}  // namespace lamina::detail
