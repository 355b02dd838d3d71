// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/render.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/image/compare.h"
#include "lamina/base/image/pixel_rectangle.h"
#include "lamina/render/film/film_accumulator.h"
#include "lamina/render/film/film_shard.h"
#include "lamina/render/film/matte_film.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/film/tile_passes.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/paths/path_tracer.h"
#include "lamina/render/planning/find_seen_surface.h"
#include "lamina/render/planning/method_choice.h"
#include "lamina/render/planning/render_cost.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"
#include "lamina/render/subsurface/methods/make_methods.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/scene/description/common_bands.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/scene/description/method_settings.h"

namespace lamina {
namespace {

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Of the process now; 0 where the system does not tell.
double memory_mib() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  file >> all >> resident;
  return file ? resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0 : 0.0;
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// The bands of all translucent materials and of what lies over surfaces, which must agree; else
/// RGB.
BandSet common_bands(const Scene& scene) {
  const std::vector<SceneLayers> all = layers_of(scene);
  if (all.empty()) return BandSet::rgb();
  const auto& [first, layers] = all.front();
  const BandSet& bands = layers->bands;
  for (const auto& [surface, own] : all)
    if (!(own->bands == bands))
      throw InvalidInput("materials \"" + first->name + "\" and \"" + surface->name +
                         "\": all translucent materials of a scene must have the same bands; "
                         "make_bands_common() sees to it");
  if (bands.size() > 16)
    throw InvalidInput("material \"" + first->name +
                       "\": at most 16 bands can be rendered, but it has " +
                       std::to_string(bands.size()));
  return bands;
}

template <int N>
LayeredMaterials<N> make_layered_materials(const RenderScene& scene,
                                           const BandConversion<N>& conversion) {
  LayeredMaterials<N> layered(scene.scene->materials.size());
  if (!scene.settings.method->is_bsdf) return layered;
  for (const std::uint32_t m : translucent_materials_in_use(*scene.scene))
    layered[m] = std::make_unique<LayeredMaterial<N>>(scene, conversion, m);
  return layered;
}

/// Where profiles come from, with a warning for what nobody asked for.
void report_profiles(const Scene& scene, const RenderSettings& settings,
                     RenderStatistics& statistics) {
  if (!settings.method->uses_profile) return;
  const ProfileMaker profiles(settings);
  for (const std::uint32_t m : translucent_materials_in_use(scene)) {
    const Material& material = std::get<SubsurfaceSurface>(scene.materials[m].surface).material;
    const auto source = profiles.source(material);
    statistics.profiles.push_back({m, source});
    if (source != profile_of(settings) && !material.is_by_diffusion)
      statistics.warnings.push_back(
          "material \"" + scene.materials[m].name + "\": its profile is by " +
          std::string(name_of(source)) +
          ", for radiative transfer refuses it: " + transfer_refusal(material).value_or(""));
  }
}

/// "method probe, as hierarchy would take 5 times its work: about 12 CPU-s".
std::string describe(const RenderStatistics& statistics, const RenderSettings& settings) {
  const double expected = statistics.expected_cpu_seconds;
  const std::string seconds = printf_text("%.*f",
                                          expected < 0.95  ? 2
                                          : expected < 9.5 ? 1
                                                           : 0,
                                          expected);
  const int threads = thread_count();
  return "method " + std::string(statistics.method.name()) +
         (statistics.why_method.empty() ? "" : " (" + statistics.why_method + ")") +
         (settings.quality && settings.is_corrected                       ? ", corrected"
          : settings.quality == RenderSettings::Quality::final ? ", not corrected"
                                                               : "") +
         (settings.quality ? ", " + std::to_string(settings.samples_per_pixel) + " samples" : "") +
         (settings.noise > 0.0f ? ": at most about " : ": about ") + seconds + " CPU-s" +
         (threads > 1 ? printf_text(", %.*f s on %d threads", expected < 9.5 ? 1 : 0,
                                    expected / threads, threads)
                      : "") +
         printf_text(", %.0f MiB", statistics.expected_memory_mib);
}

/// What a film becomes: the picture, and its file in the making.
double picture_mib(const FilmAccumulator& film, const RenderOptions& options) {
  if (options.part || options.only_prepares) return 0.0;
  constexpr double channels = 18.0, of_mattes = 24.0, copies = 2.0;
  const double pixels = static_cast<double>(film.width()) * static_cast<double>(film.height());
  return copies * sizeof(float) * pixels * (channels + (options.has_mattes ? of_mattes : 0.0)) /
         1048576.0;
}

double share_of_pixels(const Film& film) {
  const PixelRectangle area = rendered_area(film);
  return static_cast<double>(area.width) * static_cast<double>(area.height) /
         (static_cast<double>(film.width) * static_cast<double>(film.height));
}

/// Cuts what a sample has beyond the most that a channel may have, in proportion.
void clamp_sample(float most, CameraSample& sample) {
  const auto largest = [](const Vec3f& c) {
    return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  };
  for (Vec3f* light : {&sample.beauty, &sample.subsurface, &sample.specular})
    if (const float found = largest(*light); found > most) *light = (most / found) * *light;
}

/// The samples of each pixel that are asked for.
IndexRange sample_range(const RenderSettings& settings, const RenderOptions& options) {
  return range_of(options.part ? options.part->shard : Shard{}, settings.samples_per_pixel);
}

/// What a checkpoint follows from: the picture, and the part of it.
std::uint64_t checkpoint_key(std::uint64_t picture, const RenderSettings& settings,
                             const RenderOptions& options) {
  if (!options.part) return picture;
  Hash hash;
  hash.add(picture);
  hash.add(options.part->shard.index);
  hash.add(options.part->shard.count);
  hash.add(settings.samples_per_pixel);
  return hash.value();
}

/// What was prepared for a number of samples.
std::uint64_t light_key(const PreparationReport& report) {
  Hash hash;
  for (const LightSamples& light : report.light_samples) hash.add(light.estimates);
  return hash.value();
}

void check_part(const Scene& scene, const RenderOptions& options) {
  if (!options.part) return;
  const auto& [index, count] = options.part->shard;
  if (count < 1 || count > scene.render.samples_per_pixel)
    throw InvalidInput("render: a picture of " + std::to_string(scene.render.samples_per_pixel) +
                       " samples per pixel can have at most as many shards, but is to have " +
                       std::to_string(count));
  if (index < 0 || index >= count)
    throw InvalidInput("render: the shard must lie in [0, " + std::to_string(count) + "), but is " +
                       std::to_string(index));
  if (scene.render.noise > 0.0f)
    throw InvalidInput(
        "render: noise must be 0 for a shard, which does not know the noise of the others, but "
        "is " +
        number_text(static_cast<double>(scene.render.noise)));
}

/// Equal renders have equal files: nothing of when, where and how long.
std::vector<ImageNote> picture_notes(const Scene& scene, SceneMethod method) {
  const auto place = [](const Vec3& v) {
    return number_text(v.x) + " " + number_text(v.y) + " " + number_text(v.z);
  };
  const Camera& camera = scene.camera;
  return {{"lamina/method", std::string(method.name())},
          {"lamina/seed", std::to_string(scene.render.seed)},
          {"lamina/camera_position_mm", place(camera.position)},
          {"lamina/camera_look_at_mm", place(camera.look_at)},
          {"lamina/camera_up", place(camera.up)},
          {"lamina/camera_horizontal_fov_degrees",
           number_text(camera.horizontal_fov * 180.0 / std::numbers::pi)},
          {"lamina/view", std::string(name_of(scene.film.view))},
          {"lamina/exposure_stops", number_text(static_cast<double>(scene.film.exposure))},
          {"lamina/color_space", "linear Rec.709"}};
}

/// @param picture_key  of the scene, whose method may have been left open
void save_part(const Scene& scene, const RenderSettings& settings, const RenderOptions& options,
               std::uint64_t picture_key, const RenderStatistics& statistics,
               const FilmAccumulator& film) {
  save_film_shard(options.part->file,
                  {.version = options.part->version,
                   .program = program_key(),
                   .key = picture_key,
                   .method = std::string(statistics.method.name()),
                   .seed = settings.seed,
                   .width = film.width(),
                   .height = film.height(),
                   .frame = frame_of(scene.film),
                   .samples = settings.samples_per_pixel,
                   .shards = options.part->shard.count,
                   .ranges = {sample_range(settings, options)},
                   .view = scene.film.view,
                   .exposure = static_cast<double>(scene.film.exposure),
                   .has_alpha = scene.film.has_alpha,
                   .notes = picture_notes(scene, statistics.method),
                   .command = options.part->command,
                   .cpu_seconds = statistics.cpu_seconds},
                  film);
}

/// A picture at work.
struct PictureWork {
  const RenderScene& scene;
  const RenderOptions& options;
  const Progress& progress;
  double cpu_before;  ///< time before all that was done for the picture [CPU s]
  FilmAccumulator& film;
  MatteFilm* mattes;  ///< null: none are wanted
  RenderStatistics& statistics;
  double share_of_refinement = 0.0;  ///< of the time of refinement and samples
  bool is_cut_short = false;         ///< asked to stop while light was refined
  std::uint64_t key = 0;             ///< of the picture, once it is prepared
  PreparationReport preparation{};  ///< once it is prepared
};

/// Lines on how light was corrected, where a quality chose it.
void say_corrections(const PictureWork& work) {
  if (!work.scene.settings.quality || !work.options.on_notice) return;
  for (const LightCorrection& done : work.preparation.corrections)
    if (done.walks > 0)
      work.options.on_notice("light of \"" + work.scene.scene->materials[done.material].name +
                             "\" corrected: about " +
                             printf_text("%.2g", 100.0 * done.error_left) + " % of error left");
}

/// Methods with the time that they take to refine their light, by material [CPU s].
template <int N>
class LightMaker {
 public:
  LightMaker(const SubsurfaceMethods<N>& methods, const Preparation<N>& with, PictureWork& work)
      : methods_(methods), with_(with), work_(work), seconds_(methods.size()) {
    for (std::size_t m = 0; m < methods.size(); ++m)
      if (methods[m]) seconds_[m] = methods[m]->expected_cost(with).refinement;
  }

