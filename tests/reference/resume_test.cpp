// Tests that interrupted work resumes from its checkpoint and gives the same bytes.
#include <fstream>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "reference/film.hpp"
#include "runtime/bundle/checksum.hpp"
#include "tests/reference/measure.hpp"
#include "tests/reference/media.hpp"
#include "tests/support/program.hpp"

namespace lambent::baker::reference {
namespace {

using testing::bytesOf;

class Resume : public testing::ProgramTest {
 protected:
  Resume() {
    scene = testing::sceneOf({testing::grid({0, 0, 0}, 4.0f, 8), testing::icosphere({0, 0.6f, 0}, 0.5f, 3)});
    scene.materials[0].base_color = glm::vec4(0.7f, 0.6f, 0.5f, 1);
    request.lights = {testing::uniform(0.3f),
                      spec::SunLight{.elevation_deg = 40, .angle_deg = 4, .radiance = glm::vec3(50)}};
    request.camera = spec::OrbitCamera{30, 20, 2, 40};
    request.options = {.size = {64, 48}, .spp = 100};
  }

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

  Scene scene;
  Request request;
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

TEST_F(Resume, WithAVolumeEndsInTheSameBytesAndKnowsItsDensity) {
  SceneVolume volume = testing::even(4.0f, glm::vec3(0.9f), 0.3f, {0, 0.8f, 0});
  testing::place(scene, volume);
  request.options = {.size = {32, 24}, .spp = 200};
  const auto whole = folder / "whole.exr", parts = folder / "parts.exr", other = folder / "other.exr";
  ASSERT_TRUE(renderUntil(whole, 2.0));
  ASSERT_FALSE(renderUntil(parts, 0.3));
  ASSERT_TRUE(std::filesystem::copy_file(checkpointOf(parts), checkpointOf(other)));
  const auto gone_on = renderUntil(parts, 2.0);
  ASSERT_TRUE(gone_on);
  EXPECT_TRUE(gone_on->notices.empty());
  EXPECT_EQ(bytesOf(parts), bytesOf(whole));
  scene.volumes[0].density[5] += 0.1f;
  const auto anew = renderUntil(other, 2.0);
  ASSERT_TRUE(anew);
  EXPECT_EQ(anew->notices.size(), 1u);
  EXPECT_NE(bytesOf(other), bytesOf(whole));
}

TEST(Film, RestoresOnlyWhatItSaved) {
  const auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("film-{}.partial", ::getpid());
  const std::vector<PixelSum> row = {
      {.replicas = {glm::dvec3(1, 2, 3), glm::dvec3(3, 2, 1)}, .alpha = 1, .depth = 2.5, .rays = 7},
      {.replicas = {glm::dvec3(0.5), glm::dvec3(-0.5)}, .alpha = 0.25, .rays = 9}};
  Film film({2, 1}, 42);
  film.addRow(0, 4, row);
  film.seconds = 1.5;
  ASSERT_TRUE(film.save(path));
  Film same({2, 1}, 42), other({2, 1}, 43);
  EXPECT_TRUE(same.restore(path));
  EXPECT_EQ(same.image().texels, film.image().texels);
  EXPECT_EQ(same.image().texels[0], glm::vec4(1, 1, 1, 1));
  EXPECT_EQ(same.image().depths, (std::vector<float>{2.5f, std::numeric_limits<float>::infinity()}));
  EXPECT_EQ(same.half(1).depths, same.image().depths);
  EXPECT_EQ(same.rays(), 16u);
  EXPECT_EQ(same.done(0), 4u);
  EXPECT_EQ(same.seconds, 1.5);
  EXPECT_FALSE(other.restore(path));
  const std::string bytes = bytesOf(path);
  for (std::size_t at = 0; at < bytes.size(); at += 5) {
    std::string wrong = bytes;
    wrong[at] ^= 0x20;
    testing::writeBytes(path, wrong);
    EXPECT_FALSE(same.restore(path)) << at;
    testing::writeBytes(path, bytes.substr(0, at));
    EXPECT_FALSE(same.restore(path)) << at;
  }
  EXPECT_EQ(same.done(0), 4u) << "unchanged";
  std::filesystem::remove(path);
}

// Writes a checkpoint of version 1, which had no depths: 56 bytes per pixel.
TEST(Film, RefusesCheckpointsOfTheVersionBefore) {
  const auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("old-{}.partial", ::getpid());
  const auto writeFilm = [&](std::uint32_t version, std::size_t doubles_a_pixel) {
    std::string bytes = "LBRP";
    const auto put = [&](const auto& value) {
      bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    };
    put(version);
    put(std::uint64_t{42});  // digest
    put(std::uint32_t{2});
    put(std::uint32_t{1});
    put(1.5);               // seconds
    put(std::uint32_t{4});  // samples done of the one row
    put(std::uint64_t{16});
    for (std::size_t i = 0; i < 2 * doubles_a_pixel; ++i) put(0.25);
    put(bundle::checksum(std::as_bytes(std::span(bytes))));
    testing::writeBytes(path, bytes);
  };
  Film film({2, 1}, 42);
  writeFilm(1, 7);
  EXPECT_FALSE(film.restore(path));
  writeFilm(1, 8);
  EXPECT_FALSE(film.restore(path));
  EXPECT_EQ(film.done(0), 0u) << "unchanged";
  writeFilm(2, 8);
  EXPECT_TRUE(film.restore(path)) << "so that it was not refused for something else";
  EXPECT_EQ(film.done(0), 4u);
  std::filesystem::remove(path);
}

TEST(Film, ToldItsErrorByTwoReplicas) {
  // Means 2 and 4 of two samples each: the mean 3 has the standard error |2 - 4| / 2.
  Film film({1, 1}, 0);
  film.addRow(0, 4,
              std::vector<PixelSum>{{.replicas = {glm::dvec3(4), glm::dvec3(8)}, .alpha = 1, .rays = 0}});
  ASSERT_TRUE(film.standardError());
  EXPECT_NEAR(*film.standardError(), 1.0 / 3.0, 1e-12);
  Film once({1, 1}, 0);
  once.addRow(0, 1,
              std::vector<PixelSum>{{.replicas = {glm::dvec3(4), glm::dvec3(0)}, .alpha = 1, .rays = 0}});
  EXPECT_FALSE(once.standardError());
}

}  // namespace
}  // namespace lambent::baker::reference
