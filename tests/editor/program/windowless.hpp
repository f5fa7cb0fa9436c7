// Provides an editor session without window and OpenGL, and a small scene that is opened in it. It has a
// memory limit, so that bundles are not uploaded before a first picture.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "assets/scenes.hpp"
#include "editor/commands/command.hpp"
#include "editor/session/session.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::editor::testing {

class Windowless : public ::testing::Test {
 protected:
  void SetUp() override { session = makeSession(); }

  std::unique_ptr<Session> makeSession() const {
    SessionOptions options;
    options.light_words = {"constant:0.3,0.3,0.3"};
    options.output_folder = options.cache_folder = folder.path();
    options.max_memory_bytes = std::uint64_t{64} << 20;
    options.threads = 1;
    options.bake = false;
    auto made = Session::create(options, {});
    EXPECT_TRUE(made) << made.error().line();
    return made ? std::move(*made) : nullptr;
  }

  // Opens hello.glb, and waits until its entities exist.
  void openHello() {
    const std::filesystem::path file = folder.path() / "hello.glb";
    ASSERT_TRUE(assets::writeGlb(file, assets::hello()));
    ASSERT_TRUE(run("open", {file.string()}));
    waitForBundle(*session);
  }
  static void waitForBundle(Session& of) {
    ASSERT_FALSE(of.scenes.entries().empty());
    ASSERT_TRUE(lambent::testing::eventually([&] {
      of.update(0.0);
      return of.scenes.entries().front().slot.has_value();
    })) << "no bundle came";
  }

  Result<nlohmann::json> run(const char* id, std::vector<std::string> words = {}) {
    return runCommand(*session, id, words);
  }
  // Runs a command that must not fail.
  nlohmann::json answer(const char* id, std::vector<std::string> words = {}) {
    const auto done = run(id, std::move(words));
    EXPECT_TRUE(done) << done.error().line();
    return done ? *done : nlohmann::json();
  }

  lambent::testing::TemporaryFolder folder;
  std::unique_ptr<Session> session;
};

}  // namespace lambent::editor::testing
