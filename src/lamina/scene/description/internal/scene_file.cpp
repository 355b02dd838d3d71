// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/internal/scene_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <string_view>

#include "lamina/base/image/map_description.h"
#include "lamina/base/io/files_read.h"
#include "lamina/scene/description/common_bands.h"
#include "lamina/scene/description/method_settings.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "lamina/scene/mesh/files/gltf_image.h"

namespace lamina {
namespace scene_file {

namespace {

/// Of the smaller copies of an image that a TextureStore makes, over its pixels: those of each size
/// have a quarter of the ones before.
constexpr std::size_t smaller_copies_per_pixel = sizeof(Vec3f) / 3;

/// The same in full.
std::size_t bytes_of_smaller_copies(const Image& image) {
  std::size_t texels = 0;
  for (int w = image.width, h = image.height; w > 1 || h > 1;) {
    w = std::max(w / 2, 1), h = std::max(h / 2, 1);
    texels += static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  }
  return texels * sizeof(Vec3f);
}

constexpr std::string_view udim = "<UDIM>";

/// A file, or an image inside a glTF file.
Image load_any_image(const std::filesystem::path& path, ColorEncoding encoding,
                     MemoryBudget& memory) {
  ImageReading reading{.encoding = encoding, .more_bytes_per_pixel = smaller_copies_per_pixel};
  const auto inside = gltf_image_name(path);
  if (!inside) return load_image(path, reading, memory);
  // Profiles and orientations of images of glTF count for nothing. Source: [glTF2] §3.8.3.
  reading.is_turned_upright = false;
  if (reading.encoding == ColorEncoding::srgb) reading.encoding = ColorEncoding::srgb_texture;
  MemoryBudget while_reading = memory;  // the bytes of the file end here
  const std::string bytes = load_gltf_image(*inside, while_reading);
  return decode_image(std::as_bytes(std::span(bytes)), path.string(), reading, memory);
}

}  // namespace

bool is_tiled(const JsonInput& file) {
  return file.is_string() && file.string().find(udim) != std::string::npos;
}

std::filesystem::path tile_path(const JsonInput& file, std::size_t index) {
  std::string path = file.file_path().lexically_normal().string();
  const std::size_t at = path.rfind(udim);
  return path.replace(at, udim.size(), std::to_string(1001 + index));
}

std::vector<std::uint32_t> Images::load_tiles(const JsonInput& file, ColorEncoding encoding,
                                              const std::optional<JsonInput>& channel,
                                              bool is_coverage) {
  constexpr std::size_t rows = 100;
  std::vector<std::uint32_t> tiles;
  const std::filesystem::path first = tile_path(file, 0);
  if (file.file_path().string().find(udim) < file.file_path().string().rfind('/') + 1 &&
      file.file_path().string().rfind('/') != std::string::npos)
    file.fail("<UDIM> must stand in the name of the file, not of a folder");
  for (std::size_t index = 0; index < 10 * rows; ++index) {
    const std::filesystem::path path = tile_path(file, index);
    std::error_code ignored;
    note_file(path);  // also where it may come to be
    if (!std::filesystem::exists(path, ignored)) continue;
    const std::size_t whole = load(file, path, encoding);
    tiles.resize(index + 1, ImageMap::no_tile);
    tiles[index] = static_cast<std::uint32_t>(channel       ? channel_of(file, whole, *channel)
                                              : is_coverage ? coverage_of(file, whole)
                                                            : whole);
  }
  if (tiles.empty()) file.fail("there is no tile of that name, such as " + first.string());
  return tiles;
}

std::size_t Images::load(const JsonInput& file, ColorEncoding encoding) {
  if (is_tiled(file)) file.fail("must be one image here, but <UDIM> names tiles of it");
  return load(file, file.file_path().lexically_normal(), encoding);
}

std::size_t Images::load(const JsonInput& file, const std::filesystem::path& path,
                         ColorEncoding encoding) {
  const auto found = index_of_.find({path, encoding});
  if (found != index_of_.end()) return found->second;
  const MemoryBudget before = file.memory();
  Image image = load_for(file, [&] {
    Image loaded = load_any_image(path, encoding, file.memory());
    lamina::take_memory(file.memory(), bytes_of_smaller_copies(loaded),
                        path.string() + ": its smaller copies");
    require_finite(loaded, path);
    return loaded;
  });
  // One file read in two ways is most often the same.
  for (const auto& [name, index] : index_of_)
    if (name.first == path && images_[index].pixels == image.pixels) {
      file.memory() = before;
      return index_of_[{path, encoding}] = index;
    }
  return index_of_[{path, encoding}] = add(std::move(image));
}

std::size_t Images::load_coverage(const JsonInput& file, ColorEncoding encoding) {
  return coverage_of(file, load(file, encoding));
}

std::size_t Images::coverage_of(const JsonInput& file, std::size_t whole) {
  return channel_index(images_[whole], "A") ? select(file, whole, "A") : whole;
}

std::size_t Images::load_channel(const JsonInput& file, ColorEncoding encoding,
                                 const JsonInput& channel) {
  return channel_of(file, load(file, encoding), channel);
}

std::size_t Images::channel_of(const JsonInput& file, std::size_t whole, const JsonInput& channel) {
  return select(file, whole, images_[whole].channels[named_channel(images_[whole], channel)]);
}

std::size_t Images::select(const JsonInput& file, std::size_t whole, const std::string& channel) {
  const auto found = channel_of_.find({whole, channel});
  if (found != channel_of_.end()) return found->second;
  const Image& image = images_[whole];
  lamina::take_memory(
      file.memory(),
      image.pixels.size() / image.channel_count() * sizeof(float) + bytes_of_smaller_copies(image),
      file.where() + ": its channel " + channel);
  return channel_of_[{whole, channel}] = add(select_channels(image, {channel}));
}

std::size_t Images::add(Image image) {
  images_.push_back(std::move(image));
  return images_.size() - 1;
}

Vec3 decode_vector(const JsonInput& value, double scale) {
  const double most = longest / std::max(scale, 1e-9);
  const std::vector<double> v = value.numbers(3, closed_interval(-most, most));
  return scale * Vec3{v[0], v[1], v[2]};
}

Vec3 decode_direction(const JsonInput& value) {
  const Vec3 v = decode_vector(value);
  if (!(length(v) > 0.0)) value.fail("must be a direction, but is 0 0 0");
  return normalize(v);
}

Vec3f decode_color(const JsonInput& value, const NumberRange& range) {
  const std::vector<double> v = value.number_or_numbers(3, range);
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace scene_file

namespace {

using scene_file::decode_direction;
using scene_file::decode_vector;
using scene_file::DecodedMaterial;
using scene_file::longest;

Camera decode_camera(const JsonInput& value, double mm_per_unit) {
  const JsonObject object = value.object(
      {"position", "look_at", "up", "horizontal_fov", "aperture_diameter", "focus_distance"});
  Camera camera{.position = decode_vector(object.required("position"), mm_per_unit),
                .look_at = decode_vector(object.required("look_at"), mm_per_unit)};
  const Vec3 forward = camera.look_at - camera.position;
  if (!(length(forward) > 0.0))
    object.required("look_at").fail("must differ from the camera's position");
  if (const auto up = object.optional("up")) camera.up = decode_direction(*up);
  if (length(cross(normalize(forward), camera.up)) < 1e-6)
    (object.has("up") ? object.required("up") : value)
        .fail("the camera's up must not be parallel to its direction of view");
  double degrees = 40.0;
  if (const auto fov = object.optional("horizontal_fov"))
    degrees = fov->number(closed_interval(0.01, 175.0, "deg"));
  camera.horizontal_fov = degrees * std::numbers::pi / 180.0;
  const NumberRange length_range = closed_interval(0.0, longest / mm_per_unit);
  if (const auto aperture = object.optional("aperture_diameter"))
    camera.aperture_diameter = mm_per_unit * aperture->number(length_range);
  if (const auto distance = object.optional("focus_distance"))
    camera.focus_distance = mm_per_unit * distance->number(length_range);
  return camera;
}

Film decode_film(const JsonInput& value) {
  const JsonObject object =
      value.object({"width", "height", "exposure", "view", "alpha", "region"});
  Film film;
  constexpr int most = 16384;
  if (const auto width = object.optional("width"))
    film.width = static_cast<int>(width->integer(1, most));
  if (const auto height = object.optional("height"))
    film.height = static_cast<int>(height->integer(1, most));
  if (const auto exposure = object.optional("exposure"))
    film.exposure = static_cast<float>(exposure->number(closed_interval(-50.0, 50.0, "stops")));
  if (const auto view = object.optional("view")) film.view = view->choice<View>();
  if (const auto alpha = object.optional("alpha")) film.has_alpha = alpha->boolean();
  if (const auto region = object.optional("region")) {
    const std::vector<JsonInput> numbers = region->array(4, 4);
    const auto number = [&](std::size_t i, int least) {
      return static_cast<int>(numbers[i].integer(least, most));
    };
    film.region = {
        .x = number(0, 0), .y = number(1, 0), .width = number(2, 1), .height = number(3, 1)};
  }
  return film;
}

/// The object that is named after a method.
void decode_numbers(const JsonInput& value, SceneMethod method, RenderSettings& settings) {
  std::vector<std::string_view> keys;
  for (const MethodNumber& number : method->numbers) keys.push_back(number.key);
  const JsonObject object = value.object(keys);
  for (const MethodNumber& number : method->numbers)
    if (const auto given = object.optional(number.key))
      number.set(settings,
                 number.is_whole
                     ? static_cast<double>(given->integer(static_cast<std::int64_t>(number.low),
                                                          static_cast<std::int64_t>(number.high)))
                     : given->number(closed_interval(number.low, number.high, number.unit)));
}

/// Decodes the settings of the scene, first the quality, in whose place the others stand.
void decode_render_settings(const JsonInput& value, Scene& scene) {
  const std::vector<SceneMethod> methods = subsurface_methods();
  std::vector<std::string_view> keys = {"quality",
                                        "method",
                                        "profile",
                                        "orders",
                                        "factors",
                                        "single_scattering",
                                        "samples_per_pixel",
                                        "noise",
                                        "clamp",
                                        "max_bounces",
                                        "seed",
                                        "exit_angle",
                                        "correct"};
  for (const SceneMethod method : methods)
    if (!method->numbers.empty()) keys.push_back(method.name());
  const JsonObject object = value.object(keys);
  RenderSettings& settings = scene.render;
  if (const auto quality = object.optional("quality"))
    set_quality(quality->choice<RenderSettings::Quality>(), scene);
  if (const auto method = object.optional("method")) {
    const std::vector<std::string_view> names = method_names();
    if (const SceneMethod named = *find_method(names[method->choice(names)]);
        !named.is_open())  // else the quality chooses
      settings.method = named;
  }
  if (const auto orders = object.optional("orders"))
    settings.orders = orders->choice<LayeredOrders>();
  if (const auto factors = object.optional("factors"))
    for (const JsonInput& factor : factors->array(1, 4))
      settings.factors.*
          factor.choice<bool LayeredFactors::*>({{"fresnel", &LayeredFactors::fresnel},
                                                 {"seeliger", &LayeredFactors::seeliger},
                                                 {"depth", &LayeredFactors::depth},
                                                 {"phase", &LayeredFactors::phase}}) = true;
  if (const auto single = object.optional("single_scattering"))
    settings.single_scattering = single->choice<RenderSettings::SingleScattering>();
  if (const auto profile = object.optional("profile"))
    settings.profile = profile->choice<RenderSettings::Profile>();
  if (const auto exit = object.optional("exit_angle"))
    settings.exit_angle = exit->choice<RenderSettings::ExitAngle>();
  if (const auto correct = object.optional("correct")) settings.is_corrected = correct->boolean();
  if (const auto samples = object.optional("samples_per_pixel"))
    settings.samples_per_pixel = static_cast<int>(samples->integer(1, 1 << 24));
  if (const auto noise = object.optional("noise"))
    settings.noise = static_cast<float>(noise->number(closed_interval(0.0, 1.0)));
  if (const auto clamp = object.optional("clamp"))
    settings.clamp = static_cast<float>(clamp->number(closed_interval(0.0, 1e6)));
  if (const auto bounces = object.optional("max_bounces"))
    settings.max_bounces = static_cast<int>(bounces->integer(0, 1000));
  if (const auto seed = object.optional("seed"))
    settings.seed = static_cast<std::uint64_t>(seed->integer(0, std::int64_t{1} << 53));
  for (const SceneMethod method : methods)
    if (const auto numbers = object.optional(method.name()); numbers && !method->numbers.empty())
      decode_numbers(*numbers, method, settings);
}

/// The value at a path such as "subsurface.ground" below an object, or the last one on the way that
/// is there; none where nothing is.
std::optional<JsonInput> value_at(const JsonInput& object, std::string_view path) {
  JsonInput at = object;
  std::optional<JsonInput> found;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const auto next = at.is_object() ? at.peek(path.substr(0, dot)) : std::nullopt;
    if (!next) break;
    found = at = *next;
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return found;
}

/// Remembers where a file gives what some methods do not honour.
template <class Settings>
void note_places(const JsonInput& value, const std::string& path, const Settings& settings,
                 Scene& scene) {
  for (const auto& setting : settings)
    if (const auto given = value_at(value, setting.key))
      scene.places[path + "." + std::string(setting.key)] = given->where();
}

/// Calls act(TextureMap) for those of the maps of a material that can have the colors of vertices.
template <class Act>
void for_each_color_map(SurfaceMaterial& material, const Act& act) {
  const auto visit = [&](ColorParameter& color) {
    if (color.map) act(*color.map);
  };
  if (auto* diffuse = std::get_if<DiffuseSurface>(&material.surface)) visit(diffuse->color);
  if (auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface))
    visit(subsurface->color);
  if (auto* thin = std::get_if<ThinSurface>(&material.surface)) visit(thin->color);
}

/// What maps of the colors of vertices say of their range and mean.
void measure_vertex_colors(Scene& scene) {
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m)
    for_each_color_map(scene.materials[m], [&](TextureMap& map) {
      auto* colors = std::get_if<VertexColorMap>(&map.source);
      if (!colors && map.vertex_colors) colors = &*map.vertex_colors;
      if (!colors) return;
      Vec3 sum;
      double total = 0.0;
      constexpr float most = std::numeric_limits<float>::max();
      Vec3f low{most, most, most}, high{-most, -most, -most};
      for (const Mesh& mesh : scene.meshes)
        for (std::size_t t = 0; t < mesh.triangles.size() && !mesh.colors.empty(); ++t) {
          if (mesh.material[t] != m) continue;
          const auto [a, b, c] = mesh.triangles[t];
          const auto area = static_cast<double>(length(
              cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])));
          for (const std::uint32_t corner : {a, b, c})
            for (int i = 0; i < 3; ++i) {
              sum[i] += area / 3.0 * static_cast<double>(mesh.colors[corner][i]);
              low[i] = std::min(low[i], mesh.colors[corner][i]);
              high[i] = std::max(high[i], mesh.colors[corner][i]);
            }
          total += area;
        }
      if (!(total > 0.0)) return;
      for (int i = 0; i < 3; ++i) colors->mean[i] = static_cast<float>(sum[i] / total);
      colors->low = low;
      colors->high = high;
    });
}

