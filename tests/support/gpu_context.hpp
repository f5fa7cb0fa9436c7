// Provides a headless OpenGL context with debug output, or the sentence with which a test skips if there is
// none. There is one per process and test, and a test's GL objects must be destroyed before its context.
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