  /// Makes all methods ready. @return  false if progress asked to stop
  bool prepare() {
    for (const auto& method : methods_)
      if (method) method->prepare_reflectance(with_);
    for (std::size_t m = 0; m < methods_.size(); ++m)
      if (methods_[m] && !methods_[m]->prepare(for_method(m, work_.progress))) return false;
    return true;
  }

  /// Makes their light better, until progress asks to stop.
  void refine() {
    const double left = work_.statistics.expected_cpu_seconds - (cpu_seconds() - work_.cpu_before);
    const double of_samples = std::max(left - all_seconds(), 0.0);
    double before = 0.0;
    std::atomic<double> told = 0.0;
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      if (!(seconds_[m] > 0.0)) continue;
      const Progress progress = [&](double finished) {
        // Work that turns out to be more does not take it back.
        const double now = (before + finished * seconds_[m]) / (all_seconds() + of_samples);
        told = std::max(told.load(), now);
        return report_progress(work_.progress, told);
      };
      methods_[m]->refine(for_method(m, progress));
      before += seconds_[m];
    }
    if (before > 0.0) work_.share_of_refinement = before / (before + of_samples);
    work_.is_cut_short =
        std::ranges::any_of(work_.preparation.corrections,
                            [](const LightCorrection& done) { return done.share < 1.0; });
  }

