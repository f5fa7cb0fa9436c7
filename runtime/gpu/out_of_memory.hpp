// Says that the driver has no memory for a buffer or a texture. It is thrown, as std::bad_alloc is, since
// objects are made deep within passes. orOutOfMemory() makes an Error of it where results are returned.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "runtime/base/result.hpp"

namespace lambent::gpu {

class OutOfMemory : public std::runtime_error {
 public:
  // `what` names the object and its size.
  explicit OutOfMemory(const std::string& what) : std::runtime_error("has no memory for " + what) {}
  Error error() const {
    return {"GPU", what(), "close other programs, or give --max-memory or a smaller picture"};
  }
};

// Returns what the call returns, a Result, or an error if the GPU has no memory for it.
template <typename Call>
auto orOutOfMemory(Call&& call) -> decltype(call()) {
  try {
    return std::forward<Call>(call)();
  } catch (const OutOfMemory& failure) {
    return failAgain(failure.error());
  }
}

}  // namespace lambent::gpu
