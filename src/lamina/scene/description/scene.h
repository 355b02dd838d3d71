// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/base/image/pixel_rectangle.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/image/uv_placement.h"
#include "lamina/base/io/json_file.h"
#include "lamina/layers/materials/material.h"
#include "lamina/scene/description/scene_method.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/skin/maps/material_maps.h"

namespace lamina {

/// An image that varies a quantity over a surface.
struct ImageMap {
  std::size_t image = 0;  ///< index into Scene::images
  UvPlacement placement;  ///< on the texture coordinates, of a single image
  /// UDIM: [10 v + u] images of the unit squares of texture coordinates, no_tile where there is
  /// none; `image` is the first of them. Empty: one image everywhere.
  std::vector<std::uint32_t> tiles = {};
  static constexpr std::uint32_t no_tile = 0xffffffff;
};

/// The colors of a mesh's vertices.
struct VertexColorMap {
  Vec3f mean{1, 1, 1};  ///< over the surfaces that have the material, by area
  Vec3f low{}, high{1, 1, 1};
};

/// The images of a map.
[[nodiscard]] inline std::vector<std::size_t> images_of(const ImageMap& map) {
  if (map.tiles.empty()) return {map.image};
  std::vector<std::size_t> images;
  for (const std::uint32_t tile : map.tiles)
    if (tile != ImageMap::no_tile) images.push_back(tile);
  return images;
}

/// The image of the UDIM tile that holds texture coordinates; absent where there is none.
[[nodiscard]] inline std::optional<std::uint32_t> tile_at(const ImageMap& map, Vec2f uv) {
  if (!(uv.x >= 0.0f && uv.x < 10.0f && uv.y >= 0.0f && uv.y < 1000.0f)) return std::nullopt;
  const std::size_t index = 10 * static_cast<std::size_t>(uv.y) + static_cast<std::size_t>(uv.x);
  if (index >= map.tiles.size() || map.tiles[index] == ImageMap::no_tile) return std::nullopt;
  return map.tiles[index];
}

/// Seeded, band-limited noise in space, for surfaces without texture coordinates too.
struct NoiseMap {
  enum class Kind {
    smooth,    ///< gradient noise, about Gaussian, mean 0, standard deviation 1
    cellular,  ///< pits around scattered points, 0 at a point and 1 between them, as pores
  };
  Kind kind = Kind::smooth;
  float size = 1.0f;  ///< of the largest feature [mm]
  int octaves = 1;    ///< each half the size of the last
  std::uint32_t seed = 0;
};

template <>
inline constexpr auto enum_names<NoiseMap::Kind> = std::to_array<EnumName<NoiseMap::Kind>>(
    {{"smooth", NoiseMap::Kind::smooth}, {"cellular", NoiseMap::Kind::cellular}});

/// A source of texture values, mapped as offset + scale * value.
struct TextureMap {
  std::variant<ImageMap, NoiseMap, VertexColorMap> source;
  std::optional<VertexColorMap> vertex_colors = {};  ///< a factor of a color
  float scale = 1.0f, offset = 0.0f;
  float low = -std::numeric_limits<float>::infinity();  ///< the result is kept in [low, high]
  float high = std::numeric_limits<float>::infinity();
};

/// A linear Rec.709 colour, optionally times a map.
struct ColorParameter {
  Vec3f value{1, 1, 1};
  std::optional<TextureMap> map;
};

/// A number, optionally times a map.
struct ScalarParameter {
  float value = 1.0f;
  std::optional<TextureMap> map;
};

/// A quantity of one layer, or of a recipe of skin, that varies over a surface.
struct LayerMap {
  enum class Quantity {
    thickness,  ///< [mm]
    sigma_a,
    sigma_s,   ///< factors of the layer's coefficients
    fraction,  ///< volume fraction of a part of its mixture
    skin,      ///< a number of the recipe, whatever it does to the layers
  };
  std::size_t layer = 0;  ///< index into Material::layers
  Quantity quantity = Quantity::fraction;
  std::size_t part = 0;  ///< index into the layer's mixture, or into skin_parameter_ranges
  std::vector<ScalarParameter> terms;  ///< the value is their sum
};

/// Thin layers that lie on a surface, or on parts of it: foundation, paint, dust. Where they lie
/// they take part in what enters and leaves; light does not spread in them.
struct Covering {
  std::string name;
  Material material;         ///< of finite layers; what it covers takes the place of its ground
  ScalarParameter coverage;  ///< share of the surface that is covered, in [0, 1]
};

inline constexpr std::size_t most_coverings = 4;  ///< of one surface

/// A layered translucent material under a rough surface.
struct SubsurfaceSurface {
  Material material;
  ColorParameter color;  ///< what it does is `color_use`'s to say
  enum class ColorUse {
    none,
    scale,   ///< the map over its mean scales the light leaving: [DonnerJensen2005] §3.1
    invert,  ///< the map is the diffuse reflectance wanted; albedo inversion: [Hery2003] §2
  } color_use = ColorUse::none;
  ScalarParameter thickness{.value = 0.0f};  ///< of the object [mm] where it is thin; value 0:
                                             ///< taken from geometry
  ScalarParameter single_scattering_weight;  ///< of light scattered once, in [0, 1]
  ScalarParameter single_scattering_blur{.value = 0.0f};  ///< of it along the surface, standard
                                                          ///< deviation [mm]
  std::vector<LayerMap> maps;                             ///< for method layered_bsdf
  std::vector<MaterialMap> material_maps;  ///< of the material's numbers, for texture_space,
                                           ///< layered_bsdf and random_walk
  std::vector<Covering> over;  ///< what lies on it, from below; each as if it lay there by chance
};

template <>  // "none" is where there is no color
inline constexpr auto enum_names<SubsurfaceSurface::ColorUse> =
    std::to_array<EnumName<SubsurfaceSurface::ColorUse>>(
        {{"scale", SubsurfaceSurface::ColorUse::scale},
         {"invert", SubsurfaceSurface::ColorUse::invert}});

struct DiffuseSurface {
  ColorParameter color{.value = {0.5f, 0.5f, 0.5f}};  ///< reflectance
  std::vector<Covering> over;                         ///< as of SubsurfaceSurface
};

/// Light that a rough dielectric passes on, and how its facets hide one another.
enum class FacetScattering {
  single,    ///< light that meets one facet, Smith's masking; the rest is lost: [Walter2007]
  multiple,  ///< light that meets any number of them, so none is lost: [Heitz2016]
  xu_sun,    ///< one facet, with the visibility of [XuSun2008] Eq. 24
};

template <>
inline constexpr auto enum_names<FacetScattering> =
    std::to_array<EnumName<FacetScattering>>({{"single", FacetScattering::single},
                                              {"multiple", FacetScattering::multiple},
                                              {"xu_sun", FacetScattering::xu_sun}});

/// Smooth or rough dielectric: glass, a wet eye. Light inside it has the radiance that its lights
/// state; a single sheet of it parts two half-spaces, of which the one behind is the dielectric.
struct DielectricSurface {
  float ior = 1.5f;
  ScalarParameter roughness{.value = 0.0f};   ///< microfacet alpha
  std::optional<ScalarParameter> smoothness;  ///< s of a Gaussian surface: alpha is 2 / s
  MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;
  FacetScattering scattering = FacetScattering::single;
};

/// Layers so thin that light leaves where it entered, on either side: a leaf, paper. The mesh is
/// one sheet of triangles; its normals are on the side of the first layer.
struct ThinSurface {
  Material material;
  ColorParameter color;                      ///< scales the scattered light on both sides
  std::optional<ScalarParameter> thickness;  ///< of the sheet [mm], all layers together; absent:
                                             ///< as the material has it
};

/// Torrance-Sparrow reflection on top of a surface: oil, moisture, wax.
struct Coat {
  float ior = 1.45f;
  ScalarParameter roughness{.value = 0.3f};  ///< microfacet alpha
  ScalarParameter weight{.value = 1.0f};     ///< in [0, 1]
  MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;
  /// A second lobe: the share of the coat that has this other roughness.
  struct SecondLobe {
    ScalarParameter roughness;
    ScalarParameter share{.value = 0.5f};  ///< in [0, 1]
  };
  std::optional<SecondLobe> second;
};

struct SurfaceMaterial {
  std::string name;
  std::variant<DiffuseSurface, SubsurfaceSurface, DielectricSurface, ThinSurface> surface;
  std::optional<ScalarParameter> opacity;  ///< share of the surface that is there, of diffuse and
                                           ///< thin ones only
  std::optional<Coat> coat;
  std::optional<TextureMap> bump;      ///< height [mm], outward
  std::optional<ImageMap> normal_map;  ///< tangent space, OpenGL convention
  Vec3f emission{};  ///< radiance that it gives off on its outer side, of diffuse ones only
};

/// Coverings that lie over a surface; nothing over glass and thin sheets.
[[nodiscard]] inline std::span<const Covering> coverings_of(const SurfaceMaterial& material) {
  if (const auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface))
    return subsurface->over;
  const auto* diffuse = std::get_if<DiffuseSurface>(&material.surface);
  return diffuse ? std::span<const Covering>(diffuse->over) : std::span<const Covering>();
}
[[nodiscard]] inline std::span<Covering> coverings_of(SurfaceMaterial& material) {
  const std::span<const Covering> over = coverings_of(std::as_const(material));
  return {const_cast<Covering*>(over.data()), over.size()};
}

