// The word for an edit of a key light that was found in a environment map's picture, the same in every
// program: key:AZ,EL,TO_AZ,TO_EL,R[,G,B]. The key light that was found at azimuth AZ and elevation EL stands
// at TO_AZ, TO_EL and shines by the factors R, G and B of what was found; fade-key:... means the second set
// of lights. Angles are those of sun words: degrees in the lights' own frame. Comes in: the text. Goes out: a
// KeyEdit, every number finite and in its range. Errors quote the word and show the form that was expected.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::spec {

struct KeyEdit {
  std::size_t set = 0;                  // 0: the first set of lights, 1: the one that is faded to
  glm::vec3 found{0.0f, 1.0f, 0.0f};    // unit, where it was found
  glm::vec3 towards{0.0f, 1.0f, 0.0f};  // unit, where it stands instead
  glm::vec3 factor{1.0f};
  bool operator==(const KeyEdit&) const = default;
};

inline constexpr float kMostKeyFactor = 1e6f;

Result<KeyEdit> parseKeyEdit(std::string_view word);
// Angles to a thousandth of a degree.
std::string keyEditWord(const KeyEdit& edit);

// The inverse of directionFromAzimuthElevation (light.hpp), azimuth in -180..180. Straight up and down have
// azimuth 0.
struct AzimuthElevation {
  float azimuth_deg = 0.0f, elevation_deg = 0.0f;
};
AzimuthElevation azimuthElevation(const glm::vec3& direction);

}  // namespace lambent::spec
