#include "baker/pipeline/job_state.hpp"

#include <array>

namespace lambent::baker {

const char* phaseName(JobPhase phase) {
  static constexpr std::array kNames = {"waiting", "importing", "baking", "done", "failed", "cancelled"};
  return kNames[static_cast<std::size_t>(phase)];
}

}  // namespace lambent::baker
