// A headless context with debug output for a test that needs one, and the sentence with which it skips where
// there is none. One per process and test: GL objects of a test must die before its context does.
#pragma once

#include <optional>

#include <gtest/gtest.h>

#include "runtime/gpu/context.hpp"

namespace lambent::testing {

class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<gpu::Context> made = gpu::Context::createHeadless({.debug = true});
    if (!made) GTEST_SKIP() << "no OpenGL 4.5 here: " << made.error().line();
    context.emplace(std::move(*made));
  }
  void TearDown() override {
    if (!context) return;
    EXPECT_EQ(context->errors(), 0u) << (context->errorMessages().empty() ? ""
                                                                          : context->errorMessages().front());
  }

  std::optional<gpu::Context> context;
};

}  // namespace lambent::testing
