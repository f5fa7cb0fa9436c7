#include "baker/plan/facing_area.hpp"

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

void addFacing(FacingArea& sum, const glm::vec3& normal, float area) {
  FacingArea y;
  sh::evaluate(5, normal, y);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += area * y[k];
}

void addFacingAnywhere(FacingArea& sum, float area) {
  constexpr float kY0 = 0.28209479f;
  sum[0] += area * kY0;
}

}  // namespace lambent::baker
