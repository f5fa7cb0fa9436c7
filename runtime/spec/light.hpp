// The words for lights, the same in every program (docs/conventions.md): from infinity a environment map file
// (.hdr, .exr), constant:R,G,B and sun:AZ,EL,ANGLE,R[,G,B]; in the scene sphere:X,Y,Z,RADIUS,R[,G,B] and
// disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]. Comes in: the text of one --light option. Goes out: a Light, every
// number finite and in its range. Radiance is linear Rec.709 in W/(m² sr) up to one global scale; angles are
// degrees, azimuth and elevation say where the light stands (azimuth 0 on +Z, 90 on +X); places are metres of
// the world. Errors quote the word and show the form that was expected. No file is opened here: environment
// map.hpp does that.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::spec {

// Light from all directions at infinity, as a picture of the sphere.
struct EnvironmentMapLight {
  std::filesystem::path file;
  std::optional<sh::ImageLayout> layout;  // --light-layout; otherwise recognised by the picture's shape
};

// The same radiance from every direction.
struct ConstantLight {
  glm::vec3 radiance{1.0f};
};

// A disc of uniform radiance at infinity.
struct SunLight {
  float azimuth_deg = 0.0f;
  float elevation_deg = 0.0f;  // -90..90
  float angle_deg = 0.0f;      // angular radius, 0 < angle <= 180 (half the sky at 90)
  glm::vec3 radiance{1.0f};
};

// A sphere of uniform radiance that stands in the scene. It is seen by surfaces only: a camera looks through
// it, and it casts no shadow. Radius 0 gives no light.
struct SphereLight {
  glm::vec3 position_ws{0.0f};
  float radius_m = 0.0f;  // >= 0
  glm::vec3 radiance{1.0f};
};

// A flat disc of uniform radiance that shines to one side, as SphereLight otherwise.
struct DiscLight {
  glm::vec3 position_ws{0.0f};
  glm::vec3 normal_ws{0.0f, -1.0f, 0.0f};  // unit, the way that it shines
  float radius_m = 0.0f;                   // >= 0
  glm::vec3 radiance{1.0f};
};

using Light = std::variant<EnvironmentMapLight, ConstantLight, SunLight, SphereLight, DiscLight>;

// Those that stand in the scene.
using LocalLight = std::variant<SphereLight, DiscLight>;

// Where no light is asked for: a blue sky's worth of constant light and a soft sun, about radiance 1 on a
// white surface that faces it.
inline constexpr std::array<const char*, 2> kDefaultLights = {"constant:0.35,0.42,0.55",
                                                              "sun:35,45,6,100,92,80"};

Result<Light> parseLight(std::string_view word);

// The lights that stand in the scene, in their order; the others are loadDistantLights'.
std::vector<LocalLight> localLights(std::span<const Light> lights);

// --light-layout: lat-long, angular-map or vertical-cross.
Result<sh::ImageLayout> parseLightLayout(std::string_view word);

// Unit direction towards (azimuth, elevation): (0, 0) is +Z, (90, 0) is +X, (any, 90) is +Y.
glm::vec3 directionFromAzimuthElevation(float azimuth_deg, float elevation_deg);

}  // namespace lambent::spec
