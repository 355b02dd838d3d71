// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

namespace lamina {

/// Aspects of a scene: changes of one leave all parts of a picture valid that do not need it.
enum class SceneAspect {
  meshes,     ///< vertices, triangles and which material each has
  images,     ///< pixels of textures
  lights,     ///< with their images, and surfaces that shine
  camera,     ///< place, direction, lens
  film,       ///< width and height
  surfaces,   ///< what light meets above: coats, roughness, indices at the top, bumps, opacity,
              ///< coverings, colors of opaque materials
  materials,  ///< what lies below: layers, recipes, their maps and colors
  settings,   ///< method, its numbers, bounces, seed
};
// test KeptParts.AreMadeAnewByTheTableRowByRow
inline constexpr std::size_t scene_aspect_count = 8;

/// A number for each aspect of a scene, that differs where it does.
using AspectHashes = std::array<std::uint64_t, scene_aspect_count>;

/// Parts of a picture that another picture may take over.
enum class KeptPart {
  geometry,        ///< hierarchy of boxes over the triangles
  lights,          ///< tables that lights are drawn from
  boundary,        ///< table of a rough boundary
  texels,          ///< atlas of method texture_space
  texel_layers,    ///< its maps and operators at all texels
  entering_light,  ///< light sampled on surfaces: texture_space, hierarchy
  leaving_light,   ///< after it has scattered: texture_space
};

/// Whether a part follows from an aspect.
enum class Need : char {
  no = '.',
  yes = 'x',
  in_the_end = '~',  ///< it does, but a first look may do without: the part of the scene before
                     ///< stands in, until the picture is made with its own
};

struct KeptPartNeeds {
  KeptPart part;
  std::string_view name;
  std::string_view needs;  ///< [aspect], a Need each
};

/// Table of what each part follows from. Light that enters needs materials for what surfaces throw
/// on each other, images for the colors of that and for bumps, and camera and film for how finely
/// it is sampled where it is seen. The camera counts for texels by their width alone, which is a
/// number that they are asked for by.
// clang-format off
inline constexpr auto kept_part_needs = std::to_array<KeptPartNeeds>({
    //                                       meshes
    //                                        images
    //                                         lights
    //                                          camera
    //                                           film
    //                                            surfaces
    //                                             materials
    //                                              settings
    {KeptPart::geometry,       "geometry",       "x......."},
    {KeptPart::lights,         "lights",         "x.x....."},
    {KeptPart::boundary,       "boundary",       "........"},  // its own numbers say all
    {KeptPart::texels,         "texels",         "x...~..."},
    {KeptPart::texel_layers,   "texel_layers",   "x...~.xx"},
    {KeptPart::entering_light, "entering_light", "x~x~~x~x"},
    {KeptPart::leaving_light,  "leaving_light",  "x~x~~xxx"},
});
// clang-format on
inline constexpr std::size_t kept_part_count = kept_part_needs.size();

[[nodiscard]] constexpr Need need_of(KeptPart part, SceneAspect aspect) {
  return static_cast<Need>(kept_part_needs[static_cast<std::size_t>(part)]
                               .needs[static_cast<std::size_t>(aspect)]);
}

/// Parts of pictures of one scene that changes now and then, one for each place that asks for it:
/// the last that was made there, taken again as long as what it needs is as it was.
class KeptParts {
 public:
  /// A part as it was found or made.
  template <class Part>
  struct Kept {
    std::shared_ptr<const Part> part;
    std::uint64_t key = 0;  ///< of all that it follows from
  };

  /// Begins a picture.
  /// @param size           pictures of other sizes have parts of their own: a fraction of the film
  /// @param is_first_look  whether parts may stand in that need what has changed in the end only
  void begin_picture(const AspectHashes& aspects, int size, bool is_first_look);

  /// The part at a place, or what `make()` makes: a shared_ptr.
  ///
  /// @param place   tells parts of a kind apart: a material
  /// @param more    what it follows from beside the aspects: numbers, keys of other parts
  /// @param serves  whether a part may stand in on a first look, which was made with another `more`
  ///                or other aspects that are needed in the end; empty: none may
  template <class Part, class Make>
  [[nodiscard]] Kept<Part> get(KeptPart kind, std::uint64_t place, std::uint64_t more,
                               const Make& make,
                               const std::function<bool(const Part&)>& serves = {}) {
    const Found found = look_up<Part>(kind, place, more, serves);
    if (found.part) return {std::static_pointer_cast<const Part>(found.part), found.key};
    std::shared_ptr<const Part> made = make();
    return {made, put(kind, place, more, made)};
  }

  /// The two halves of get(): the part, null if there is none; and one that was made.
  template <class Part>
  [[nodiscard]] std::shared_ptr<const Part> find(
      KeptPart kind, std::uint64_t place, std::uint64_t more,
      const std::function<bool(const Part&)>& serves = {}) {
    return std::static_pointer_cast<const Part>(look_up<Part>(kind, place, more, serves).part);
  }
  template <class Part>
  void keep(KeptPart kind, std::uint64_t place, std::uint64_t more,
            std::shared_ptr<const Part> part) {
    (void)put(kind, place, more, std::move(part));
  }

  /// Whether a part of this picture stands in for what will be made.
  [[nodiscard]] bool has_stand_ins() const { return has_stand_ins_; }

  /// How often parts of a kind were made, of all pictures.
  [[nodiscard]] int made(KeptPart kind) const { return made_[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] std::size_t count() const { return entries_.size(); }

 private:
  struct Entry {
    std::uint64_t key = 0;          ///< of all needs
    std::uint64_t least_key = 0;    ///< of those that a first look has, too
    std::uint64_t used = 0;         ///< by which picture
    std::shared_ptr<const void> part;
  };
  struct Found {
    std::shared_ptr<const void> part;
    std::uint64_t key = 0;
  };
  struct Keys {
    std::uint64_t all, least;
  };
  using Place = std::pair<KeptPart, std::uint64_t>;

  [[nodiscard]] Place place_of(KeptPart kind, std::uint64_t place) const;
  [[nodiscard]] Keys keys_of(KeptPart kind, std::uint64_t more) const;
  [[nodiscard]] Found find_any(KeptPart kind, std::uint64_t place, std::uint64_t more,
                               const std::function<bool(const void*)>& serves);
  template <class Part>
  [[nodiscard]] Found look_up(KeptPart kind, std::uint64_t place, std::uint64_t more,
                              const std::function<bool(const Part&)>& serves) {
    return find_any(kind, place, more, [&](const void* part) {
      return serves && serves(*static_cast<const Part*>(part));
    });
  }
  /// Keeps a part; one that is made from parts that stand in serves no picture without them.
  std::uint64_t put(KeptPart kind, std::uint64_t place, std::uint64_t more,
                                  std::shared_ptr<const void> part);

  AspectHashes aspects_{};
  int size_ = 1;
  bool is_first_look_ = false, has_stand_ins_ = false;
  std::uint64_t picture_ = 0;
  std::map<Place, Entry> entries_;
  std::array<int, kept_part_count> made_{};
};

/// KeptParts::get, or just what `make()` makes where nothing is kept.
template <class Part, class Make>
[[nodiscard]] KeptParts::Kept<Part> kept_or_made(
    KeptParts* kept, KeptPart kind, std::uint64_t place, std::uint64_t more, const Make& make,
    const std::function<bool(const Part&)>& serves = {}) {
  if (kept) return kept->get<Part>(kind, place, more, make, serves);
  return {make(), 0};
}

}  // namespace lamina
