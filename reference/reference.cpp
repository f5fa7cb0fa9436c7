#include "reference/reference.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "baker/import/scene.hpp"
#include "baker/jobs/parallel.hpp"
#include "reference/camera.hpp"
#include "reference/film.hpp"
#include "reference/light_cache.hpp"
#include "reference/options.hpp"
#include "reference/traced_scene.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/gltf_types.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker::reference {

namespace {

// Says beforehand how much memory a picture needs, so that one that is too large is refused before hours of
// tracing, and not ended by the system in the middle. Bytes are those of the whole program.

// A checkpoint is put together before it is written; the picture and its coded bytes take less, 20 + 20.
constexpr std::uint64_t kBytesOfResult = Film::kBytesOfPixel;
// A triangle takes so much with Embree's hierarchy. It was measured on scans of 90 and 270 thousand
// triangles.
constexpr std::uint64_t kBytesOfTriangle = 130;
constexpr std::uint64_t kBytesOfAnyScene = 6'000'000;  // Embree itself, threads and constant light

std::uint64_t bytesOfVertices(const bundle::MeshData& mesh) {
  std::uint64_t bytes_of_one = 2 * sizeof(glm::vec3);
  for (const auto* texcoords : {&mesh.texcoords0, &mesh.texcoords1})
    if (!texcoords->empty()) bytes_of_one += sizeof(glm::vec2);
  if (!mesh.colors.empty()) bytes_of_one += sizeof(glm::vec4);
  if (!mesh.tangents.empty()) bytes_of_one += sizeof(glm::vec4);
  return bytes_of_one * mesh.positions.size();
}

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.0f} MB", 1e-6 * static_cast<double>(bytes));
}

// Returns the bytes of the samples' sums, and of the picture or a checkpoint beside them.
std::uint64_t bytesOfPicture(const spec::Size& size) {
  return std::uint64_t{size.width} * size.height * (Film::kBytesOfPixel + kBytesOfResult);
}

// Returns about the bytes of the scene as it is traced: surfaces and the ray hierarchy, without textures.
std::uint64_t bytesOfTracing(const Scene& scene) {
  std::uint64_t bytes = kBytesOfAnyScene;
  for (const gltf::Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const ScenePrimitive& primitive : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives)
      bytes += bytesOfVertices(primitive.mesh) + kBytesOfTriangle * (primitive.mesh.indices.size() / 3);
  }
  return bytes;
}

// Fails if `more` bytes beside what the program has now come to more than the options allow. `what` needs
// them, as "a picture of 64 x 64".
Result<void> checkMemory(const Options& options, std::uint64_t more, const std::string& what) {
  const std::uint64_t allowed = options.memory_bytes != 0 ? options.memory_bytes : machineBytes();
  const std::uint64_t needed = residentBytes() + more;
  if (allowed == 0 || needed <= allowed) return {};
  return fail("--max-memory",
              fmt::format("{} takes about {}, and {} {}", what, megabytes(needed), megabytes(allowed),
                          options.memory_bytes != 0 ? "are allowed" : "are in this machine"),
              "ask for a smaller picture, or allow more");
}

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kCheckpointEvery = std::chrono::seconds(10);

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct SampleCounts {
  std::uint32_t per_pixel, in_pass;
};

// Renders the picture pass by pass, and writes a checkpoint every few seconds and when stopped.
Result<void> renderAll(const Integrator& integrator, Film& film, const SampleCounts& samples,
                       const fs::path& checkpoint, Progress& progress, const std::stop_token& stop) {
  const double seconds_before = film.seconds;
  const Clock::time_point begin = Clock::now();
  Clock::time_point saved = begin;
  const auto save = [&]() -> Result<void> {
    film.seconds = seconds_before + secondsSince(begin);
    saved = Clock::now();
    if (checkpoint.empty()) return {};
    return film.save(checkpoint);
  };
  for (std::uint32_t pass = 0; pass < samples.per_pixel; pass += samples.in_pass)
    for (std::uint32_t row = 0; row < film.size().height; row += kRowsAtOnce) {
      const Rows rows{row, std::min(row + kRowsAtOnce, film.size().height)};
      const bool whole = addSamples(integrator, film, rows,
                                    std::min(samples.per_pixel, pass + samples.in_pass), progress, stop);
      if (!whole || Clock::now() - saved > kCheckpointEvery)
        if (auto done = save(); !done) return done;
      if (!whole)
        return checkpoint.empty() ? fail("reference", "stopped")
                                  : fail(checkpoint.string(), "stopped; keeps the samples so far",
                                         "run the same words again to go on");
    }
  film.seconds = seconds_before + secondsSince(begin);
  return {};
}

