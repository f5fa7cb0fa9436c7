// lambent-assets OUT_DIR writes the sample scenes and environment maps that ship, with the same bytes each
// time.
#include <cstdio>
#include <filesystem>
#include <system_error>

#include <CLI/CLI.hpp>

#include "assets/environment_maps.hpp"
#include "assets/scenes.hpp"

namespace {

using namespace lambent;

Result<void> writeAll(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return fail(folder.string(), "cannot be created: " + code.message(), "choose another folder");
  for (const auto make : {assets::gallery, assets::hello, assets::knot, assets::playroom, assets::field,
                          assets::metals, assets::flight, assets::ring}) {
    const assets::Scene scene = make();
    if (auto done = assets::writeGlb(folder / (scene.name + ".glb"), scene); !done) return done;
  }
  constexpr std::uint32_t kProbeWidth = 512;
  if (auto done = spec::writeHdr(folder / "sky.hdr", assets::skyMap(kProbeWidth)); !done) return done;
  return spec::writeHdr(folder / "studio.hdr", assets::studioMap(kProbeWidth));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes the sample scenes and environment maps of Lambent.", "lambent-assets");
  std::filesystem::path folder;
  app.add_option("OUT_DIR", folder, "folder to write them to; made if it is not there")->required();
  app.set_version_flag("--version", "lambent-assets " LAMBENT_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    constexpr int kWrongUsage = 2;
    return app.exit(error) == 0 ? 0 : kWrongUsage;
  }
  if (const Result<void> done = writeAll(folder); !done) {
    std::fprintf(stderr, "lambent-assets: %s\n", done.error().line().c_str());
    return 1;
  }
  return 0;
}
