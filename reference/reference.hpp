// The room reference draws path-traced pictures of glTF scenes, to measure the runtime against: with the same
// scene, lights, camera and conventions, but an integrator, a sampler and rays of its own, so that no mistake
// of the bake can hide in both. The scene, parsed lights and camera, and options come in. OUT.exr goes out:
// linear float32 RGBA, signed, where alpha is coverage (of volumes, the share of what is behind that they
// take away), and depths. While it works, OUT.exr.partial holds what is done; the same command resumes it and
// ends with the same bytes. They are also the same for any number of threads.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"
#include "reference/options.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

class Surfaces;

struct Request {
  std::vector<spec::Light> lights = {};
  // Without it, the file's first camera is used, else an orbit that frames the scene.
  std::optional<spec::Camera> camera = {};
  Options options = {};
  // Orbits use these places of the nodes before poseAt; if empty, their present places are used.
  std::vector<gltf::Node> nodes_at_rest = {};
  std::optional<spec::View> view = {};  // used instead of a camera, for an eye that moves freely
  // These multiply the radiance of each light from infinity; lights beyond the list have 1.
  std::vector<float> light_factors = {};
  // This is more light from infinity, in the frame of the lights, for light that no word describes, such as
  // key lights that were moved.
  std::shared_ptr<const spec::DistantLights> more_light = {};
};

struct Report {
  spec::RgbaImage image;
  std::uint64_t rays = 0;
  double seconds = 0.0;                  // time of tracing, over all runs that it took
  std::uint32_t resumed_samples = 0;     // samples per pixel that an earlier run had done
  std::optional<double> standard_error;  // of the pixels, relative to the picture; nothing for one sample
  std::vector<std::string> notices;      // what was repaired or left out, one sentence each
};

// Moves the nodes, which must be at rest, to where the scene's animations have them at time_s. Adds a warning
// to the scene if there is nothing to move.
void poseAt(Scene& scene, float time_s);

std::filesystem::path checkpointOf(const std::filesystem::path& output);

// Returns the request's eye; the picture's size gives the aspect of a camera.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces, const Request& request);

// Draws the scene with its nodes as they are. Without `output` it writes neither a checkpoint nor a picture.
// `force` ignores an earlier checkpoint. Errors: options, an environment map, a texture, no such camera, an
// output that cannot be written; or stopped, in which case the checkpoint keeps what is done.
Result<Report> render(const Scene& scene, const Request& request, const std::filesystem::path& output,
                      bool force, Progress& progress, const std::stop_token& stop);

}  // namespace lambent::baker::reference
