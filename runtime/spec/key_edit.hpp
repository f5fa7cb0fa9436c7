// Parses edits of key lights that were found in an environment map. All programs write an edit as
// key:AZ,EL,TO_AZ,TO_EL,R[,G,B]. It moves the key light that was found at azimuth AZ and elevation EL to
// TO_AZ and TO_EL, and multiplies its radiance by R, G and B. fade-key:... edits the second set of lights.
// Angles are in degrees in the lights' own frame, as for sun:... in light.hpp. All numbers of a KeyEdit are
// finite and in range. Errors quote the word and show the expected form.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::spec {

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
