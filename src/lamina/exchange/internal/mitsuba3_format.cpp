// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"

// Names and units: the plugin reference of Mitsuba 3 (homogeneous, hg, dielectric,
// roughdielectric).

namespace lamina::detail {
namespace {

/// A color or a spectrum; Mitsuba takes no color beyond 1.
std::string values_text(const Channels& channels, const std::string& name,
                        std::span<const double> values) {
  if (channels.wavelengths.empty())
    return "<rgb name=\"" + name + "\" value=\"" + numbers_text(values, ", ") + "\"/>";
  std::string text;
  for (std::size_t c = 0; c < values.size(); ++c)
    text +=
        (c > 0 ? ", " : "") + number_text(channels.wavelengths[c]) + ":" + number_text(values[c]);
  return "<spectrum name=\"" + name + "\" value=\"" + text + "\"/>";
}

std::string boundary_text(const HomogeneousFit& fit, const std::string& id) {
  if (fit.ior() == fit.ior_above) return "  <bsdf type=\"null\" id=\"" + id + "\"/>\n";
  const bool is_rough = fit.top.roughness > 0.0;
  std::string text = std::string("  <bsdf type=\"") +
                     (is_rough ? "roughdielectric" : "dielectric") + "\" id=\"" + id + "\">\n";
  text += "    <float name=\"int_ior\" value=\"" + number_text(fit.ior()) + "\"/>\n";
  text += "    <float name=\"ext_ior\" value=\"" + number_text(fit.ior_above) + "\"/>\n";
  if (is_rough) {
    text += "    <string name=\"distribution\" value=\"" +
            std::string(name_of(fit.top.distribution)) + "\"/>\n";
    text += "    <float name=\"alpha\" value=\"" + number_text(fit.top.roughness) + "\"/>\n";
  }
  return text + "  </bsdf>\n";
}

}  // namespace

ExportedMaterial write_mitsuba3(const ExportInput& input) {
  const HomogeneousFit& fit = *input.fit;
  ExportedMaterial result{.notes = {"not tested in Mitsuba itself; its names are of version 3.6"},
                          .misfits = fit.misfits};
  std::vector<double> albedos, sigma_ts;
  double densest = 0.0;
  for (const Medium& medium : fit.media) densest = std::max(densest, sigma_t(medium));
  for (const Medium& medium : fit.media) {
    albedos.push_back(albedo(medium));
    sigma_ts.push_back(sigma_t(medium) / densest);
  }
  if (fit.is_thin())
    result.notes.push_back("thin: give it to a closed sheet of a thickness of " +
                           number_text(fit.thickness / input.options.mm_per_unit) + " units");
  if (fit.is_thin() && fit.ior_below != fit.ior_above)
    result.notes.emplace_back(
        "the boundary below is to a medium of another index; use a bsdf of its own");
  std::vector<std::string> lines = head_lines(input, "Mitsuba 3");
  lines.push_back("sigma_t is in inverse scene units, of " +
                  number_text(input.options.mm_per_unit) + " mm: scale times its color");
  lines.push_back("use: <shape ...> <ref id=\"" + input.stem +
                  "_boundary\"/> <ref name=\"interior\" id=\"" + input.stem +
                  "_medium\"/> </shape>, with a volpath integrator");
  for (const std::string& line : misfit_lines(fit.misfits)) lines.push_back(line);
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  std::string text = xml_comment(lines) + "<scene version=\"3.0.0\">\n";
  text += boundary_text(fit, input.stem + "_boundary");
  text += "  <medium type=\"homogeneous\" id=\"" + input.stem + "_medium\">\n";
  text += "    " + values_text(fit.channels, "albedo", albedos) + "\n";
  text += "    " + values_text(fit.channels, "sigma_t", sigma_ts) + "\n";
  text += "    <float name=\"scale\" value=\"" + number_text(densest * input.options.mm_per_unit) +
          "\"/>\n";
  text += "    <phase type=\"hg\">\n      <float name=\"g\" value=\"" + number_text(fit.g()) +
          "\"/>\n    </phase>\n  </medium>\n</scene>\n";
  result.files.push_back({input.stem + ".xml", std::move(text)});
  return result;
}

}  // namespace lamina::detail
