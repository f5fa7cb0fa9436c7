// Describes what overlays read of a frame, as references that are valid during one draw. Types only.
#pragma once

#include "runtime/effects/diffuse/proxies.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/tone_map/tone_mapper.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct OverlayScene {
  World& world;
  const lighting::Environment& environment;
  const lighting::Sky& sky;
  const LitScene& lit_scene;
  const lighting::GroupLights& lights;
  const Neighborhoods& neighborhoods;
  const KeyShadows& key_shadows;
  const effects::diffuse::Proxies& proxies;
  const ToneMapper& tone_mapper;
  const spec::View& view;
  spec::Size size;
};

}  // namespace lambent::frame
