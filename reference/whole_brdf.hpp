// Declares BRDFs that describe a whole material, instead of GGX over a diffuse part. To add one, derive a
// class in a file of its own and add a row in whole_brdf.cpp.
#pragma once

#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker::reference {

class WholeBrdf {
 public:
  virtual ~WholeBrdf() = default;
  // Returns the BRDF; v and s are in local space, above the surface.
  virtual glm::vec3 value(const glm::vec3& v, const glm::vec3& s) const = 0;
  // Returns the alpha of a GGX lobe that is about as wide as the highlight, for sampling.
  virtual float alpha() const = 0;
};

// Returns one BRDF per material, or null for GGX and diffuse materials.
std::vector<std::shared_ptr<const WholeBrdf>> wholeBrdfs(const Scene& scene);

}  // namespace lambent::baker::reference
