// Holds fresh bundles, with every payload and property that is written, against the schema that
// docs/format.md points to. Properties that the schema does not name are errors here.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/frame/neighborhood_scene.hpp"
#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

class BundleSchema : public testing::ProgramTest {
 protected:
  testing::Outcome validate(const std::vector<std::filesystem::path>& bundles) const {
    std::vector<std::string> words = {LAMBENT_SOURCE_DIR
                                      "/docs/schema/LAMBENT_radiance_transfer.schema.json"};
    for (const std::filesystem::path& bundle : bundles) words.push_back(bundle.string());
    return run(LAMBENT_SOURCE_DIR "/tests/support/validate_bundle.py", words);
  }
};

bundle::BrdfTable smallTable() {
  bundle::BrdfTable table{.order = 5, .lobes = 2, .angles = 3, .roughnesses = 2, .values = {}};
  table.values.assign(table.nodes() * table.nodeValues(), 0.01f);
  return table;
}

// Returns bundles that have, together, all that the baker may write.
std::vector<std::filesystem::path> builtIn(const std::filesystem::path& folder) {
  gltf::Material glowing, plastic;
  glowing.emissive = {2.0f, 1.0f, 0.5f};
  plastic.metallic = 0.0f;
  const bundle::MeshData mesh = testing::sphereMesh(6, 12);
  std::vector<std::filesystem::path> paths;
  const auto next = [&] { return paths.emplace_back(folder / fmt::format("{}.lmb.glb", paths.size())); };
  testing::BundleBuilder()
      .bounces()
      .lamp({.kind = bundle::GroupLight::Kind::Material,
             .index = 0,
             .color = {4.0f, 1.0f, 0.0f},
             .spheres = {{glm::vec3(0.0f), 1.0f, 1.1f}}},
            0.5f)
      .lamp({.kind = bundle::GroupLight::Kind::Node, .index = 0, .color = {0.0f, 0.0f, 8.0f}}, 0.25f)
      .add({mesh, glowing})
      .volume({})
      .write(next());
  testing::BundleBuilder().normalMapped().add({mesh, {}}).write(next());
  testing::BundleBuilder(5).add({mesh, {}}).glossy(5, bundle::BrdfFamily::Ggx, smallTable()).write(next());
  testing::BundleBuilder().add({mesh, plastic}).layered(smallTable()).write(next());
  testing::NeighborhoodScene scene;
  scene.receivers = {{.name = "floor", .mesh = testing::floorMesh(2.0f, 4)}};
  scene.bodies = {{.change = testing::blackSphere(0.5f), .size = glm::uvec3(5), .sphere_radius = 0.5f}};
  scene.write(next());
  return paths;
}

TEST_F(BundleSchema, AcceptsFreshBundlesOfEveryKind) {
  std::vector<std::filesystem::path> bundles = builtIn(folder);
  bundles.push_back(folder / "baked.lmb.glb");
  const testing::Outcome baked = run(LAMBENT_PROGRAM, {"bake", LAMBENT_BINARY_DIR "/assets/hello.glb", "-o",
                                                       bundles.back().string(), "--quality", "draft"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const testing::Outcome outcome = validate(bundles);
  if (outcome.exit_code == 77) LAMBENT_LACKS("schema", outcome.out);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

TEST_F(BundleSchema, RefusesWhatItDoesNotName) {
  const std::vector<std::filesystem::path> bundles = builtIn(folder);
  std::string bytes = testing::bytesOf(bundles.front());
  // The names have the same length, so that the file stays whole.
  const auto swap = [&](const std::string& from, const std::string& to) {
    std::string changed = bytes;
    changed.replace(changed.find(from), from.size(), to);
    testing::writeBytes(bundles.front(), changed);
    return validate({bundles.front()});
  };
  if (const testing::Outcome outcome = swap("\"sampleCount\"", "\"sampleCound\""); outcome.exit_code == 77)
    LAMBENT_LACKS("schema", outcome.out);
  EXPECT_NE(swap("\"sampleCount\"", "\"sampleCound\"").out.find("sampleCound"), std::string::npos);
  EXPECT_EQ(swap("\"version\":8", "\"version\":9").exit_code, 1);
  EXPECT_EQ(swap("\"bodyRadius\"", "\"bodyradius\"").exit_code, 1);
}

}  // namespace
}  // namespace lambent
