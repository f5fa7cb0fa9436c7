// Reads isotropic BRDFs measured at scattered directions (the Cornell Graphics Lab's text files, .brdf).
// Spectra are converted to linear Rec.709; directions stay as they are. Materials name them by
// `extras.lambent.brdf`, a path beside the glTF file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

struct BrdfMeasurement {
  float theta_i = 0.0f, phi_i = 0.0f, theta_o = 0.0f, phi_o = 0.0f;  // radians, from the normal and about it
  glm::vec3 value{0.0f};                                             // f, per steradian, linear Rec.709
};

struct MeasuredBrdf {
  std::string name;  // the file's name, without folders
  std::vector<BrdfMeasurement> measurements;
};

// Errors name the file and what is wrong in it.
Result<MeasuredBrdf> readMeasuredBrdf(const std::filesystem::path& file);

}  // namespace lambent::baker
