// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/scene/description/scene.h"

// What the decoders of a scene file share: one each for materials, meshes and lights.

namespace lamina::scene_file {

/// Lengths beyond this [mm] are taken for mistakes.
inline constexpr double longest = 1e9;

/// Light beyond this is taken for a mistake.
inline constexpr double brightest = 1e12;

/// Calls `load`, and says in its errors which value of the scene asked for it.
template <class Load>
auto load_for(const JsonInput& value, const Load& load) {
  try {
    return load();
  } catch (const FileError& error) {
    throw FileError(value.where() + ": " + error.what());
  } catch (const InvalidInput& error) {
    throw InvalidInput(value.where() + ": " + error.what());
  }
}

/// The images of a scene, each file once for each meaning of its numbers.
class Images {
 public:
  /// The index of an image, which is loaded if it is new. All its numbers are finite.
  [[nodiscard]] std::size_t load(const JsonInput& file, ColorEncoding encoding);

  /// Loads the alpha channel of an image, or the whole image if it has none.
  [[nodiscard]] std::size_t load_coverage(const JsonInput& file, ColorEncoding encoding);

  /// Loads the channel of that name.
  [[nodiscard]] std::size_t load_channel(const JsonInput& file, ColorEncoding encoding,
                                         const JsonInput& channel);

  /// The images of the UDIM tiles of a path with "<UDIM>" in it, of all that there are.
  /// @param channel  as load_channel takes it, or "A" of a coverage; empty: the whole images
  [[nodiscard]] std::vector<std::uint32_t> load_tiles(const JsonInput& file, ColorEncoding encoding,
                                                      const std::optional<JsonInput>& channel,
                                                      bool is_coverage);

  /// The index of an image that is made, not loaded.
  [[nodiscard]] std::size_t add(Image image);

  [[nodiscard]] Image& operator[](std::size_t index) { return images_[index]; }
  [[nodiscard]] std::vector<Image> take() { return std::move(images_); }

 private:
  [[nodiscard]] std::size_t load(const JsonInput& file, const std::filesystem::path& path,
                                 ColorEncoding encoding);
  [[nodiscard]] std::size_t coverage_of(const JsonInput& file, std::size_t whole);
  [[nodiscard]] std::size_t channel_of(const JsonInput& file, std::size_t whole,
                                       const JsonInput& channel);

  std::vector<Image> images_;
  std::map<std::pair<std::filesystem::path, ColorEncoding>, std::size_t> index_of_;
  [[nodiscard]] std::size_t select(const JsonInput& file, std::size_t whole,
                                   const std::string& channel);
  /// By index of the whole image.
  std::map<std::pair<std::size_t, std::string>, std::size_t> channel_of_;
};

/// Whether a path stands for the tiles of a texture.
[[nodiscard]] bool is_tiled(const JsonInput& file);

/// The path of a UDIM tile.
/// @param index  10 v + u
[[nodiscard]] std::filesystem::path tile_path(const JsonInput& file, std::size_t index);

/// A texture in tiles, and where the scene names it.
struct TiledTexture {
  ImageMap map;
  JsonInput file;
};

/// A material and whether an image varies it, which takes texture coordinates.
struct DecodedMaterial {
  SurfaceMaterial material;
  std::string mapped;          ///< the first field that an image varies; empty if there is none
  std::string vertex_colored;  ///< the field that the colors of vertices vary; empty: none
  std::vector<TiledTexture> tiled;    ///< whose tiles must be there wherever a mesh needs them
  std::vector<std::string> warnings;  ///< what was done to its maps
};

[[nodiscard]] DecodedMaterial decode_surface_material(const std::string& name,
                                                      const JsonInput& value, Images& images);

/// A homogeneous material by its look: the color that it has in diffuse light once that has
/// entered, and how far light spreads in it. By the dipole, of whose half-space both are met
/// exactly. Source: [JensenBuhler2002] §5, [Hery2003] §2.
[[nodiscard]] Material decode_color_material(const JsonInput& value);

/// The quantity of a material that a key such as "dermis.blood" names; its terms are left empty.
[[nodiscard]] LayerMap find_quantity(const JsonInput& value, const std::string& key,
                                     const Material& material);

struct DecodedMesh {
  std::vector<Mesh> meshes;  ///< one, or one for each of its instances
  std::vector<std::string> warnings;
};

/// The materials of a scene: those that it lists, and then those of its mesh files that it uses.
struct SceneMaterials {
  std::vector<DecodedMaterial> list;
  std::size_t listed = 0;                         ///< how many the scene lists
  std::map<std::string, std::uint32_t> of_files;  ///< by file and index, see decode_mesh
};

[[nodiscard]] DecodedMesh decode_mesh(const JsonInput& value, SceneMaterials& materials,
                                      Images& images, double mm_per_unit);

/// Whether a name fits a pattern, in which * stands for any letters and ? for one.
[[nodiscard]] bool fits_pattern(std::string_view name, std::string_view pattern);

/// Name of a light; empty: it has no name.
[[nodiscard]] std::string decode_light_name(const JsonInput& value);

[[nodiscard]] Light decode_light(const JsonInput& value, Images& images, double mm_per_unit);

/// Three numbers as a vector, times `scale`.
[[nodiscard]] Vec3 decode_vector(const JsonInput& value, double scale = 1.0);

/// Decodes a direction; not all numbers may be 0. Unit length.
[[nodiscard]] Vec3 decode_direction(const JsonInput& value);

/// A number, or three for red, green and blue.
[[nodiscard]] Vec3f decode_color(const JsonInput& value, const NumberRange& range);

}  // namespace lamina::scene_file
