// Runs lambent as a user does.
#pragma once

#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace lambent::testing {

inline const std::string kHello = LAMBENT_BINARY_DIR "/assets/hello.glb";
inline const std::string kGallery = LAMBENT_BINARY_DIR "/assets/gallery.glb";

class LambentProgram : public ProgramTest {
 protected:
  Outcome lambent(const std::vector<std::string>& arguments) const { return run(LAMBENT_PROGRAM, arguments); }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  // Bakes hello.glb at draft quality, with further options.
  Outcome bakeHello(const std::string& name, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"bake", kHello, "-o", path(name), "--quality", "draft"});
    return lambent(options);
  }
};

}  // namespace lambent::testing
