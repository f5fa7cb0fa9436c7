// Tests what programs say of bundles that are damaged or too new, and that whole ones are valid glTF.
#include "runtime/bundle/description.hpp"
#include "tests/programs/lambent_program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using testing::bytesOf;
using testing::expectOneLine;
using testing::kGallery;
using testing::LambentProgram;
using testing::Outcome;
using testing::writeBytes;

class DamagedBundle : public LambentProgram {
 protected:
  void SetUp() override {
    LambentProgram::SetUp();
    ASSERT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
    whole = bytesOf(folder / "hello.lmb.glb");
  }
  // These bundles no program may accept; each has a reason.
  std::vector<std::pair<std::string, std::string>> damaged() const {
    std::vector<std::pair<std::string, std::string>> bundles;
    const std::size_t size = whole.size();
    for (const std::size_t length : {std::size_t{0}, std::size_t{3}, std::size_t{12}, std::size_t{21},
                                     size / 4, size / 2, size - 8, size - 1})
      bundles.emplace_back(fmt::format("cut at {}", length), whole.substr(0, length));
    for (const std::size_t at :
         {std::size_t{1}, std::size_t{9}, std::size_t{300}, size / 3, size / 2, size - 20}) {
      bundles.emplace_back(fmt::format("flipped at {}", at), whole);
      bundles.back().second[at] ^= 0x10;
    }
    bundles.emplace_back("trailing bytes", whole + "0123");
    return bundles;
  }
  // Writes the same bundle as a future version of the program would.
  std::string tooNew() const {
    const std::string field = "\"LAMBENT_radiance_transfer\":{";
    const std::size_t extension = whole.find(field);
    const std::size_t version =
        whole.find("\"version\":" + std::to_string(bundle::kVersionCurrent), extension);
    EXPECT_NE(version, std::string::npos);
    std::string bundle = whole;
    bundle[version + 10] = '9';
    return bundle;
  }

  std::string whole;
};

TEST_F(DamagedBundle, IsToldByInfoInOneLine) {
  for (const auto& [what, bytes] : damaged()) {
    writeBytes(folder / "damaged.lmb.glb", bytes);
    const Outcome outcome = lambent({"info", path("damaged.lmb.glb")});
    EXPECT_EQ(outcome.exit_code, 1) << what;
    expectOneLine(outcome, "lambent", what);
    EXPECT_NE(outcome.err.find("damaged.lmb.glb: "), std::string::npos) << what << "\n" << outcome.err;
  }
  writeBytes(folder / "future.lmb.glb", tooNew());
  const Outcome outcome = lambent({"info", path("future.lmb.glb")});
  EXPECT_EQ(outcome.exit_code, 1);
  expectOneLine(outcome, "lambent", "too new");
  EXPECT_NE(outcome.err.find("newer"), std::string::npos) << outcome.err;
}

TEST_F(LambentProgram, BundlesPassTheKhronosValidator) {
  ASSERT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
  const Outcome gallery = lambent({"bake", kGallery, "-o", path("gallery.lmb.glb"), "--quality", "draft"});
  ASSERT_EQ(gallery.exit_code, 0) << gallery.err;
  const Outcome outcome = run(LAMBENT_SOURCE_DIR "/tests/support/validate_gltf.sh",
                              {path("hello.lmb.glb"), path("gallery.lmb.glb")});
  if (outcome.exit_code == 77) LAMBENT_LACKS("validator", outcome.out);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

}  // namespace
}  // namespace lambent
