// lambent-assets OUT_DIR: writes the sample scenes and light probes that ship. The same bytes each time.
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "assets/probes.hpp"
#include "assets/scenes.hpp"

namespace {

using namespace lambent;

Result<void> writeAll(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return fail(folder.string(), "cannot be created: " + code.message(), "choose another folder");
  if (auto done = assets::writeGlb(folder / "gallery.glb", assets::gallery()); !done) return done;
  if (auto done = assets::writeGlb(folder / "hello.glb", assets::hello()); !done) return done;
  if (auto done = assets::writeGlb(folder / "knot.glb", assets::knot()); !done) return done;
  if (auto done = assets::writeGlb(folder / "playroom.glb", assets::playroom()); !done) return done;
  if (auto done = assets::writeGlb(folder / "field.glb", assets::field()); !done) return done;
  if (auto done = assets::writeGlb(folder / "metals.glb", assets::metals()); !done) return done;
  constexpr std::uint32_t kProbeWidth = 512;
  if (auto done = spec::writeHdr(folder / "sky.hdr", assets::skyProbe(kProbeWidth)); !done) return done;
  return spec::writeHdr(folder / "studio.hdr", assets::studioProbe(kProbeWidth));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: lambent-assets OUT_DIR\n", stderr);
    return 2;
  }
  if (const Result<void> done = writeAll(argv[1]); !done) {
    std::fprintf(stderr, "lambent-assets: %s\n", done.error().line().c_str());
    return 1;
  }
  return 0;
}
