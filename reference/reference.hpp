// Path-traces pictures of glTF scenes as a ground truth for the runtime. Scene, lights, camera and
// conventions are the same, but integrator, sampler and ray tracing are independent of the baker's, so that a
// mistake cannot hide in both. The scene, parsed lights and camera, and options come in. OUT.exr goes out:
// linear float32 RGBA, possibly negative, where alpha is coverage (for volumes, one minus transmittance), and
// depths. Work in progress is in OUT.exr.partial; running the same command again resumes it and gives the
// same bytes, for any number of threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

class Surfaces;

// Limits a picture to the lighting that precomputed transfer can represent. Distant light, and sphere and
// disc lights as seen from each point that they light, are cut to their first `in` SH bands, at the first hit
// and at bounces alike; a ray that hits no surface sees that light, however near the source is. Emissive
// surfaces and punctual lights are not limited. If `out` is given, the BRDF times the cosine at the first hit
// is replaced by its first `out` bands, and light from below the surface's plane is blocked if there is an
// occluder in the mirrored direction (docs/conventions.md, "Materials"). The phase function is cut in the
// same way where a volume scatters towards the eye. The sky that the eye sees, also through volumes, is not
// limited.
struct BandLimit {
  int in = 5;
  std::optional<int> out = {};
};

// Parses IN or IN,OUT, each 1..8.
Result<BandLimit> parseBandLimit(std::string_view word);

// All options but the number of threads and the memory affect the picture's bytes.
struct Options {
  spec::Size size = {};
  std::uint32_t spp = 256;  // samples per pixel, 1..kMaxSpp
  std::uint32_t seed = 0;   // different seeds give independent noise
  std::optional<BandLimit> band_limit = {};
  // Maximum number of reflections between surfaces; none: no limit. 0 means direct light, and single
  // scattering in volumes; with any other number scattering in volumes is not limited.
  std::optional<std::uint32_t> bounces = {};
  float rotate_light_deg = 0.0f;
  unsigned threads = 0;  // 0: as many as the machine has
  // Memory that the whole program may take; 0: all that the machine has. A picture that needs more is refused
  // (checkMemory() in reference.cpp).
  std::uint64_t memory_bytes = 0;
};

inline constexpr std::uint32_t kMaxSpp = 1u << 24;

// Errors: a number is outside its range.
Result<void> checkOptions(const Options& options);

struct Request {
  std::vector<spec::Light> lights = {};
  // If empty, the file's first camera is used, or else an orbit that frames the scene.
  std::optional<spec::Camera> camera = {};
  Options options = {};
  // The nodes before poseAt, whose bounds orbits use; if empty, the scene's nodes.
  std::vector<gltf::Node> nodes_at_rest = {};
  std::optional<spec::View> view = {};  // used instead of `camera`, for a view that no camera describes
  // Factors on the radiance of each distant light; missing ones are 1.
  std::vector<float> light_factors = {};
  // More distant light, in the frame of the lights, for light that no word describes, such as edited key
  // lights.
  std::shared_ptr<const spec::DistantLights> more_light = {};
};

struct Report {
  spec::RgbaImage image;
  std::uint64_t rays = 0;
  double seconds = 0.0;                  // tracing time, including resumed runs
  std::uint32_t resumed_samples = 0;     // samples per pixel of earlier runs
  std::optional<double> standard_error;  // of the pixels, relative; none for one sample per pixel
  std::vector<std::string> notices;      // what was repaired or left out, one sentence each
};

// Applies the scene's animations at time_s to its nodes, which must be at rest. Adds a warning to the scene
// if nothing is animated.
void poseAt(Scene& scene, float time_s);

std::filesystem::path checkpointOf(const std::filesystem::path& output);

// Returns the view of the request. The picture's size gives a camera's aspect ratio.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces, const Request& request);

// Renders the scene with its nodes as they are. If `output` is empty, neither a checkpoint nor a picture is
// written. `force` ignores an existing checkpoint. Errors: invalid options; an environment map or texture
// cannot be loaded; there is no such camera; the output cannot be written; the run was stopped (the
// checkpoint keeps what is done).
Result<Report> render(const Scene& scene, const Request& request, const std::filesystem::path& output,
                      bool force, Progress& progress, const std::stop_token& stop);

// Computes a hash of everything that decides a picture's bytes: scene, light, view, options and program. A
// checkpoint with the same digest can be resumed.

std::uint64_t digestOf(const Scene& scene, const spec::DistantLights& lights,
                       const std::vector<spec::LocalLight>& shapes, const spec::View& view,
                       const Options& options);

}  // namespace lambent::baker::reference