struct PointLight {
  Vec3 position;    ///< [mm]
  Vec3f intensity;  ///< [W/sr], linear Rec.709
};
/// A point light within a cone: all of its intensity inside the inner angle, none outside the outer
/// one, and between them a cubic smooth step of the cosine.
struct SpotLight {
  Vec3 position;                             ///< [mm]
  Vec3 direction{0, -1, 0};                  ///< that it shines in, unit length
  Vec3f intensity;                           ///< along the direction [W/sr]
  float cos_inner = 1.0f, cos_outer = 0.9f;  ///< cosines of the half angles
};

/// A ball that shines evenly on all sides.
struct SphereLight {
  Vec3 center;          ///< [mm]
  double radius = 1.0;  ///< [mm]
  Vec3f radiance;
};
struct DirectionalLight {
  Vec3 direction;    ///< towards the light, unit length
  Vec3f irradiance;  ///< on a surface facing the light
};
struct RectangleLight {
  Vec3 center, edge_u, edge_v;  ///< [mm]; whole edges; it shines along edge_u x edge_v
  Vec3f radiance;
};
struct EnvironmentLight {
  std::optional<std::size_t> image;  ///< latitude-longitude, of Scene::images; else constant
  Vec3f scale{1, 1, 1};
  float rotation = 0.0f;   ///< about +y, the map's up axis [rad]
  bool is_visible = true;  ///< to the camera; else the background is black
};
using Light = std::variant<PointLight, DirectionalLight, RectangleLight, EnvironmentLight,
                           SpotLight, SphereLight>;

