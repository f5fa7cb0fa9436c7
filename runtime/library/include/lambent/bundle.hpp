// Reads bundles without OpenGL: which groups and surfaces a bundle has, their geometry, and their transfer as
// plain numbers. A Bundle may be used from any thread, and by several at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lambent/export.hpp"
#include "lambent/math.hpp"
#include "lambent/result.hpp"
#include "lambent/sh.hpp"

namespace lambent {

// Tells what the numbers of samples are (docs/conventions.md, "Light and transfer").
enum class TransferForm : std::uint8_t {
  Vector,        // irradiance / pi, or in volumes the mean radiance: one output
  NormalMapped,  // light in bands 0..2 for normals that vary by pixel: nine outputs
  Visibility,    // visibility in bands; its product with the light gives direct light in bands
  Matrix         // transferred light in bands: 16, 25 or 36 outputs, or 9 around bodies
};

// Tells where samples lie.
enum class TransferPlace : std::uint8_t { Surface, Volume, Neighborhood };

// Return the words that stand for them in exported descriptions and in Python: "normal-mapped", "surface".
LAMBENT_API const char* nameOf(TransferForm form);
LAMBENT_API const char* nameOf(TransferPlace place);

// Describes transfer of a run of samples of a group. The numbers of Bundle::transfer() are indexed
// [sample][channel][output][column]. The first order² columns belong to the light at infinity, those after
// them to the group's own lamps. Light of blocks with the same samples is summed.
struct TransferBlock {
  TransferForm form = TransferForm::Vector;
  TransferPlace place = TransferPlace::Surface;
  std::uint32_t first_sample = 0, samples = 0;
  std::uint32_t order = 0;                 // bands of light at infinity; 0: lamps only
  std::uint32_t lamps = 0;                 // columns of lamps
  std::uint32_t shadowed_channels = 0;     // channels of direct light with shadows, which come first
  std::uint32_t full_channels = 0;         // then those of direct and bounced light; 0 without bounces
  std::uint32_t outputs = 1, columns = 0;  // of Visibility: one output, bands² columns and one channel

  std::uint32_t channels() const { return shadowed_channels + full_channels; }
  std::size_t values() const { return std::size_t{samples} * channels() * outputs * columns; }
};

// Describes a rigid group: what never moves within itself. Transfer is in its frame.
struct GroupInfo {
  std::string name{};
  std::uint32_t samples = 0;
  Matrix4 world_from_group = kIdentity;  // as baked, without scale
  Vec3 bounds_min{}, bounds_max{};       // in its frame
  std::vector<std::string> lamps{};      // names of emissive materials and nodes, in the order of columns
  std::vector<TransferBlock> blocks{};
};

// Describes one side of a primitive at a node.
struct SurfaceInfo {
  std::string mesh{}, material{};  // names; may be empty
  std::uint32_t group = 0;
  std::uint32_t vertices = 0, triangles = 0;
  bool back = false;              // normals and winding are turned around
  Vec3 albedo{1.0f, 1.0f, 1.0f};  // linear base colour factor; textures and vertex colours multiply it
  TransferForm form = TransferForm::Vector;
};

struct SurfaceData {
  std::vector<Vec3> positions{}, normals{};  // in the frame of the group, one per vertex
  std::vector<std::uint32_t> indices{};      // three per triangle
  // Transfer at vertex v is the sum of weights[k] times that of sample samples[k] of the group, for k in
  // [offsets[v], offsets[v + 1]). Weights sum to 1.
  std::vector<std::uint32_t> offsets{}, samples{};
  std::vector<float> weights{};
};

class LAMBENT_API Bundle {
 public:
  // Fails if the file is no bundle, too new or damaged. Reads its description only.
  static Expected<Bundle> open(const std::string& path);
  Bundle(Bundle&&) noexcept;
  Bundle& operator=(Bundle&&) noexcept;
  ~Bundle();

  const std::vector<GroupInfo>& groups() const;
  const std::vector<SurfaceInfo>& surfaces() const;

  // These read and decode. They fail if the file is damaged or if there is no such surface, group or block.
  Expected<SurfaceData> surface(std::uint32_t index) const;
  Expected<std::vector<float>> transfer(std::uint32_t group, std::uint32_t block) const;
  // Returns E / pi at each vertex of a surface whose form is Vector or NormalMapped, lamps off, under light
  // in the frame of its group. The surface's albedo times this is what leaves it. `full` adds bounces, where
  // they were baked. Fails if the surface has another form, too.
  Expected<std::vector<Vec3>> shade(std::uint32_t surface, const LightVector& light, bool full = true) const;

 private:
  struct File;
  explicit Bundle(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace lambent
