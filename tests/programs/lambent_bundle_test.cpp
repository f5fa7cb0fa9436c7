// Tests that bundles are valid glTF.
#include "tests/programs/lambent_program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using testing::kGallery;
using testing::LambentProgram;
using testing::Outcome;

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
