// Holds all of a world except its entities: its bundles, the distant lights, the camera, and the settings of
// the frame and of the editor's windows. It is a plain value: the history stores it before and after a step,
// world files store it, and the program follows it. Words are those of the command line
// (docs/conventions.md). Paths are as in the world file.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lambent::editor {

// Holds what this version does not know, as JSON text by key. It is kept and written back.
using UnknownFields = std::map<std::string, std::string>;

struct BundleEntry {
  std::string path;            // relative to the world file's folder, or absolute; '/' between folders
  std::string id;              // the bundle's part of a StableId (scene::InstantiateOptions::bundle_id)
  std::uint32_t instance = 0;  // distinguishes bundles of the same id
  std::string source;          // the glTF file that it was baked from, a path like `path`; empty: unknown
  std::map<std::string, std::string> bake_options;  // by name, as in Description::bake_options
  UnknownFields unknown;
  bool operator==(const BundleEntry&) const = default;
};

struct WorldState {
  std::vector<BundleEntry> bundles;
  // Distant lights, in the words of --light and --fade-light. Lights within the scene are entities;
  // intensity, rotation and fade are fields of the EnvironmentComponent.
  std::vector<std::string> lights, fade_lights;
  // Edits of key lights that were found in the environment maps among these lights, in the words of
  // --edit-key.
  std::vector<std::string> key_edits;
  std::optional<float> exposure_ev;             // none: automatic
  std::string camera;                           // a camera word; empty: the program chooses
  std::map<std::string, std::string> settings;  // of the frame, by option name
  std::map<std::string, std::string> view;      // of the editor: free camera, panels
  bool operator==(const WorldState&) const = default;
};

}  // namespace lambent::editor
