// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/exchange/medium_fit/channel_light.h"
#include "lamina/exchange/medium_fit/homogeneous_fit.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

struct ExportOptions {
  double mm_per_unit = 1.0;                ///< of the scene that the files are for, > 0
  std::optional<ExportChannels> channels;  ///< absent: those that the format has best
  std::optional<double> g, ior;  ///< of the one medium that stands for layers, as HomogeneousFit
  FitGoal goal = FitGoal::profile;
  int gaussians = 6;  ///< how many a sum has, those of no width apart
  std::string glb;    ///< bytes of a GLB whose copy `gltf` writes with the material; or none
  std::string glb_name = "the mesh";  ///< in messages
  bool gltf_scatter = false;          ///< `gltf` writes drafts of extensions, too
  bool skips_refused = false;         ///< formats that cannot say what the material is are left out
  Progress progress = {};
};

/// Input that a format is written from.
struct ExportInput {
  Material material;
  std::vector<LayerStack> stacks;  ///< [band]
  Interface surface;               ///< as renders mirror in it; goes into `fit`, too
  std::string stem;                ///< what files are called, without an ending
  ExportOptions options;
  Channels channels;                  ///< those that are asked for
  std::optional<ChannelLight> light;  ///< of formats that ask for light or a medium
  std::optional<HomogeneousFit> fit;  ///< of formats that ask for a medium
  double surface_ior = 1.0;           ///< of the upper layer over what is above, mean of bands
};

struct ExportedFile {
  std::string name;  ///< without a folder; begins with the stem of the input
  std::string bytes;
};

/// A material as another program reads it.
struct ExportedMaterial {
  std::vector<ExportedFile> files;     ///< the first is the one to open
  std::vector<std::string> notes;      ///< what the format cannot say, or says in another way
  std::vector<ChannelMisfit> misfits;  ///< per channel of the files; empty if nothing can be told
  std::string refusal;                 ///< why there are no files, if formats may be left out
};

/// Results that a format needs before it is written.
enum class ExportNeeds {
  layers,  ///< nothing: the layers as they are
  light,   ///< what they do to diffuse light
  medium,  ///< one medium that does the same
  walk,    ///< one medium that does, below a boundary that neither refracts nor reflects, which is
           ///< where renderers' own random walks are; nothing for what lets light through
};

/// A row of the table of formats.
struct ExportFormat {
  std::string_view name;
  std::string_view alias = {};  ///< another name that it is found by
  std::string_view about;       ///< one line for people
  std::string_view ending;      ///< of its first file, with the dot
  ExportChannels channels = ExportChannels::rgb;
  ExportNeeds needs = ExportNeeds::medium;
  ExportedMaterial (*write)(const ExportInput& input) = nullptr;
};

/// All formats, in the order of the list that users see.
[[nodiscard]] std::span<const ExportFormat> export_formats();

/// @throws InvalidInput if there is none of that name; suggests the nearest.
[[nodiscard]] const ExportFormat& find_export_format(std::string_view name);

/// A material in some formats; what several of them need is worked out once.
///
/// Nothing is written: the files are handed over as bytes.
///
/// @return  [format]
/// @throws InvalidInput if a format cannot say what the material is, unless that is skipped;
///         Interrupted.
[[nodiscard]] std::vector<ExportedMaterial> export_material(
    const Material& material, std::span<const ExportFormat* const> formats,
    const ExportOptions& options = {});

/// The name of a material as a file may be called: letters, digits, '_' and single '-' within.
[[nodiscard]] std::string file_stem(std::string_view material);

}  // namespace lamina
