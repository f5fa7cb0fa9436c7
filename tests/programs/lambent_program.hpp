// Runs lambent as a user does.
#pragma once

#include <string>
#include <vector>

#include "tests/support/eventually.hpp"
#include "tests/support/program.hpp"

namespace lambent::testing {

inline const std::string kHello = LAMBENT_BINARY_DIR "/assets/hello.glb";
inline const std::string kGallery = LAMBENT_BINARY_DIR "/assets/gallery.glb";

class LambentProgram : public ProgramTest {
 protected:
  Outcome lambent(const std::vector<std::string>& arguments) const { return run(LAMBENT_PROGRAM, arguments); }
  // Sends a signal once lambent has written `said` to stderr.
  Outcome interrupt(const std::vector<std::string>& arguments, const std::string& said, int signal) const {
    const ::pid_t id = start(LAMBENT_PROGRAM, arguments);
    EXPECT_TRUE(eventually([&] { return bytesOf(log("err")).find(said) != std::string::npos; }))
        << bytesOf(log("err"));
    ::kill(id, signal);
    return finish(id);
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  // Bakes hello.glb at draft quality, with further options.
  Outcome bakeHello(const std::string& name, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"bake", kHello, "-o", path(name), "--quality", "draft"});
    return lambent(options);
  }
};

}  // namespace lambent::testing