struct Camera {
  Vec3 position{0, 0, 100}, look_at{}, up{0, 1, 0};  ///< [mm]
  double horizontal_fov = 0.7;                       ///< [rad], in (0, pi)
  double aperture_diameter = 0.0;                    ///< [mm]; 0 is a pinhole
  double focus_distance = 0.0;                       ///< [mm]; 0: at look_at
};

struct Film {
  int width = 512, height = 512;
  float exposure = 0.0f;  ///< [stops], for the PNG only
  View view = View::filmic;
  bool has_alpha = false;  ///< channel A of the picture: how much of a pixel surfaces cover
  /// Rectangle that is rendered alone; absent: all of the picture. Its pixels are those of the
  /// whole picture.
  std::optional<PixelRectangle> region;
};

/// The pixels of a film that are rendered.
[[nodiscard]] inline PixelRectangle rendered_area(const Film& film) {
  return film.region.value_or(PixelRectangle{0, 0, film.width, film.height});
}

/// How the method `hierarchy` samples light on surfaces and sums it.
struct HierarchySettings {
  float spacing = 0.0f;        ///< of samples [mm]; 0: from the profile and the size of a pixel
  int max_points = 1'000'000;  ///< of a material, whatever the spacing
  int irradiance_samples = 0;  ///< random estimates of the light at each sample; 0: as many as the
                               ///< samples of a pixel are worth, at most 32
  float error = 0.06f;         ///< solid angle up to which samples are summed as one [sr]
  float refine = 0.0f;  ///< change of the light up to which samples are made closer; 0: at once
  friend bool operator==(const HierarchySettings&, const HierarchySettings&) = default;
};