 private:
  double all_seconds() const { return std::accumulate(seconds_.begin(), seconds_.end(), 0.0); }

  Preparation<N> for_method(std::size_t m, const Progress& progress) {
    const auto on_more_work = [this, m](double seconds) {
      constexpr double little = 1.2;
      double& expected = work_.statistics.expected_cpu_seconds;
      const double before = expected;
      seconds_[m] += seconds;
      expected += seconds;
      if (work_.options.on_notice && std::max(before, expected) > little * std::min(before, expected))
        work_.options.on_notice(
            printf_text("%s than expected: about %.*f CPU-s in all",
                        seconds > 0.0 ? "more work" : "less work", expected < 9.5 ? 1 : 0, expected));
    };
    return {with_.scene, with_.light, with_.camera,  with_.seen,
            with_.cache, progress,    with_.report, on_more_work};
  }

  const SubsurfaceMethods<N>& methods_;
  const Preparation<N>& with_;
  PictureWork& work_;
  std::vector<double> seconds_;
};

/// Says what the picture will take, and prepares its methods. @return  false if progress asked to
/// stop before there is light
template <int N>
bool prepare_light(const SubsurfaceMethods<N>& methods, const PathTracer<N>& tracer,
                   const CameraRays& camera, const SeenSurface& seen, PictureWork& work) {
  const RenderScene& scene = work.scene;
  RenderStatistics& statistics = work.statistics;
  LightCache cache(scene, work.options);
  const Preparation<N> with{scene, tracer, camera, seen, cache, work.progress, work.preparation};
  statistics.expected_cpu_seconds =
      cpu_seconds() - work.cpu_before +
      expected_cpu_seconds<N>(methods, with, tracer, share_of_pixels(scene.scene->film));
  statistics.expected_memory_mib = memory_mib() + picture_mib(work.film, work.options);
  if (work.options.on_notice) work.options.on_notice(describe(statistics, scene.settings));
  if (seen.count() == 0 && !translucent_materials_in_use(*scene.scene).empty())
    statistics.warnings.push_back(
        "the camera sees nothing translucent: does it look at the meshes, from outside?");
  LightMaker<N> maker(methods, with, work);
  const bool is_prepared = maker.prepare();
  if (is_prepared) {
    maker.refine();
    cache.save();
    say_corrections(work);
  }
  statistics.light_samples = work.preparation.light_samples;
  statistics.corrections = work.preparation.corrections;
  statistics.warnings.insert(statistics.warnings.end(), work.preparation.warnings.begin(),
                             work.preparation.warnings.end());
  report_profiles(*scene.scene, scene.settings, statistics);
  return is_prepared;
}

/// Adds the samples of all pixels. @return  whether it was completed
template <int N>
bool add_samples(const PathTracer<N>& tracer, const CameraRays& camera, PictureWork& work) {
  const Scene& scene = *work.scene.scene;
  const RenderSettings& settings = work.scene.settings;
  const RenderOptions& options = work.options;
  const IndexRange range = sample_range(settings, options);
  // A render that was asked to stop while light was refined still becomes a picture, of few samples:
  // test CorrectedTransport.MakesAPictureOfTheWalksSoFar.
  constexpr std::int64_t samples_cut_short = 4;
  const std::int64_t samples =
      work.is_cut_short ? std::min(range.size(), samples_cut_short) : range.size();
  const Progress progress = [&](double finished) {
    const double begin = work.share_of_refinement;
    return report_progress(work.progress, begin + (1.0 - begin) * finished) || work.is_cut_short;
  };
  const PixelRectangle area = rendered_area(scene.film);
  const auto sample = [&](int in_x, int in_y, int in_range) {
    const int x = area.x + in_x, y = area.y + in_y;
    const auto i = static_cast<int>(range.begin) + in_range;
    PixelSamples random(settings.seed, static_cast<std::uint32_t>(y * scene.film.width + x),
                        static_cast<std::uint32_t>(i));
    const Ray ray = camera.make_ray(x, y, random);
    CameraSample found = tracer.trace_camera_ray(ray, camera.pixel_angle(), random);
    if (settings.clamp > 0.0f) clamp_sample(settings.clamp, found);
    if (work.mattes) work.mattes->add(in_x, in_y, found);
    return found;
  };
  bool is_told = false;
  const auto on_checkpoint = [&](const std::string& why) {
    work.statistics.unkept = why;
    if (why.empty() || is_told || !options.on_notice) return;
    is_told = true;
    options.on_notice("warning: " + why + ": the samples so far are not kept, the work goes on");
  };
  const bool is_completed = add_tile_passes(
      sample,
      {.samples = static_cast<int>(samples),
       .goes_on_to = work.is_cut_short ? 0 : options.goes_on_to,
       .noise = settings.noise,
       .checkpoint = work.is_cut_short ? std::filesystem::path() : options.checkpoint,
       .key = checkpoint_key(work.key, settings, options),
       .light = light_key(work.preparation),
       .resumes = options.resumes,
       .keeps = options.keeps_samples,
       .on_image = options.on_image,
       .image_of =
           [&](const FilmAccumulator& so_far) {
             Image image = so_far.image(scene.film.has_alpha);
             if (work.mattes) (void)work.mattes->add_to(image, scene);
             return image;
           },
       .on_checkpoint = on_checkpoint,
       .between_images = std::chrono::duration<double>(options.seconds_between_images)},
      progress, work.film);
  return is_completed && !work.is_cut_short;
}

/// @return  whether it was completed
template <int N>
bool trace_passes(const BandSet& bands, PictureWork& work) {
  const RenderScene& scene = work.scene;
  const Film& film = scene.scene->film;
  const BandConversion<N> conversion =
      make_band_conversion<N>(bands, weights_of_bands(*scene.scene, bands));
  const ThinSheets<N> sheets = make_thin_sheets<N>(*scene.scene);
  const Coverings<N> coverings = make_coverings<N>(scene);
  const CameraRays camera(scene.scene->camera, film.width, film.height);
  const SeenSurface seen = find_seen_surface<N>(scene, conversion, sheets, coverings, camera);
  const SubsurfaceMethods<N> methods =
      make_subsurface_methods<N>(scene, conversion, work.options, work.progress);
  const LayeredMaterials<N> layered = make_layered_materials<N>(scene, conversion);
  const PathTracer<N> tracer(
      {scene,
       conversion,
       methods,
       layered,
       sheets,
       coverings,
       {.max_bounces = scene.settings.max_bounces, .direct_light = work.options.direct_light}});
  const bool is_prepared = prepare_light(methods, tracer, camera, seen, work);
  if (!is_prepared) return false;
  if (work.options.only_prepares || (work.options.part && work.is_cut_short))
    return !work.is_cut_short;
  if (!work.options.checkpoint.empty() || work.options.part)
    work.key = picture_key(*scene.scene, scene.settings, work.options);
  return add_samples(tracer, camera, work);
}

/// @throws InvalidInput if the size or a setting is out of its range, or they do not go together
void check_request(const Scene& scene, const RenderOptions& options) {
  const auto require = [](bool holds, const std::string& rule, double value) {
    if (!holds) throw InvalidInput(rule + ", but is " + number_text(value));
  };
  require(scene.film.width >= 1 && scene.film.width <= 65536, "film: width must lie in [1, 65536]",
          scene.film.width);
  require(scene.film.height >= 1 && scene.film.height <= 65536,
          "film: height must lie in [1, 65536]", scene.film.height);
  require(scene.render.samples_per_pixel >= 1 && scene.render.samples_per_pixel <= (1 << 24),
          "render: samples_per_pixel must lie in [1, 16777216]", scene.render.samples_per_pixel);
  require(scene.render.max_bounces >= 0, "render: max_bounces must be >= 0",
          scene.render.max_bounces);
  require(scene.render.noise >= 0.0f && scene.render.noise <= 1.0f,
          "render: noise must lie in [0, 1]", static_cast<double>(scene.render.noise));
  require(scene.render.clamp >= 0.0f, "render: clamp must be >= 0",
          static_cast<double>(scene.render.clamp));
  const PixelRectangle area = rendered_area(scene.film);
  require_inside(area, scene.film.width, scene.film.height, "film: the region");
  if (scene.film.region)
    require(scene.render.noise == 0.0f,
            "render: noise must be 0 with a region, whose pixels are those of the whole picture",
            static_cast<double>(scene.render.noise));
  check_part(scene, options);
  if (options.has_mattes && options.part) throw InvalidInput("render: a part has no mattes");
  if (options.has_mattes && options.resumes)
    throw InvalidInput("render: mattes are of all samples, so they do not go with going on");
  require_honoured(scene);
}

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu_before = cpu_seconds();
  check_request(scene, options);
  RenderResult result;
  auto& statistics = result.statistics;
  const auto [settings, why_method] = choose_settings(scene, options);
  statistics.method = settings.method;
  statistics.why_method = why_method;
  statistics.is_corrected = settings.is_corrected;
  statistics.warnings = warnings_of_small_bodies(scene, settings);
  const BandSet bands = common_bands(scene);
  const RenderScene prepared(scene, settings, options.kept);
  const PixelRectangle area = rendered_area(scene.film);
  FilmAccumulator film(area.width, area.height);
  std::optional<MatteFilm> mattes;
  if (options.has_mattes) mattes.emplace(area.width, area.height);
  const auto measure = [&] {
    statistics.cpu_seconds = cpu_seconds() - cpu_before;
    statistics.peak_memory_mib = peak_memory_mib();
    statistics.wall_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  PictureWork work{prepared,  options, progress, cpu_before, film, mattes ? &*mattes : nullptr,
                   statistics};
  statistics.is_complete = (bands.size() <= 4   ? trace_passes<4>
                            : bands.size() <= 8 ? trace_passes<8>
                                                : trace_passes<16>)(bands, work);
  measure();
  if (options.only_prepares) return result;
  if (film.least_samples() == 0) throw Interrupted();  // no picture yet
  statistics.samples_per_pixel = film.mean_samples();
  if (options.part) {
    if (statistics.is_complete) save_part(scene, settings, options, work.key, statistics, film);
    return result;
  }
  result.image = film.image(scene.film.has_alpha);
  const std::vector<bool> is_measured = measured_pixels(film.covers());
  statistics.relative_noise = relative_noise(result.image, is_measured);
  statistics.relative_noise_rms = relative_noise_rms(result.image, is_measured);
  result.notes = picture_notes(scene, statistics.method);
  if (mattes)
    std::ranges::move(mattes->add_to(result.image, scene), std::back_inserter(result.notes));
  measure();
  return result;
}

}  // namespace lamina
