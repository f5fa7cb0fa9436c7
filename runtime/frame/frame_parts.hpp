// Holds what the passes of a frame keep from step to step. Most parts are read by later passes: lights of
// groups, shaded samples, shadow maps. What is marked (before) is also read by earlier passes, which see what
// the step before left, because light between bodies travels once per step. Parts refer to each other, so
// they stay where they are made. Render thread only.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/volume/volume.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/light_plan/light_plan.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/surface/proxy_lods.hpp"
#include "runtime/surface/reflection_probes.hpp"
#include "runtime/surface/surfaces.hpp"
#include "runtime/tone_map/tone_mapper.hpp"
#include "runtime/world/frame_times.hpp"

namespace lambent::frame {

// Sums up how the light that a group sends out has changed.
struct SentLight {
  std::uint64_t version = 0, light = 0;
  double bounced = 0.0, drift = 0.0;
};

// Rooms are rigid groups that hide most of the sky and have mirrors in them, which reflection probes serve.
struct Rooms {
  KeyShadows keys;                             // for captures
  std::vector<std::vector<glm::vec3>> places;  // of each group, in its frame
  std::vector<std::uint8_t> stale;             // of each probe: it must be captured
  std::size_t next = 0;                        // the probe that was looked at last
  ChangeGate<std::uint64_t, std::uint64_t, std::uint64_t, std::uint32_t> found_from;
  ChangeGate<std::uint64_t, std::size_t, std::uint32_t> places_from;
  ChangeGate<std::vector<std::uint64_t>, FrameSettings> captured_from;
};

struct FrameParts {
  // The step: upload.
  UploadPacer pacer;
  std::optional<std::chrono::steady_clock::time_point> rendered;  // time of the last picture
  std::uint64_t uploaded_bytes = 0;                               // since the last picture

  // Light at light probes, and bounces by patches.
  LightPlan plan;
  std::optional<lighting::IncidentLight> incident;  // (before); made once there is something to sample
  lighting::GroupLights group_lights;
  ChangeGate<bool, bool, bool, float> carriers_changed;  // settings that choose carriers
  ChangeGate<std::uint64_t> proxies_changed;             // version that the captures have
  int capture_order = 0;
  PatchBounces bounces;

  // Transfer at samples, vertices and grids.
  evaluate::Samples samples;
  effects::diffuse::Diffuse diffuse;
  evaluate::SeenSky seen_sky;
  Neighborhoods neighborhoods;  // (before)
  bool neighborhoods_shown = true;

  // Light between bodies.
  effects::diffuse::Proxies proxies;
  KeyedState<SentLight> sent;
  ChangeGate<std::uint64_t> structure_changed;  // residency, since the last captures
  bool waited = false;  // whether the last step drew no captures because the structure changed

  // The picture: what surfaces look up per pixel.
  lighting::Sky sky;
  LocalShadows local_shadows;
  KeyShadows key_shadows;
  std::optional<lighting::PrefilteredEnvironment> prefiltered;
  bool prefiltered_shown = true;
  ChangeGate<std::uint64_t> prefiltered_from;
  Rooms rooms;

  // Surfaces, volumes and what is laid over them.
  Surfaces surfaces;
  ProxyLods proxy_lods;
  std::optional<DataView> data_view;  // made while a view shows transfer
  effects::volume::Volume volume;
  effects::volume::March march;
  ToneMapper tone_mapper;
  std::optional<Overlays> overlays;  // made while any are shown
  std::optional<DataView> wires;     // made while a view shows wires
  ChangeGate<std::uint64_t> targets_changed;

  // Modules of surfaces, in the order in which their functions are called.
  NeighborhoodModule change_at_pixels{neighborhoods, neighborhoods_shown, /*at_vertices=*/false};
  NeighborhoodModule change_at_vertices{neighborhoods, neighborhoods_shown, /*at_vertices=*/true};
  SpecularEnvironmentModule specular_environment{prefiltered, prefiltered_shown};
  ReflectionProbes probes{specular_environment};
  SurfaceModules modules = {&bounces,       &change_at_pixels, &change_at_vertices,
                            &local_shadows, &key_shadows,      &specular_environment,
                            &probes};

  FrameParts(const FrameOptions& options, lighting::Sky made_sky)
      : sky(std::move(made_sky)),
        surfaces(/*finest_texels=*/options.linear(), modules),
        volume(/*precise=*/options.linear()),
        tone_mapper(samplesOf(options.output), options.linear()) {}
  FrameParts(const FrameParts&) = delete;
  FrameParts& operator=(const FrameParts&) = delete;
};

}  // namespace lambent::frame