/// How the method `texture_space` samples light on a surface and spreads it.
struct TextureSpaceSettings {
  float texel = 0.0f;          ///< width of a texel [mm]; 0: from the size of a pixel
  int max_texels = 1'000'000;  ///< of a material, whatever the width
  int irradiance_samples = 4;  ///< random estimates of the light at texels that are seen, mean
  int interlayer_bounces =
      2;  ///< times that light comes back from the dermis before the series is closed
  friend bool operator==(const TextureSpaceSettings&, const TextureSpaceSettings&) = default;
};

/// How the method `shadow_map` sees surfaces from lights and draws points on them.
struct ShadowMapSettings {
  int resolution = 512;  ///< of a light: its square is the texels of all its buffers together
  int lamp_views = 16;   ///< points of a rectangle that light is seen from
  int dome_views = 64;   ///< directions of an environment
  int lookups = 16;      ///< points drawn for each sample of a pixel
  friend bool operator==(const ShadowMapSettings&, const ShadowMapSettings&) = default;
};

/// Orders of scattering that the method layered_bsdf follows inside the layers.
enum class LayeredOrders {
  first,        ///< light scattered once
  all,          ///< with a term of higher orders that has their flux
  random_walk,  ///< all, by random paths below the surface: noise in place of the term's error
};

/// Factors of the first order of a single layer. Where any is asked for, a surface shows their
/// product, unshaded: [HanrahanKrueger1993] Plate 1.
struct LayeredFactors {
  bool fresnel = false;   ///< what the boundary lets through, both ways
  bool seeliger = false;  ///< mu_i / (mu_i + mu_o)
  bool depth = false;     ///< 1 - exp(-tau (1 / mu_i + 1 / mu_o))
  bool phase = false;     ///< 4 pi p
  [[nodiscard]] bool any() const { return fresnel || seeliger || depth || phase; }
};

struct RenderSettings {
  using Method = SceneMethod;
  Method method;  ///< left open: by the quality and what the scene needs
  /// How good the picture is to be: chooses the method that is left open, and whether its light is
  /// corrected where Scene::places has no "render.correct". See set_quality.
  enum class Quality { preview, final, reference };
  std::optional<Quality> quality;
  LayeredOrders orders = LayeredOrders::all;
  LayeredFactors factors;
  /// Light scattered once, added to what diffusion finds: not at all, by a straight way to the
  /// light, or by the way that Snell's law takes.
  enum class SingleScattering { none, straight, refracted };
  SingleScattering single_scattering = SingleScattering::none;
  /// Where the profiles of translucent materials come from.
  enum class Profile { radiative_transfer, diffusion, dipole };
  std::optional<Profile> profile;  ///< left open: see profile_of
  /// How light leaves a translucent surface over the angle.
  enum class ExitAngle {
    conserving,  ///< as much in total as the profile says: transmittance over its projected
                 ///< integral
    printed,     ///< transmittance / pi, [DonnerJensen2005] Eqs. 2 and 25: loses that share twice
  };
  ExitAngle exit_angle = ExitAngle::conserving;
  bool is_corrected = false;   ///< of a planar method: by random walks
  int samples_per_pixel = 64;  ///< at most, if there is a noise to reach
  /// Standard error over brightness below which a part of the picture gets no more samples; what is
  /// darker than a quarter of the mean counts as that bright. 0: all get the same.
  float noise = 0.0f;
  /// Most that a channel of a sample may have, cut in proportion; 0: all that it has. A picture
  /// with it lacks the light that is cut.
  float clamp = 0.0f;
  int max_bounces = 4;  ///< of light between surfaces
  std::uint64_t seed = 0;
  HierarchySettings hierarchy;
  TextureSpaceSettings texture_space;
  ShadowMapSettings shadow_map;
};

