// A path-traced picture of a glTF scene, to measure the runtime against: the same scene, lights, camera and
// conventions, but an integrator, a sampler and rays of its own, so that a mistake in the bake cannot hide in
// both. Comes in: the scene, the lights and camera as parsed, options. Goes out: OUT.exr, linear float32
// RGBA, signed, alpha = coverage, of volumes what they take away of what is behind; and depths. While it
// works, OUT.exr.partial holds what is done; asked again in the same words, the work goes on from there and
// ends in the same bytes. The same bytes too for any number of threads.
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
  std::optional<spec::Camera> camera = {};  // none: the file's first, else an orbit that frames the scene
  Options options = {};
  // Where the scene's nodes stand before poseAt, by which orbits stand; empty: where they stand now.
  std::vector<gltf::Node> nodes_at_rest = {};
  std::optional<spec::View> view = {};  // counts instead of a camera: an eye that moves freely
  // By which the radiance of each light from infinity is multiplied; of lights beyond the list 1.
  std::vector<float> light_factors = {};
  // Light from infinity beside that of `lights`, in the lights' own frame: what no word says, as key lights
  // that were moved.
  std::shared_ptr<const spec::DistantLights> more_light = {};
};

struct Report {
  spec::RgbaImage image;
  std::uint64_t rays = 0;
  double seconds = 0.0;                  // of tracing, over all runs that it took
  std::uint32_t resumed_samples = 0;     // a pixel, that an earlier run had done
  std::optional<double> standard_error;  // of the pixels, relative to the picture; none for one sample
  std::vector<std::string> notices;      // what was repaired or put aside, a sentence each
};

// Moves the nodes to where the scene's animations have them at time_s; until then it stands at rest. Warns in
// the scene where there is nothing to move.
void poseAt(Scene& scene, float time_s);

std::filesystem::path checkpointOf(const std::filesystem::path& output);

// Where the request's eye is; the picture's size tells the aspect of a camera.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces, const Request& request);

// Of the scene as its nodes stand. Without output: neither a checkpoint nor a picture on disk. force: an
// earlier checkpoint does not count. Errors: options, a probe, a texture, no such camera, an output that
// cannot be written; stopped, with what is done kept in the checkpoint.
Result<Report> render(const Scene& scene, const Request& request, const std::filesystem::path& output,
                      bool force, Progress& progress, const std::stop_token& stop);

}  // namespace lambent::baker::reference
