// Holds what a world is beside its entities: which bundles stand in it, the light from infinity, the camera,
// the settings of the frame and of the editor's windows. It is a plain value: history keeps two of it for a
// step, the world file writes it, the program reads it and follows. Words are those of the command line
// (docs/conventions.md); paths are as the world file has them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lambent::editor {

// What this version does not know, as JSON texts by key; it is kept and written back.
using UnknownFields = std::map<std::string, std::string>;

struct BundleEntry {
  std::string path;            // relative to the world file's folder, or absolute; '/' between folders
  std::string id;              // what StableIds call it by (scene::InstantiateOptions::bundle_id)
  std::uint32_t instance = 0;  // tells apart several of one id
  std::string source;          // the glTF file it was baked from, as path; empty: not known
  std::map<std::string, std::string> bake_options;  // by name, as Description::bake_options
  UnknownFields unknown;
  bool operator==(const BundleEntry&) const = default;
};

struct WorldState {
  std::vector<BundleEntry> bundles;
  // From infinity, as --light and --fade-light take them. Those that stand in the scene are entities;
  // intensity, rotation and fade are fields of the EnvironmentComponent.
  std::vector<std::string> lights, fade_lights;
  // Of key lights that were found in environment maps among these, as --edit-key takes them.
  std::vector<std::string> key_edits;
  std::optional<float> exposure_ev;             // none: automatic
  std::string camera;                           // a camera word; empty: the program's choice
  std::map<std::string, std::string> settings;  // of the frame, by option name
  std::map<std::string, std::string> view;      // of the editor: free camera, panels
  bool operator==(const WorldState&) const = default;
};

}  // namespace lambent::editor
