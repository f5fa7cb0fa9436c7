// The room spec owns how all programs describe lights, cameras and picture sizes, and it reads and writes
// pictures. It has no GPU code and keeps no state; functions may be called from any thread and return an
// Error for bad input.
//
// This header parses lights, as docs/conventions.md describes them. Lights at infinity are environment map
// files (.hdr, .exr), constant:R,G,B and sun:AZ,EL,ANGLE,R[,G,B]. Local lights in the scene are
// sphere:X,Y,Z,RADIUS,R[,G,B] and disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]. Input is the text of one --light
// option; all numbers of the resulting Light are finite and in range. Radiance is linear Rec.709 in W/(m² sr)
// up to one global scale. Angles are in degrees; azimuth and elevation tell where the light stands (azimuth 0
// is +Z, 90 is +X). Positions are in world space, in metres. Errors quote the word and show the expected
// form. distant_lights.hpp opens the files.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::spec {

// Brighter light than this is refused, since sums over many lights and directions must stay finite.
inline constexpr float kMostRadiance = 1e15f;

// Describes light from all directions at infinity, as a picture of the sphere.
struct EnvironmentMapLight {
  std::filesystem::path file;
  std::optional<sh::ImageLayout> layout;  // --light-layout; by default the picture's shape decides
  bool operator==(const EnvironmentMapLight&) const = default;
};

// Describes light with the same radiance from every direction.
struct ConstantLight {
  glm::vec3 radiance{1.0f};
  bool operator==(const ConstantLight&) const = default;
};

// Describes a disc of uniform radiance at infinity.
struct SunLight {
  float azimuth_deg = 0.0f;
  float elevation_deg = 0.0f;  // -90..90
  float angle_deg = 0.0f;      // angular radius, 0 < angle <= 180; 90 is half the sphere of directions
  glm::vec3 radiance{1.0f};
  bool operator==(const SunLight&) const = default;
};

// Describes a sphere of uniform radiance in the scene. It lights surfaces, but is invisible to the camera and
// casts no shadow. Radius 0 gives no light.
struct SphereLight {
  glm::dvec3 position_ws{0.0};
  float radius_m = 0.0f;  // >= 0
  glm::vec3 radiance{1.0f};
  bool operator==(const SphereLight&) const = default;
};

// Describes a flat disc of uniform radiance that shines to one side, and otherwise behaves like SphereLight.
struct DiscLight {
  glm::dvec3 position_ws{0.0};
  glm::vec3 normal_ws{0.0f, -1.0f, 0.0f};  // unit, towards the side that shines
  float radius_m = 0.0f;                   // >= 0
  glm::vec3 radiance{1.0f};
  bool operator==(const DiscLight&) const = default;
};

using Light = std::variant<EnvironmentMapLight, ConstantLight, SunLight, SphereLight, DiscLight>;

// A light that stands in the scene.
using LocalLight = std::variant<SphereLight, DiscLight>;

// Default lights: constant light like a blue sky, and a soft sun that gives radiance of about 1 on a white
// surface that faces it.
inline constexpr std::array<const char*, 2> kDefaultLights = {"constant:0.35,0.42,0.55",
                                                              "sun:35,45,6,100,92,80"};

Result<Light> parseLight(std::string_view word);
// Parses the words of several --light options, and gives their environment maps the layout that
// --light-layout names; if that is empty, the pictures' shapes decide.
Result<std::vector<Light>> parseLights(std::span<const std::string> words, std::string_view layout_word = {});

// Returns the local lights in their order, with positions that count from the origin, in the world of the
// lights. loadDistantLights() handles the others.
std::vector<LocalLight> localLights(std::span<const Light> lights,
                                    const glm::dvec3& origin = glm::dvec3(0.0));

// Parses --light-layout: lat-long, angular-map or vertical-cross.
Result<sh::ImageLayout> parseLightLayout(std::string_view word);

// Returns the unit direction towards (azimuth, elevation): (0, 0) is +Z, (90, 0) is +X, (any, 90) is +Y.
glm::vec3 directionFromAzimuthElevation(float azimuth_deg, float elevation_deg);

// Rotates all lights about the vertical axis, as --rotate-light does. Positive degrees take +Z to +X about
// +Y, so D degrees move a sun at azimuth A to azimuth A + D.

Result<float> parseDegrees(std::string_view word);

// Returns the matrix that rotates directions of the light.
glm::mat3 lightRotation(float degrees);

// Parses edits of key lights that were found in an environment map. All programs write an edit as
// key:AZ,EL,TO_AZ,TO_EL,R[,G,B]. It moves the key light that was found at azimuth AZ and elevation EL to
// TO_AZ and TO_EL, and multiplies its radiance by R, G and B. fade-key:... edits the second set of lights.
// Angles are in degrees in the lights' own frame, as for sun:... in light.hpp. All numbers of a KeyEdit are
// finite and in range. Errors quote the word and show the expected form.

struct KeyEdit {
  std::size_t set = 0;                  // 0 for the first set of lights, 1 for the set that is faded to
  glm::vec3 found{0.0f, 1.0f, 0.0f};    // unit direction in which the light was found
  glm::vec3 towards{0.0f, 1.0f, 0.0f};  // unit direction to which it is moved
  glm::vec3 factor{1.0f};               // 0..kMostKeyFactor
  bool operator==(const KeyEdit&) const = default;
};

inline constexpr float kMostKeyFactor = 1e6f;

Result<KeyEdit> parseKeyEdit(std::string_view word);
// Returns the text of an edit, with angles rounded to a thousandth of a degree.
std::string keyEditWord(const KeyEdit& edit);

// azimuthElevation() is the inverse of directionFromAzimuthElevation() (light.hpp). Azimuths are in
// -180..180, and 0 for straight up and down.
struct AzimuthElevation {
  float azimuth_deg = 0.0f, elevation_deg = 0.0f;
};
AzimuthElevation azimuthElevation(const glm::vec3& direction);

}  // namespace lambent::spec
