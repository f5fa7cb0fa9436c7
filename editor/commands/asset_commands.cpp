// Implements the commands about files to choose from: what there is, and the use of one.
#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

Answer assets(Session& session, Words words) {
  session.assets.updateNow(session);
  if (!words.empty()) session.assets.search = words[0];
  Answer answer = nlohmann::json::array();
  for (const AssetGroup& group : session.assets.groups())
    for (const Asset& asset : group.assets)
      if (matches(asset, session.assets.search))
        answer->push_back({{"name", asset.file.filename().string()},
                           {"kind", kindWord(asset.kind)},
                           {"file", asset.file.string()},
                           {"bytes", asset.bytes},
                           {"group", group.title}});
  return answer;
}

Answer useAsset(Session& session, Words words) {
  std::optional<Asset> asset = assetAt(words[0]);
  if (!asset) {
    session.assets.updateNow(session);
    if (const Asset* listed = session.assets.find(words[0])) asset = *listed;
  }
  if (!asset) return fail(words[0], "is no asset", "\"assets\" lists them");
  if (asset->kind == AssetKind::EnvironmentMap)
    return runCommand(session, "environment-map", std::array{asset->file.string()});
  return answerOf(session.files.open({asset->file}));
}

constexpr std::array kAssetRows = {
    scripted("assets", "Environment maps, scenes, bundles and worlds to choose from, searched", "[SEARCH]", 0,
             1, &assets),
    scripted("use-asset", "Light from this environment map; open this scene, bundle or world", "FILE", 1, 1,
             &useAsset),
};

}  // namespace

std::span<const Command> assetCommands() {
  return kAssetRows;
}

}  // namespace lambent::editor
