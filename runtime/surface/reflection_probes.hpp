// Owns reflection probes: pictures of the lit scene in all directions from a few points inside rooms, with
// distances. Mirrors look up in them what they show of the room (reflection_probes.glsl), where the
// prefiltered environment alone would show the sky. A probe's picture has the room's radiance and coverage;
// the sky is not in it, because surfaces know it better. Roughness lies along its mip levels, as in the
// prefiltered environment. The owner chooses the places, draws the faces and says which draws look probes up.
// Render thread only. Fails if a kernel does not compile on this device.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/lighting/probe_places.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/reflection_probes_shared.h"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Adds what mirrors show of the environment beyond the few bands of light, if it has been prefiltered and is
// shown. It refers to what must outlive it.
class SpecularEnvironmentModule final : public SurfaceModule {
 public:
  SpecularEnvironmentModule(const std::optional<lighting::PrefilteredEnvironment>& environment,
                            const bool& shown);
  bool reaches(std::size_t, const SurfaceDraw&) const override { return on_ && environment_.has_value(); }
  std::uint64_t version() const override { return on_ && environment_ ? 1 : 0; }
  void bindFor(SurfaceReceiver) const override { environment_->bind(); }

 private:
  const std::optional<lighting::PrefilteredEnvironment>& environment_;
  const bool& on_;
};

// Shows the room in mirrors, where reflection probes know it, with the specular environment, whose function
// is called before.
class ReflectionProbes final : public SurfaceModule {
 public:
  // The environment must outlive it.
  explicit ReflectionProbes(const SpecularEnvironmentModule& environment);

  // Sets where probes are, at most kMostProbes. Those that stay where they were, in the same order, stay
  // captured.
  void place(std::vector<glm::vec3> places_ws);
  const std::vector<glm::vec3>& places() const { return places_; }
  // Sets which draws look probes up, by index in the residency.
  void showBy(std::vector<std::uint8_t> draws);
  bool reaches(std::size_t draw, const SurfaceDraw& record) const override {
    return !places_.empty() && draw < draws_.size() && draws_[draw] != 0 &&
           environment_.reaches(draw, record);
  }
  std::uint64_t version() const override { return layout_version_ + environment_.version(); }
  void bindFor(SurfaceReceiver receiver) const override;

  // Returns the voxels that the surfaces of a rigid group pass through, in the group's frame, from the meshes
  // that are resident. It is done once when a room arrives, and waits for the GPU.
  Result<lighting::SurfaceVoxels> voxelsOf(World& world, std::size_t group, gpu::Counters& counters);
  // Captures a probe: binds and clears a target for each face and calls `draw`, which draws what is opaque
  // and then what is blended. Depths are those of the view. While it draws, surfaces look no probes up.
  Result<void> capture(std::size_t probe, float near_m, float far_m,
                       const std::function<Result<void>(const spec::View&, const spec::Size&)>& draw,
                       gpu::Counters& counters);

 private:
  void uploadBlock(bool looked_up);
  void makeTargets();
  Result<void> store(std::size_t probe, int face, const glm::mat4& clip_from_view, gpu::Counters& counters);
  Result<void> filter(std::size_t probe, gpu::Counters& counters);

  const SpecularEnvironmentModule& environment_;
  gpu::Programs kernels_;
  std::vector<lighting::ReflectedLobe> lobes_;  // one per level
  std::vector<glm::vec3> places_;
  std::vector<std::uint8_t> captured_;  // one per place
  std::vector<std::uint8_t> draws_;
  std::uint64_t layout_version_ = 0;
  gpu::Texture images_;  // see ProbeValues
  gpu::Texture drawn_, depth_, weighted_, weights_;
  gpu::Framebuffer target_;
  gpu::Table block_, angles_;
};

}  // namespace lambent::frame