template <>
inline constexpr auto enum_names<LayeredOrders> =
    std::to_array<EnumName<LayeredOrders>>({{"first", LayeredOrders::first},
                                            {"all", LayeredOrders::all},
                                            {"random_walk", LayeredOrders::random_walk}});

template <>
inline constexpr auto enum_names<RenderSettings::Quality> =
    std::to_array<EnumName<RenderSettings::Quality>>({{"preview", RenderSettings::Quality::preview},
                                                      {"final", RenderSettings::Quality::final},
                                                      {"reference",
                                                       RenderSettings::Quality::reference}});

template <>
inline constexpr auto enum_names<RenderSettings::SingleScattering> =
    std::to_array<EnumName<RenderSettings::SingleScattering>>(
        {{"none", RenderSettings::SingleScattering::none},
         {"straight", RenderSettings::SingleScattering::straight},
         {"refracted", RenderSettings::SingleScattering::refracted}});

template <>
inline constexpr auto enum_names<RenderSettings::ExitAngle> =
    std::to_array<EnumName<RenderSettings::ExitAngle>>(
        {{"conserving", RenderSettings::ExitAngle::conserving},
         {"printed", RenderSettings::ExitAngle::printed}});

template <>
inline constexpr auto enum_names<RenderSettings::Profile> =
    std::to_array<EnumName<RenderSettings::Profile>>(
        {{"radiative_transfer", RenderSettings::Profile::radiative_transfer},
         {"diffusion", RenderSettings::Profile::diffusion},
         {"dipole", RenderSettings::Profile::dipole}});

/// Where profiles come from: what is named, else radiative transfer, but diffusion where light
/// scattered once is added to it. A material whose layers radiative transfer refuses takes
/// diffusion where nothing is named, see ProfileMaker.
[[nodiscard]] inline RenderSettings::Profile profile_of(const RenderSettings& settings) {
  using Single = RenderSettings::SingleScattering;
  return settings.profile.value_or(settings.single_scattering == Single::none
                                       ? RenderSettings::Profile::radiative_transfer
                                       : RenderSettings::Profile::diffusion);
}

/// A translucent material that was given for other bands than the scene is rendered with.
struct BandChange {
  std::uint32_t material = 0;  ///< index into Scene::materials
  std::string covering;        ///< the name of what lies over it; empty: the material itself
  BandSet from = BandSet::rgb();
  double color_error = 0.0;  ///< largest of R, G, B: of the color of a thick piece in diffuse
                             ///< light, or of what a thin one reflects and lets through
};

/// Everything that a picture is made of. Lengths are in mm: the file's `mm_per_unit` is applied.
struct Scene {
  double mm_per_unit = 0.0;  ///< of the file, whose lengths are in mm here; 0: it has none
  Camera camera;
  Film film;
  RenderSettings render;
  std::vector<Image> images;  ///< linear
  std::vector<SurfaceMaterial> materials;
  std::vector<Mesh> meshes;
  std::vector<Light> lights;
  std::vector<std::string> light_names;  ///< [light], of layers; empty, or none: after its kind
  std::vector<BandChange> band_changes;
  std::vector<std::string>
      warnings;  ///< of loading, one line each: flipped normals, zero-area faces
  /// Where a file says what some methods do not honour, by its path such as "render.orders", as
  /// messages name it.
  std::map<std::string, std::string> places;
};

/// Sets the samples per pixel of a quality, and leaves method and correction to it; random walks
/// are the method of the reference.
void set_quality(RenderSettings::Quality quality, Scene& scene);

/// Gives the picture an alpha channel: the sky lights things, but is not seen behind them.
void make_background_transparent(Scene& scene);

/// Reads a scene file and all that it names; paths in it are relative to it.
/// @param memory    that reading them may take in all.
/// @param settings  changes of values, as parse_json takes them.
/// @throws FileError, InvalidInput with file, line and field.
[[nodiscard]] Scene load_scene(const JsonFile& file, MemoryBudget memory = {},
                               std::span<const std::string> settings = {});

}  // namespace lamina
