// Tests that a scene with survey coordinates shows the same pictures as the scene at the origin.
#include <cstdint>
#include <cstring>

#include <nlohmann/json.hpp>

#include "tests/programs/lambent_program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::bytesOf;
using testing::kHello;
using testing::LambentProgram;
using testing::Outcome;

// Returns a binary glTF file whose scene stands at a place below a node of its own.
std::string moved(const std::string& glb, const json& place) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.data() + at, sizeof value);
    return value;
  };
  const auto word = [](std::size_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&bits), sizeof bits);
  };
  json document = json::parse(glb.substr(20, number(12)));
  document["nodes"].push_back({{"children", document["scenes"][0]["nodes"]}, {"translation", place}});
  document["scenes"][0]["nodes"] = {document["nodes"].size() - 1};
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string binary = glb.substr(20 + number(12));
  return "glTF" + word(2) + word(20 + text.size() + binary.size()) + word(text.size()) + "JSON" + text +
         binary;
}

class FarScene : public LambentProgram {
 protected:
  void SetUp() override {
    LambentProgram::SetUp();
    testing::writeBytes(folder / "far.glb", moved(bytesOf(kHello), {5e6, 250.5, -4321987.25}));
  }
  // The same lights, seen from the scenes.
  std::vector<std::string> view(const std::string& lamp) const {
    return {"--light",  "constant:.3,.3,.3",  "--light", lamp,
            "--camera", "orbit:40,25,1.6,40", "--size",  "120x90"};
  }
  const std::vector<std::string> near_view = view("sphere:1,3,2,0.25,40"),
                                 far_view = view("sphere:5000001,253.5,-4321985.25,0.25,40");

  double difference(const std::string& a, const std::string& b) const {
    const Outcome outcome = lambent({"compare", path(a), path(b), "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? json::parse(outcome.out)["relativeRms"].get<double>() : 1.0;
  }
};

TEST_F(FarScene, HasTheSameBake) {
  const auto show = [&](const std::string& bundle, const std::string& out, std::vector<std::string> more) {
    more.insert(more.begin(), {path(bundle), "--headless", path(out)});
    return run(LAMBENT_DEMO, more);
  };
  ASSERT_EQ(bakeHello("near.lmb.glb").exit_code, 0);
  Outcome outcome = lambent({"bake", path("far.glb"), "-o", path("far.lmb.glb"), "--quality", "draft"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  outcome = show("near.lmb.glb", "near.exr", near_view);
  if (testing::lacksDevice(outcome)) LAMBENT_LACKS("gl", outcome.err);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  outcome = show("far.lmb.glb", "far.exr", far_view);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_LT(difference("far.exr", "near.exr"), 0.02);
  // Other viewers find it at its place: the nodes of the file have all digits.
  const std::string glb = bytesOf(folder / "far.lmb.glb");
  EXPECT_NE(glb.find("LAMBENT_radiance_transfer"), std::string::npos);
  const json document = json::parse(glb.substr(20, glb.find("BIN", 20) - 24));
  const json& origin = document["extensions"]["LAMBENT_radiance_transfer"]["origin"];
  const json& root = document["nodes"][document["scenes"][0]["nodes"][0].get<std::size_t>()];
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(root["matrix"][12 + axis], origin[axis]);
  EXPECT_NEAR(origin[2].get<double>(), -4321987.25, 64.0);
}

}  // namespace
}  // namespace lambent