Result<void> checkOutput(const fs::path& output) {
  if (output.empty()) return {};
  if (output.extension() != ".exr")
    return fail(output.string(), "is not an .exr", "name the picture OUT.exr");
  if (auto file = AtomicFile::open(output); !file) return failAgain(std::move(file.error()));
  return {};
}

void takeUp(Film& film, const fs::path& checkpoint, bool force, Report& report) {
  std::error_code ignored;
  if (checkpoint.empty() || force || !fs::exists(checkpoint, ignored)) return;
  if (film.restore(checkpoint)) {
    report.resumed_samples = film.done(0);
    for (std::uint32_t y = 1; y < film.size().height; ++y)
      report.resumed_samples = std::min(report.resumed_samples, film.done(y));
    return;
  }
  report.notices.push_back(
      checkpoint.string() +
      ": is damaged, or of another version, scene or other words; the picture is begun anew");
}

Result<Report> renderHere(const Scene& scene, const Request& request, const fs::path& output, bool force,
                          Progress& progress, const std::stop_token& stop) {
  const Options& options = request.options;
  if (auto checked = checkOptions(options); !checked) return failAgain(std::move(checked.error()));
  if (auto checked = checkOutput(output); !checked) return failAgain(std::move(checked.error()));
  Report report;
  const std::uint64_t of_picture = bytesOfPicture(options.size);
  const std::string picture = fmt::format("a picture of {} x {}", options.size.width, options.size.height);
  if (auto fits = checkMemory(options, of_picture + bytesOfTracing(scene), picture); !fits)
    return failAgain(std::move(fits.error()));
  // Load the light, and build the scene in world space.
  progress.begin("scene");
  const auto loaded = loadEach(request.lights);
  if (!loaded) return failAgain(loaded.error());
  spec::DistantLights lights = together(*loaded, request.light_factors);
  addLights(lights, request.more_light.get());
  report.notices = lights.notices;
  const std::vector<spec::LocalLight> shapes = spec::localLights(request.lights, scene.origin);
  const auto traced = TracedScene::build(scene);
  if (!traced) return failAgain(traced.error());
  report.notices.insert(report.notices.end(), (*traced)->notices().begin(), (*traced)->notices().end());
  if (auto fits = checkMemory(options, of_picture, picture); !fits)  // textures and light are there now
    return failAgain(std::move(fits.error()));
  const auto view = viewOf(scene, (*traced)->surfaces(), request);
  if (!view) return failAgain(view.error());
  Film film(options.size, digestOf(scene, lights, shapes, *view, options));
  const Environment environment(std::move(lights), options.rotate_light_deg,
                                options.band_limit ? options.band_limit->in : 0);
  // Resume an earlier run.
  const fs::path checkpoint = checkpointOf(output);
  takeUp(film, checkpoint, force, report);
  std::uint64_t left = 0;
  for (std::uint32_t y = 0; y < options.size.height; ++y)
    left += std::uint64_t{options.size.width} * (options.spp - film.done(y));
  // Trace the paths.
  progress.begin("paths", left, "samples");
  const World world = (*traced)->under(environment, shapes, EyeRays(*view, options.size));
  auto done = renderAll(Integrator(world, options), film,
                        {options.spp, samplesInPass(options, world.volumes)}, checkpoint, progress, stop);
  if (!done) return failAgain(std::move(done.error()));
  report.image = film.image();
  report.rays = film.rays();
  report.seconds = film.seconds;
  report.standard_error = film.standardError();
  if (output.empty()) return report;
  if (auto written = spec::writeExr(output, report.image); !written)
    return failAgain(std::move(written.error()));
  std::error_code ignored;
  fs::remove(checkpoint, ignored);
  return report;
}

}  // namespace

void poseAt(Scene& scene, float time_s) {
  if (scene.animations.empty())
    scene.warnings.emplace_back("It has no animations: it looks the same at all times.");
  gltf::applyAnimations(scene.animations, time_s, scene.nodes);
}

Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces, const Request& request) {
  if (request.view) return *request.view;
  return viewOf(scene, surfaces, request.nodes_at_rest.empty() ? scene.nodes : request.nodes_at_rest,
                request.camera, request.options.size.aspect());
}

fs::path checkpointOf(const fs::path& output) {
  if (output.empty()) return {};
  fs::path checkpoint = output;
  checkpoint += ".partial";
  return checkpoint;
}

Result<Report> render(const Scene& scene, const Request& request, const fs::path& output, bool force,
                      Progress& progress, const std::stop_token& stop) {
  Result<Report> report;
  withThreads(request.options.threads,
              [&] { report = renderHere(scene, request, output, force, progress, stop); });
  progress.end();
  return report;
}

