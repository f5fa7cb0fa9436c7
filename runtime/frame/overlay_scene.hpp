// What overlays see of a frame: references to what it has, for the time of one draw. Types only.
#pragma once

#include "runtime/effects/diffuse/proxies.hpp"
#include "runtime/frame/key_shadows.hpp"
#include "runtime/frame/lit_scene.hpp"
#include "runtime/frame/neighborhoods.hpp"
#include "runtime/frame/tone_mapper.hpp"
#include "runtime/frame/world.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

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
