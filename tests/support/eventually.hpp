// Waits for other threads and programs.
#pragma once

#include <chrono>
#include <thread>

namespace lambent::testing {

// Polls a condition until it holds, and returns whether it does. A busy machine takes its time, so the limit
// is only there to make a failure of what would hang.
template <typename Condition>
bool eventually(const Condition& holds, std::chrono::milliseconds within = std::chrono::minutes(4)) {
  for (const auto end = std::chrono::steady_clock::now() + within; !holds();) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace lambent::testing