Scene decode_scene(const JsonInput& root) {
  const JsonObject file = root.file_object("scene", 1,
                                           {"$schema", "name", "mm_per_unit", "camera", "film",
                                            "materials", "meshes", "lights", "render"});
  const double mm_per_unit = file.required("mm_per_unit").number(closed_interval(1e-6, 1e6, "mm"));
  Scene scene{.mm_per_unit = mm_per_unit};
  for (const std::string_view text : {"$schema", "name"})  // for other readers
    if (const auto given = file.optional(text)) (void)given->string();
  // What is cheap to check comes before what takes time to load.
  scene.camera = decode_camera(file.required("camera"), mm_per_unit);
  if (const auto film = file.optional("film")) scene.film = decode_film(*film);
  if (const auto render = file.optional("render")) {
    decode_render_settings(*render, scene);
    note_places(*render, "render", render_settings, scene);
  }
  scene_file::Images images;
  scene_file::SceneMaterials scene_materials;
  std::vector<DecodedMaterial>& materials = scene_materials.list;
  for (const auto& [name, value] : file.required("materials").entries()) {
    materials.push_back(decode_surface_material(name, value, images));
    note_places(value, "materials." + name, material_settings, scene);
  }
  scene_materials.listed = materials.size();
  for (const JsonInput& light : file.required("lights").array(0, 100'000)) {
    scene.lights.push_back(decode_light(light, images, mm_per_unit));
    scene.light_names.push_back(scene_file::decode_light_name(light));
  }
  for (const JsonInput& mesh : file.required("meshes").array(1, 100'000)) {
    auto [decoded, warnings] = decode_mesh(mesh, scene_materials, images, mm_per_unit);
    std::ranges::move(decoded, std::back_inserter(scene.meshes));
    scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
  }
  for (const DecodedMaterial& material : materials) {
    for (const std::string& warning : material.warnings)
      scene.warnings.push_back("material \"" + material.material.name + "\": " + warning);
  }
  const bool has_light =
      !scene.lights.empty() || std::ranges::any_of(materials, [](const DecodedMaterial& decoded) {
        const Vec3f& e = decoded.material.emission;
        return e.x > 0.0F || e.y > 0.0F || e.z > 0.0F;
      });
  if (!has_light)
    scene.warnings.push_back(file.required("lights").where() +
                             " is empty: the picture will be black");
  for (DecodedMaterial& material : materials)
    scene.materials.push_back(std::move(material.material));
  measure_vertex_colors(scene);
  make_bands_common(scene);
  for (const BandChange& change : scene.band_changes)
    scene.warnings.push_back(describe_band_change(change, scene));
  scene.images = images.take();
  if (scene.film.has_alpha) make_background_transparent(scene);
  return scene;
}

}  // namespace

void set_quality(RenderSettings::Quality quality, Scene& scene) {
  using Quality = RenderSettings::Quality;
  const bool is_reference = quality == Quality::reference;
  scene.render.quality = quality;
  scene.render.method = is_reference ? SceneMethod::random_walk : SceneMethod::automatic;
  scene.render.is_corrected = false;
  scene.places.erase("render.correct");
  // Noise of skin: docs/choose.md, measured.
  scene.render.samples_per_pixel = quality == Quality::preview ? 8
                                   : is_reference              ? 1024
                                                               : RenderSettings().samples_per_pixel;
}

void make_background_transparent(Scene& scene) {
  scene.film.has_alpha = true;
  for (Light& light : scene.lights)
    if (auto* sky = std::get_if<EnvironmentLight>(&light)) sky->is_visible = false;
}

Scene load_scene(const JsonFile& file, MemoryBudget memory, std::span<const std::string> settings) {
  constexpr std::array<std::string_view, 4> meshes = {".obj", ".ply", ".gltf", ".glb"};
  if (!file.text && std::ranges::find(meshes, file.path.extension().string()) != meshes.end())
    throw InvalidInput(
        file.path.string() +
        ": must be a scene, but is a mesh, which a scene names as the \"file\" of one of "
        "its \"meshes\"; lamina info says what it holds");
  const JsonDocument document = load_json(file, memory, settings);
  return decode_scene(document.root());
}

}  // namespace lamina
