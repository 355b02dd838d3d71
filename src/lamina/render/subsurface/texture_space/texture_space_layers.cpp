// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/number_text.h"
#include "lamina/render/subsurface/texture_space/internal/texel_maps.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"
#include "lamina/scene/description/skin_totals.h"

namespace lamina {
namespace {

/// Levels of cells go on up to at least this size: Gaussians of skin are no wider [mm²]. Where
/// light goes further, up to so many times the variance of what it spreads.
constexpr double smallest_largest_cell = 25.0, cell_per_spread = 1.9;

/// Two faces of a closed mesh bound the layers if they are no further apart than so many times as
/// these are thick.
constexpr float most_far_side_thicknesses = 4.0f;

/// More of the surface without a far side than this is worth a warning.
constexpr float most_without_far_side = 0.05f;

}  // namespace

template <int N>
std::shared_ptr<const typename TextureSpaceTransport<N>::TexelLayers>
TextureSpaceTransport<N>::make_layers(const std::optional<DiskCache>& cache) const {
  const auto made = std::make_shared<TexelLayers>();
  const TextureAtlas::Cells cells = atlas_->cells();
  const std::vector<NumberTexels> maps =
      sample_maps(surface_.material_maps, scene_.scene->meshes, *atlas_);
  Material material = surface_.material;
  material.layers.front().top = {};  // the surface's roughness is the coat's business
  const bool lets_through = lets_light_through(material);
  if (lets_through) material.ground.top = {};
  const auto lit_from = [&](LitFrom side) {
    return make_band_layers(material, maps, atlas_->texels().size(), side, texture_space_totals(),
                            cache);
  };
  const std::vector<BandLayers> bands = lit_from(LitFrom::above);
  double widest = smallest_largest_cell;
  for (const BandLayers& band : bands)
    widest = std::max(widest, cell_per_spread * widest_spread(band.tables.lattices));
  made->graph = make_cell_graph(cells.cells, cells.links, widest);
  made->layers.push_back(on_surface<N>(bands, made->graph));
  if (std::isinf(material.layers.back().thickness)) 
    add_thin_parts(bands, made->graph, made->layers.front());
  if (side_count() == 2 && !is_symmetric(bands))
    made->layers.push_back(on_surface<N>(lit_from(LitFrom::below), made->graph));
  for (std::size_t side = 0; side < side_count(); ++side) {
    made->reflectance.push_back(uniform_reflectance(made->from(side)));
    extend(made->reflectance.back());
    if (side_count() == 1) continue;
    made->transmittance.push_back(uniform_transmittance(made->from(1 - side)));
    extend(made->transmittance.back());
  }
  if (!lets_through) return made;
  const float reach = most_far_side_thicknesses * largest_thickness(bands);
  made->far_sides = find_far_sides(scene_, *atlas_, material_, is_sheet_, reach);
  const float lost = share_without_far_side(*atlas_, made->far_sides, is_sheet_);
  if (!(lost > most_without_far_side)) return made;
  made->warning =
      "material \"" + scene_.scene->materials[material_].name + "\": on " +
         number_text(std::round(100.0f * lost)) +
         " % of its closed meshes light that passes the layers is lost, for no far side is "
         "within " +
         number_text(reach) + " mm, four times their thickness";
  return made;
}

template <int N>
void TextureSpaceTransport<N>::add_thin_parts(std::span<const BandLayers> bands,
                                              const CellGraph& graph,
                                              SurfaceLayers<N>& layers) const {
  const auto texels = atlas_->texels();
  std::vector<std::vector<float>> last;  // [band], absorption of the last layer
  last.reserve(bands.size());            // `thin` points to it
  std::vector<ThinBand> thin;
  for (const BandLayers& band : bands) {
    last.push_back(band.texels.layers.back().sigma_a);
    last.back().resize(texels.size(), last.back().front());
    thin.push_back({.stack = &band.stack,
                    .tables = &band.tables,
                    .reference = reference_absorptions(band.texels),
                    .sigma_a = last.back(),
                    .has_transfer_totals = texture_space_totals() != OperatorTotals::diffusion});
  }
  std::vector<Vec3f> positions, normals;
  for (const AtlasTexel& texel : texels) {
    positions.push_back(texel.position);
    normals.push_back(texel.normal);
  }
  layers.thin = make_thin_parts<N>(graph, positions, normals, thin);
}

template <int N>
OperatorTotals TextureSpaceTransport<N>::texture_space_totals() const {
  const Material& material = surface_.material;
  const bool is_transfer = !material.skin || takes_material_totals(material, scene_.settings);
  return is_transfer ? OperatorTotals::radiative_transfer_diffuse : OperatorTotals::diffusion;
}

#define LAMINA_INSTANTIATE(N)                                                                  \
  template std::shared_ptr<const typename TextureSpaceTransport<N>::TexelLayers>               \
  TextureSpaceTransport<N>::make_layers(const std::optional<DiskCache>&) const;                \
  template void TextureSpaceTransport<N>::add_thin_parts(                                      \
      std::span<const BandLayers>, const CellGraph&, SurfaceLayers<N>&) const;                 \
  template OperatorTotals TextureSpaceTransport<N>::texture_space_totals() const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
