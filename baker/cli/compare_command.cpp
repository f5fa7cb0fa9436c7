// Implements lambent compare PICTURE.exr REFERENCE.exr [--reference2 OTHER.exr] [--shrink N] [--heat
// OUT.png].
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/accuracy/compare.hpp"
#include "baker/cli/commands.hpp"
#include "baker/plan/counted.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

struct CompareArguments {
  std::filesystem::path picture, reference, reference2, heat;
  std::optional<double> heat_range;
  std::uint32_t shrink = 1;
  bool json = false;
};

void printDifference(const CompareArguments& a, const Difference& difference) {
  const PictureError& e = difference.figures;
  if (a.json) {
    nlohmann::json json = {{"picture", a.picture.string()},
                           {"reference", a.reference.string()},
                           {"noiseFree", !a.reference2.empty()},
                           {"shrink", a.shrink},
                           {"pixels", e.pixels},
                           {"pixelsApart", e.pixels_apart},
                           {"relativeRms", e.relative_rms},
                           {"relativeSquareError", e.relative_square_error},
                           {"bias", e.bias},
                           {"median", e.median},
                           {"percentile95", e.percentile_95},
                           {"percentile99", e.percentile_99},
                           {"max", e.largest}};
    if (e.pixels_of_other_surfaces)
      json["sameSurface"] = {
          {"relativeRms", e.same_surface_rms ? nlohmann::json(*e.same_surface_rms) : nlohmann::json()},
          {"pixelsLeftOut", *e.pixels_of_other_surfaces}};
    if (!a.heat.empty()) json["heat"] = {{"file", a.heat.string()}, {"range", difference.range}};
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{} against {}: {} pixels{}\n", a.picture.string(), a.reference.string(), e.pixels,
             e.pixels_apart ? fmt::format(", {} more covered in one only", e.pixels_apart) : "");
  const bool drowned = e.relative_rms * e.relative_rms < 2.0 * e.relative_square_error;
  fmt::print("  relative RMS  {}{}\n", percentText(e.relative_rms, 3),
             a.reference2.empty() ? ", the reference's own noise included"
             : drowned            ? ", drowned in the references' noise: give them more --spp"
                                  : ", free of the references' noise");
  if (e.pixels_of_other_surfaces)
    fmt::print("  same surfaces {}; {} pixels show another surface\n",
               e.same_surface_rms ? percentText(*e.same_surface_rms, 3) : "none that are lit",
               *e.pixels_of_other_surfaces);
  fmt::print("  bias          R {:+.3f} %, G {:+.3f} %, B {:+.3f} %\n", 100.0 * e.bias[0], 100.0 * e.bias[1],
             100.0 * e.bias[2]);
  fmt::print("  pixels        median {}, 95th {}, 99th {}, max {}\n", percentText(e.median, 3),
             percentText(e.percentile_95, 3), percentText(e.percentile_99, 3), percentText(e.largest, 3));
  if (!a.heat.empty())
    fmt::print("  {0}: luminance off by -{1} (blue) to +{1} (red)\n", a.heat.string(),
               percentText(difference.range));
}

Result<spec::RgbaImage> readShrunk(const std::filesystem::path& file, std::uint32_t by) {
  auto picture = spec::readExr(file);
  return picture ? shrunk(*picture, by, file.string()) : failAgain(std::move(picture.error()));
}

int runCompare(const CompareArguments& a) {
  const auto picture = readShrunk(a.picture, a.shrink);
  if (!picture) return reportError(picture.error());
  const auto reference = readShrunk(a.reference, a.shrink);
  if (!reference) return reportError(reference.error());
  std::optional<spec::RgbaImage> reference2;
  if (!a.reference2.empty()) {
    auto second = readShrunk(a.reference2, a.shrink);
    if (!second) return reportError(second.error());
    reference2 = std::move(*second);
  }
  const auto difference = differenceOf(*picture, *reference, reference2 ? &*reference2 : nullptr,
                                       a.heat_range, a.picture.string());
  if (!difference) return reportError(difference.error());
  if (!a.heat.empty())
    if (auto written = spec::writePng(a.heat, difference->heat); !written)
      return reportError(written.error());
  printDifference(a, *difference);
  return 0;
}

}  // namespace

void addCompareCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand("compare", "Error figures of a linear picture against a reference");
  command->add_option("PICTURE", a->picture, "The picture, .exr")->required();
  command->add_option("REFERENCE", a->reference, "What it should be, .exr of the same size")->required();
  command_line::addValue(*command, "--reference2", a->reference2, "EXR",
                         "A second, independent reference: cancels the noise of both");
  command_line::addValue(*command, "--shrink", a->shrink, "N",
                         "Compare means of N x N pixels, as a screen shows a picture of so many samples a "
                         "pixel")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command_line::addValue(*command, "--heat", a->heat, "PNG",
                         "Write where they differ as colors: luminance relative to the reference's, blue too "
                         "dark, red too bright. Gray: neither shows the scene, violet: one of them");
  command_line::addValue(*command, "--heat-range", a->heat_range, "SHARE",
                         "Where the colors end, as a share (0.1: 10 %; default: by the picture)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", a->json, "Print figures as JSON");
  command_line::group(*command, "Heat map", {"--heat", "--heat-range"});
  command_line::addExamples(*command,
                            {{"lambent compare shown.exr ref.exr", "prints how far one is from the other"},
                             {"lambent compare shown.exr ref.exr --reference2 ref2.exr --heat where.png",
                              "cancels the noise of the references, and draws where the picture is wrong"}});
  command->callback([a, &run] { run = [a] { return runCompare(*a); }; });
}

}  // namespace lambent::baker
