// Kills a bake with kill -9 at random moments: the bundle is byte for byte that of an undisturbed bake, no
// broken file ever has its name, and little work is done twice.
#include <array>
#include <chrono>
#include <random>
#include <thread>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "assets/scenes.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/support/program.hpp"

namespace lambent {
namespace {

using testing::bytesOf;

constexpr int kKills = 12;
constexpr double kCheckpoint_s = 0.2;
constexpr int kThreads = 2;

class KilledBake : public testing::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    writeBall(folder / "ball.nrrd");
    const auto written = assets::writeGlb(folder / "scene.glb", scene());
    ASSERT_TRUE(written) << written.error().line();
  }

  // Makes a scene with every kind of work: diffuse and glossy surfaces, a body with a neighborhood, a cloud.
  static assets::Scene scene() {
    assets::Scene scene = assets::hello();
    assets::Material brass{.name = "brass", .base_color = {0.9f, 0.7f, 0.4f}};
    brass.metallic = 1.0f;
    brass.roughness = 0.5f;
    scene.materials.push_back(brass);
    assets::MaterialMesh ball = scene.meshes.back();
    ball.material = static_cast<int>(scene.materials.size()) - 1;
    scene.meshes.push_back(ball);
    scene.nodes.push_back(
        {.name = "ball",
         .mesh = static_cast<int>(scene.meshes.size()) - 1,
         .translation = {0.0f, 2.0f, 0.0f},
         .scale = 0.5f,
         .movable = true,
         .neighborhood = assets::Neighborhood{.size = {6, 6, 6}, .extent = glm::vec3(3.0f)}});
    scene.nodes.push_back(
        {.name = "cloud",
         .mesh = -1,
         .translation = {0.0f, 3.5f, 0.0f},
         .volume = assets::Volume{.file = "ball.nrrd", .density_scale = 8.0f, .size = glm::vec3(1.5f)}});
    return scene;
  }

  static void writeBall(const std::filesystem::path& path) {
    constexpr int kSide = 24;
    std::string bytes = fmt::format(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {0} {0} {0}\nendian: little\nencoding: raw\n\n", kSide);
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const glm::vec3 at(i % kSide, i / kSide % kSide, i / (kSide * kSide));
      const float density = std::max(0.0f, 1.0f - glm::length((at + 0.5f) / (0.5f * kSide) - 1.0f));
      bytes.append(reinterpret_cast<const char*>(&density), sizeof(density));
    }
    testing::writeBytes(path, bytes);
  }

  std::vector<std::string> arguments(const std::string& output, const std::string& cache) const {
    return {"bake",
            (folder / "scene.glb").string(),
            "-o",
            (folder / output).string(),
            "--cache",
            (folder / cache).string(),
            "--checkpoint",
            fmt::format("{}", kCheckpoint_s),
            "--threads",
            std::to_string(kThreads),
            "--quality",
            "draft",
            "--rays",
            "512",
            "--order",
            "4",
            "--glossy-order",
            "4",
            "--codes",
            "0.03",
            "--volume-grid",
            "8",
            "--neighborhood-grid",
            "8x8x6",
            "--refine",
            "0.02",
            "--json"};
  }

  struct Ended {
    bool killed = false;
    int exit_code = -1;
    double cpu_s = 0.0, wall_s = 0.0;
  };
  // Kills it after so many seconds, unless it ends before.
  Ended runFor(const std::vector<std::string>& words, double seconds) const {
    using Clock = std::chrono::steady_clock;
    const auto began = Clock::now();
    const ::pid_t id = start(LAMBENT_PROGRAM, words);
    Ended ended;
    int status = 0;
    ::rusage usage{};
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
    while (::wait4(id, &status, ended.killed ? 0 : WNOHANG, &usage) == 0) {
      if (elapsed() >= seconds) {
        ::kill(id, SIGKILL);
        ended.killed = true;
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    }
    ended.wall_s = elapsed();
    ended.killed = WIFSIGNALED(status);
    ended.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    const auto secondsOf = [](const ::timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    ended.cpu_s = secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
    return ended;
  }
  Ended runOut(const std::vector<std::string>& words) const { return runFor(words, 1e9); }
};

}  // namespace

TEST_F(KilledBake, AtRandomMomentsItComesToTheSameBytesAndLosesLittleWork) {
  const Ended whole = runOut(arguments("whole.lmb.glb", "whole-cache"));
  ASSERT_EQ(whole.exit_code, 0) << bytesOf(log("err"));
  const std::string wanted = bytesOf(folder / "whole.lmb.glb");
  // Measures a run that finds everything in the cache.
  std::filesystem::remove(folder / "whole.lmb.glb");
  const Ended found = runOut(arguments("whole.lmb.glb", "whole-cache"));
  ASSERT_EQ(found.exit_code, 0);
  EXPECT_EQ(bytesOf(folder / "whole.lmb.glb"), wanted) << "from what the cache holds";
  EXPECT_EQ(nlohmann::json::parse(bytesOf(log("out")))["rays"], 0);

  std::mt19937 random(20);  // the same moments in each run of the test; not the same state of the bake
  std::uniform_real_distribution<double> moment(0.0, whole.wall_s);
  const std::filesystem::path output = folder / "killed.lmb.glb";
  int kills = 0, finished = 0;
  double cpu_s = 0.0, killed_cpu_s = 0.0;
  std::string cache = "cache-0";
  const auto run = [&](double seconds) {
    const Ended ended = runFor(arguments("killed.lmb.glb", cache), seconds);
    cpu_s += ended.cpu_s;
    if (ended.killed) {
      ++kills;
      killed_cpu_s += ended.cpu_s;
      EXPECT_TRUE(!std::filesystem::exists(output) || bytesOf(output) == wanted) << "after kill " << kills;
      return;
    }
    ASSERT_EQ(ended.exit_code, 0) << bytesOf(log("err"));
    ASSERT_EQ(bytesOf(output), wanted) << "after " << kills << " kills";
    // The bake starts from the beginning again.
    ++finished;
    std::filesystem::remove(output);
    std::filesystem::remove_all(folder / cache);
    cache = fmt::format("cache-{}", finished);
  };
  while (kills < kKills) ASSERT_NO_FATAL_FAILURE(run(moment(random)));
  ASSERT_NO_FATAL_FAILURE(run(1e9));

  // A bake without checkpoints would lose all that it had computed when it was killed; with them it loses the
  // start-up and on average half of the work between two. Both are taken in this run, and the cost of a whole
  // bake once more at its end, because other work on the machine makes the same work dearer.
  const Ended again = runOut(arguments("again.lmb.glb", "again-cache"));
  ASSERT_EQ(again.exit_code, 0);
  const double lost_s = cpu_s - finished * std::max(whole.cpu_s, again.cpu_s);
  EXPECT_LT(lost_s, 0.6 * killed_cpu_s)
      << "in " << kills << " kills and " << finished << " finished bakes of " << whole.cpu_s << " to "
      << again.cpu_s << " s each";
  RecordProperty("lost_of_killed", fmt::format("{:.3f}", lost_s / killed_cpu_s));
  fmt::print("{} kills, {} finished bakes of {:.1f} s of computing: {:.2f} s of {:.2f} s lost with a kill\n",
             kills, finished, whole.cpu_s, lost_s / kills, killed_cpu_s / kills);
}

}  // namespace lambent
