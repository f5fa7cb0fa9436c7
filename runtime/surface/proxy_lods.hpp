// Draws bundles whose surfaces do not fit into memory or have not arrived. It shows the finest capture proxy
// of each rigid group, every triangle in one colour: its albedo times E/pi at its normal, plus the current
// emission of its lamp. Its light is that of the environment and of the local lights outside the group, in
// bands 0..2 and without shadows, like that of surfaces whose transfer has not arrived. It takes the world's
// proxy levels of detail and the light, and draws into the bound framebuffer. Triangles come and go group by
// group. If all surfaces are resident, nothing is made or drawn. Fails if a shader does not compile on this
// device.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/gpu/arena.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/local_light.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/proxy_lod_shared.h"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct ProxyLodOptions {
  std::uint32_t order = 5;  // largest number of bands of the light
  sh::Window window = sh::Window::Off;
  bool diffuse = true;  // false: only emission is shown
  bool operator==(const ProxyLodOptions&) const = default;
};

class ProxyLods {
 public:
  ProxyLods();

  // `lights` are those that stand in the scene.
  Result<void> prepare(const World& world, const lighting::Environment& environment,
                       std::span<const lighting::LocalLight> lights, const ProxyLodOptions& options,
                       gpu::Counters& counters);
  Result<void> draw(const spec::View& view, gpu::Counters& counters);

 private:
  // Describes a group in a slot of the table of groups.
  struct Body {
    std::uint64_t id = 0;  // id of its proxies
    std::uint32_t bundle = 0;
    bundle::GroupIndex group;
    gpu::Allocation triangles;     // empty: the slot is free
    std::vector<glm::vec3> lamps;  // strengths of its lamps, as its triangles show them
  };
  // Describes the multi-draw for a page of triangles.
  struct Batch {
    std::vector<GLint> first;
    std::vector<GLsizei> count;
  };
  // Uploads new triangles and removes those that are gone.
  Result<void> follow(const World& world, gpu::Counters& counters);
  Result<void> bring(const World& world, const ProxyLod& proxy_lod, bundle::GroupIndex group,
                     gpu::Counters& counters);
  void write(Body& body, std::uint32_t slot, const bundle::CaptureProxy& proxy, gpu::Counters& counters);
  void light(const World& world, const lighting::Environment& environment,
             std::span<const lighting::LocalLight> lights, const ProxyLodOptions& options,
             gpu::Counters& counters);

  gpu::Programs programs_;
  gpu::VertexArray no_vertices_;
  std::vector<Body> bodies_;
  std::map<std::pair<std::uint64_t, bundle::GroupIndex>, std::uint32_t> slots_;  // keyed by id
  std::map<std::uint32_t, Batch> batches_;                                       // keyed by page
  std::array<sh::CachedWindow, sh::kMaxOrder + 1> windows_;  // of the environment, indexed by order
  ChangeGate<std::uint64_t> proxy_lods_changed_;
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t> scene_changed_;  // lamps, local lights, transforms
  ChangeGate<std::uint64_t, ProxyLodOptions> light_changed_;
  gpu::Arena triangles_;
  gpu::Table groups_table_, view_;
};

}  // namespace lambent::frame