namespace {

// The length of a list is hashed, too, so that different inputs differ. Only types without padding are
// allowed.
class Digest {
 public:
  template <typename... T>
  void add(const T&... values) {
    (addOne(values), ...);
  }
  template <typename T>
  void addList(const std::vector<T>& list) {
    addOne(list.size());
    addOne(bundle::checksum(std::as_bytes(std::span(list))));
  }
  std::uint64_t value() const { return bundle::checksum(bytes_); }

 private:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void addOne(const T& value) {
    const auto raw = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  std::vector<std::byte> bytes_;
};

void add(const gltf::TextureRef& ref, Digest& digest) {
  digest.add(ref.texture, ref.texcoord, ref.offset, ref.scale, ref.rotation_rad);
}

// The fields for reflection are hashed between the other values and the other textures.
void add(const gltf::Material& material, Digest& digest) {
  const auto addValues = [&](bool reflection) {
    gltf::forEachMaterialValue([&](const auto& field) {
      if ((field.part == gltf::MaterialPart::Reflection) == reflection) digest.add(material.*field.member);
    });
  };
  const auto addTextures = [&](bool reflection) {
    gltf::forEachMaterialTexture([&](const auto& field) {
      if ((field.part == gltf::MaterialPart::Reflection) == reflection) add(material.*field.member, digest);
    });
  };
  addValues(false), addValues(true);
  addTextures(true), addTextures(false);
}

void add(const Scene& scene, Digest& digest) {
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    digest.add(world[n], scene.nodes[n].mesh, scene.nodes[n].light);
  for (const SceneMesh& mesh : scene.meshes) {
    digest.add(mesh.primitives.size());
    for (const ScenePrimitive& primitive : mesh.primitives) {
      const bundle::MeshData& data = primitive.mesh;
      digest.add(primitive.material);
      digest.addList(data.positions), digest.addList(data.normals), digest.addList(data.normal_weights);
      digest.addList(data.texcoords0);
      digest.addList(data.texcoords1), digest.addList(data.colors), digest.addList(data.tangents);
      digest.addList(data.indices);
    }
  }
  for (const gltf::Material& material : scene.materials) add(material, digest);
  for (const MeasuredBrdf& brdf : scene.brdfs) digest.addList(brdf.measurements);
  for (const gltf::Texture& texture : scene.textures)
    digest.add(texture.image, texture.sampler.wrap_s, texture.sampler.wrap_t, texture.sampler.mag_filter);
  for (const SceneImage& image : scene.images) digest.addList(image.file_bytes);
  digest.add(scene.volumes.size());
  for (const SceneVolume& volume : scene.volumes) {
    digest.add(volume.node, volume.size, volume.node_from_grid, volume.albedo, volume.g);
    digest.addList(volume.density);
  }
  for (const gltf::Light& l : scene.lights)
    digest.add(l.type, l.color, l.intensity, l.range_m, l.inner_cone_rad, l.outer_cone_rad);
}

void add(const spec::DistantLights& lights, Digest& digest) {
  digest.add(lights.constant, lights.discs.size());
  for (const spec::Disc& disc : lights.discs) digest.add(disc.direction, disc.radius_rad, disc.radiance);
  for (const spec::EnvironmentMap& environment_map : lights.environment_maps) {
    digest.add(environment_map.layout, environment_map.image.width, environment_map.image.height);
    digest.addList(environment_map.image.texels);
  }
}

void add(const std::vector<spec::LocalLight>& shapes, Digest& digest) {
  digest.add(shapes.size());
  for (const spec::LocalLight& shape : shapes) {
    digest.add(shape.index());
    if (const auto* sphere = std::get_if<spec::SphereLight>(&shape))
      digest.add(sphere->position_ws, sphere->radius_m, sphere->radiance);
    else if (const auto* disc = std::get_if<spec::DiscLight>(&shape))
      digest.add(disc->position_ws, disc->normal_ws, disc->radius_m, disc->radiance);
  }
}

}  // namespace

std::uint64_t digestOf(const Scene& scene, const spec::DistantLights& lights,
                       const std::vector<spec::LocalLight>& shapes, const spec::View& view,
                       const Options& options) {
  Digest digest;
  for (const char c : std::string_view(LAMBENT_VERSION " " LAMBENT_ISA)) digest.add(c);
  add(scene, digest);
  add(lights, digest);
  add(shapes, digest);
  digest.add(view.view_from_world, view.clip_from_view);
  const BandLimit limit = options.band_limit.value_or(BandLimit{.in = 0, .out = {}});
  digest.add(options.size.width, options.size.height, options.spp, options.seed, limit.in,
             limit.out.value_or(0), options.bounces.has_value(), options.bounces.value_or(0),
             options.rotate_light_deg);
  return digest.value();
}

}  // namespace lambent::baker::reference
