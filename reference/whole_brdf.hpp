// BRDFs that are one function of a whole material, in place of GGX over a diffuse part, and the list of them.
// A lobe that is added is a class of this kind in a file of its own and a row in whole_brdf.cpp.
#pragma once

#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker::reference {

class WholeBrdf {
 public:
  virtual ~WholeBrdf() = default;
  // f, local; v and s above the surface.
  virtual glm::vec3 value(const glm::vec3& v, const glm::vec3& s) const = 0;
  // The GGX lobe about as wide as the highlight, to draw directions by.
  virtual float alpha() const = 0;
};

// One for each material; null where it is GGX or matte.
std::vector<std::shared_ptr<const WholeBrdf>> wholeBrdfs(const Scene& scene);

}  // namespace lambent::baker::reference
