// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/thin_sheet.h"
#include "lamina/exchange/misfit_json.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/solve/albedo_inversion/renderer_albedos.h"

// Names and meanings: [glTF2] with KHR_materials_ior, _diffuse_transmission, _volume, and drafts of
// KHR_materials_scatter.

namespace lamina::detail {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

struct Glb {
  std::string json, binary;
};

Glb read_glb(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("glTF"))
    throw InvalidInput(name + ": must be a GLB of glTF 2, which begins with \"glTF\"");
  const GltfChunks chunks = check_gltf(bytes, name);
  return {.json = std::string(chunks.json), .binary = std::string(chunks.binary)};
}

std::string glb_bytes(Glb glb) {
  std::string bytes;
  const auto put = [&](std::uint32_t value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto chunk = [&](std::string data, std::uint32_t kind, char padding) {
    data.resize((data.size() + 3) / 4 * 4, padding);
    put(static_cast<std::uint32_t>(data.size()));
    put(kind);
    bytes += data;
  };
  put(glb_magic);
  put(2);
  put(0);  // the size, below
  chunk(std::move(glb.json), json_chunk, ' ');
  if (!glb.binary.empty()) chunk(std::move(glb.binary), binary_chunk, '\0');
  const auto size = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data() + 8, &size, sizeof size);
  return bytes;
}

/// The file with one material that all its surfaces have; what the first material of the file says
/// of normals stays.
JsonOutput with_material(const JsonInput& root, JsonOutput material,
                         std::span<const std::string> extensions) {
  JsonOutput json(root);
  if (const auto materials = root.peek("materials"); materials && materials->is_array())
    for (const JsonInput& old : materials->array(0, 1u << 20)) {
      for (const char* const key : {"normalTexture", "doubleSided"})
        if (const auto kept = old.peek(key)) material[key] = JsonOutput(*kept);
      break;
    }
  json["materials"] = JsonOutput::array({std::move(material)});
  if (const auto meshes = root.peek("meshes")) {
    JsonOutput changed = JsonOutput::array();
    for (const JsonInput& mesh : meshes->array()) {
      JsonOutput new_mesh(mesh), primitives = JsonOutput::array();
      if (const auto old = mesh.peek("primitives"))
        for (const JsonInput& primitive : old->array()) {
          JsonOutput one(primitive);
          one["material"] = 0;
          primitives.push_back(std::move(one));
        }
      new_mesh["primitives"] = std::move(primitives);
      changed.push_back(std::move(new_mesh));
    }
    json["meshes"] = std::move(changed);
  }
  std::vector<std::string> used(extensions.begin(), extensions.end());
  if (const auto old = root.peek("extensionsUsed"))
    for (const JsonInput& name : old->array())
      if (std::ranges::find(used, name.string()) == used.end()) used.push_back(name.string());
  json["extensionsUsed"] = used;
  return json;
}

struct Surface {
  JsonOutput material;
  std::vector<std::string> extensions;
};

void add_extension(Surface& to, const std::string& name, JsonOutput value) {
  to.material["extensions"][name] = std::move(value);
  to.extensions.push_back(name);
}

/// What the base scatters back, and what goes through, each with its color.
void add_sheet(Surface& to, JsonOutput& base, const ChannelLight& light, double enters,
               std::vector<ChannelMisfit>& misfits) {
  const ThinSheet sheet = make_thin_sheet(light, enters);
  const double through = 0.5 * (1.0 + sheet.forward);
  const auto color = [&](double total, double share) {
    return std::clamp(total / (enters * std::max(share, 1e-12)), 0.0, 1.0);
  };
  std::vector<double> reflected, transmitted;
  for (std::size_t c = 0; c < light.channels.size(); ++c) {
    const double r = light.profile.total_reflectance[c], t = light.profile.total_transmittance[c];
    reflected.push_back(color(r, 1.0 - through));
    transmitted.push_back(color(t, through));
    misfits.push_back(
        {.channel = light.channels.names[c],
         .reflectance = {.wanted_total = r,
                         .obtained_total = reflected.back() * enters * (1.0 - through),
                         .spread = {}},
         .transmittance = LightMisfit{.wanted_total = t,
                                      .obtained_total = transmitted.back() * enters * through,
                                      .spread = {}}});
  }
  reflected.push_back(1.0);  // alpha
  base["baseColorFactor"] = reflected;
  add_extension(
      to, "KHR_materials_diffuse_transmission",
      {{"diffuseTransmissionFactor", through}, {"diffuseTransmissionColorFactor", transmitted}});
}

