// Provides a headless OpenGL context with debug output. Where there is none the test skips, or fails if
// LAMBENT_REQUIRE has gl (require.hpp). There is one per process and test, and a test's GL objects must be
// destroyed before its context.
#pragma once

#include <optional>

#include <gtest/gtest.h>

#include "runtime/gpu/context.hpp"
#include "tests/support/require.hpp"

namespace lambent::testing {

class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<gpu::Context> made = gpu::Context::createHeadless({.debug = true});
    if (!made) LAMBENT_LACKS("gl", "no OpenGL 4.5 here: " << made.error().line());
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
