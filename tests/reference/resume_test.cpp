// Tests that interrupted work resumes from its checkpoint and gives the same bytes.
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "reference/film.hpp"
#include "reference/reference.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/reference/measure.hpp"
#include "tests/support/material_values.hpp"
#include "tests/support/program.hpp"

namespace lambent::baker::reference {

namespace {

using testing::bytesOf;

class Resume : public testing::ProgramTest {
 protected:
  // Requests a stop once `share` of the remaining work is done.
  Result<Report> renderUntil(const std::filesystem::path& output, double share) const {
    Progress progress;
    std::stop_source stop;
    std::jthread watch([&](const std::stop_token& ended) {
      while (!ended.stop_requested()) {
        const auto now = progress.now();
        if (now.total > 0 && static_cast<double>(now.done) >= share * static_cast<double>(now.total))
          stop.request_stop();
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      }
    });
    return render(scene, request, output, false, progress, stop.get_token());
  }

  const Scene scene = testing::ballOnAFloor();
  Request request = testing::ballInTheSun({.size = {64, 48}, .spp = 100});
};

TEST_F(Resume, EndsInTheBytesOfAPictureThatWasNotInterrupted) {
  const auto whole = folder / "whole.exr", parts = folder / "parts.exr";
  ASSERT_TRUE(renderUntil(whole, 2.0));
  int interrupts = 0;
  auto report = renderUntil(parts, 0.3);
  for (; !report && interrupts < 100; report = renderUntil(parts, interrupts < 2 ? 0.3 : 2.0)) {
    EXPECT_NE(report.error().line().find("run the same words again"), std::string::npos)
        << report.error().line();
    EXPECT_FALSE(std::filesystem::exists(parts));
    EXPECT_TRUE(std::filesystem::exists(checkpointOf(parts)));
    ++interrupts;
  }
  ASSERT_TRUE(report);
  EXPECT_GE(interrupts, 1);
  EXPECT_EQ(bytesOf(parts), bytesOf(whole));
  EXPECT_FALSE(std::filesystem::exists(checkpointOf(parts)));
  EXPECT_EQ(fileCount(), 2);
}

TEST_F(Resume, BeginsAnewWhenTheWordsOrTheBytesAreOthers) {
  const auto output = folder / "a.exr";
  ASSERT_FALSE(renderUntil(output, 0.2));
  const std::string checkpoint = bytesOf(checkpointOf(output));
  request.options.size = {16, 12};
  request.options.spp = 4;
  const auto other = renderUntil(output, 2.0);
  ASSERT_TRUE(other) << other.error().line();
  ASSERT_EQ(other->notices.size(), 1u);
  EXPECT_NE(other->notices[0].find("begun anew"), std::string::npos);
  testing::writeBytes(checkpointOf(output), checkpoint.substr(0, 100));
  const auto damaged = renderUntil(output, 2.0);
  ASSERT_TRUE(damaged);
  EXPECT_EQ(damaged->notices.size(), 1u);
  EXPECT_EQ(damaged->image.texels, other->image.texels);
}

// Checks that every field of a material is part of the digest that decides whether a checkpoint can be
// resumed.

std::uint64_t digestWith(const gltf::Material& material) {
  Scene scene;
  scene.materials = {material};
  return digestOf(scene, {}, {}, {}, {});
}

TEST(ReferenceDigest, ChangesWithEveryFieldOfAMaterial) {
  const gltf::Material plain = testing::materialWithEverything();
  gltf::forEachMaterialField([&](const auto& field) {
    EXPECT_NE(digestWith(testing::changed(plain, field)), digestWith(plain)) << field.name;
  });
}

}  // namespace
}  // namespace lambent::baker::reference