void add_scattering(Surface& to, const HomogeneousFit& fit, double mm_per_unit) {
  double longest = 0.0;
  for (const Medium& medium : fit.media) longest = std::max(longest, mfp(medium));
  std::vector<double> colors, attenuation;
  for (const Medium& medium : fit.media) {
    colors.push_back(van_de_hulst_color(albedo(medium), 0.0));  // the draft leaves g out
    attenuation.push_back(std::exp(-longest / mfp(medium)));
  }
  add_extension(to, "KHR_materials_transmission", {{"transmissionFactor", 1.0}});
  add_extension(to, "KHR_materials_volume",
                {{"thicknessFactor", longest / mm_per_unit},
                 {"attenuationDistance", longest / mm_per_unit},
                 {"attenuationColor", attenuation}});
  add_extension(to, "KHR_materials_scatter",
                {{"multiscatterColorFactor", colors}, {"scatterAnisotropy", fit.g()}});
}

}  // namespace

ExportedMaterial write_gltf(const ExportInput& input) {
  require_rgb(input, "gltf");
  const HomogeneousFit& fit = *input.fit;
  const ExportOptions& options = input.options;
  const double enters = 1.0 - fresnel_diffuse(input.surface_ior);
  ExportedMaterial result;
  Surface surface;
  surface.material["name"] = input.material.name;
  JsonOutput base = {{"metallicFactor", 0.0}, {"roughnessFactor", std::sqrt(fit.top.roughness)}};
  add_extension(surface, "KHR_materials_ior", {{"ior", std::max(input.surface_ior, 1.0)}});
  if (fit.is_thin()) {
    add_sheet(surface, base, *input.light, enters, result.misfits);
    surface.material["doubleSided"] = true;
    result.notes.emplace_back("thin: for a mesh without thickness");
  } else if (options.gltf_scatter) {
    base["baseColorFactor"] = std::vector<double>{1.0, 1.0, 1.0, 1.0};
    add_scattering(surface, fit, options.mm_per_unit);
    result.misfits = fit.misfits;
    result.notes.emplace_back("KHR_materials_scatter is a draft");
  } else {
    std::vector<double> color;
    for (const ChannelMisfit& misfit : fit.misfits) {
      const double wanted = misfit.reflectance.wanted_total;
      color.push_back(std::clamp(wanted / enters, 0.0, 1.0));
      result.misfits.push_back({.channel = misfit.channel,
                                .reflectance = {.wanted_total = wanted,
                                                .obtained_total = color.back() * enters,
                                                .spread = {}},
                                .transmittance = {}});
    }
    color.push_back(1.0);
    base["baseColorFactor"] = color;
    result.notes.emplace_back(
        "thick: light leaves where it entered; --scatter writes the draft KHR_materials_scatter");
  }
  surface.material["pbrMetallicRoughness"] = std::move(base);
  surface.material["extras"]["lamina"] = {{"source", input.material.source},
                                          {"mm_per_unit", options.mm_per_unit},
                                          {"misfit", misfit_json(result.misfits)},
                                          {"notes", result.notes}};
  Glb glb{.json = R"({"asset": {"version": "2.0", "generator": "lamina"}})"};
  if (!options.glb.empty()) glb = read_glb(options.glb, options.glb_name);
  const JsonDocument document = parse_json(glb.json, options.glb.empty() ? "" : options.glb_name);
  glb.json = with_material(document.root(), std::move(surface.material), surface.extensions).text();
  result.files.push_back({input.stem + ".glb", glb_bytes(std::move(glb))});
  return result;
}

}  // namespace lamina::detail
