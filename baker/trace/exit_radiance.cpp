#include "baker/trace/exit_radiance.hpp"

#include <array>

#include <glm/geometric.hpp>

#include "baker/transport/frame.hpp"

namespace lambent::baker {

ExitRadiance::ExitRadiance(const GroupGeometry& geometry, const SampleSet& samples,
                           const BouncePartner* partner)
    : glossy_begin_(samples.glossy.begin), partner_(partner) {
  triangle_samples_.reserve(geometry.triangles.size());
  for (const glm::uvec3& t : geometry.triangles)
    triangle_samples_.emplace_back(samples.vertex_sample[t.x], samples.vertex_sample[t.y],
                                   samples.vertex_sample[t.z]);
}

void ExitRadiance::addDiffuse(const GatherHit& hit, float weight, const TransferField& before,
                              std::span<float> sum) const {
  const glm::uvec3 corners = triangle_samples_[hit.triangle];
  const float u = static_cast<float>(hit.u) * (1.0f / 65535.0f),
              v = static_cast<float>(hit.v) * (1.0f / 65535.0f);
  const float* a = before.at(corners.x).data();
  const float* b = before.at(corners.y).data();
  const float* c = before.at(corners.z).data();
  float* out = sum.data();
  const std::size_t columns = before.columns;
  for (std::size_t channel = 0; channel < before.channels; ++channel) {
    const float albedo = weight * static_cast<float>(hit.albedo[channel]) * (1.0f / 65535.0f);
    const float wa = albedo * (1.0f - u - v), wb = albedo * u, wc = albedo * v;
    for (std::size_t i = 0; i < columns; ++i) out[i] += wa * a[i] + wb * b[i] + wc * c[i];
    a += columns, b += columns, c += columns, out += columns;
  }
}

void ExitRadiance::addGlossy(const GatherHit& hit, const glm::vec3& to, float chance, float weight,
                             std::span<float> sum) const {
  if (partner_) partner_->addExit(hit, triangle_samples_[hit.triangle], to, chance, weight, sum);
}

void ExitRadiance::addPatches(const GatherHit& hit, const glm::vec3& to, float weight,
                              const PatchRadiance& patches, std::span<float> sum) const {
  const glm::vec3 reflected = weight * albedo(hit, to);
  const float u = static_cast<float>(hit.u) * (1.0f / 65535.0f),
              v = static_cast<float>(hit.v) * (1.0f / 65535.0f);
  const glm::uvec3 corners = triangle_samples_[hit.triangle];
  const std::array<float, 3> shares = {1.0f - u - v, u, v};
  const std::size_t columns = patches.field.columns;
  for (int corner = 0; corner < 3; ++corner) {
    const float* in = patches.field.at(patches.patches.of_sample[corners[corner]]).data();
    float* out = sum.data();
    for (std::size_t c = 0; c < patches.field.channels; ++c, in += columns, out += columns) {
      const float factor = shares[static_cast<std::size_t>(corner)] * reflected[static_cast<int>(c)];
      for (std::size_t i = 0; i < columns; ++i) out[i] += factor * in[i];
    }
  }
}

glm::vec3 ExitRadiance::albedo(const GatherHit& hit, const glm::vec3& to) const {
  if (partner_ && !isDiffuse(hit)) return partner_->albedo(hit, to);
  return glm::vec3(hit.albedo[0], hit.albedo[1], hit.albedo[2]) * (1.0f / 65535.0f);
}

ExitToSample::ExitToSample(const Bounce& bounce, const DirectionTable& table, const glm::vec3& normal,
                           std::size_t sample)
    : bounce_(bounce), table_(table) {
  if (!bounce.exit.anyGlossy()) return;
  frame_ = glm::mat3(localFrame(glm::normalize(glm::dvec3(normal))));
  seed_ = static_cast<std::uint32_t>(sample) * 0x9E3779B9u ^
          static_cast<std::uint32_t>(bounce.number) * 0x85EBCA6Bu;
  seed_ = (seed_ ^ seed_ >> 16) * 0x7FEB352Du;
  seed_ ^= seed_ >> 15;
}

void ExitToSample::addGlossy(const GatherHit& hit, float weight, std::span<float> sum) const {
  const glm::vec3 along = frame_ * glm::vec3(table_.x[hit.ray], table_.y[hit.ray], table_.z[hit.ray]);
  // A golden-ratio sequence over neighbouring rays shares out the corners evenly.
  const std::uint32_t dealt = seed_ + hit.ray * 2654435769u;
  const float chance = bounce_.thinly ? static_cast<float>(dealt >> 8) * 0x1p-24f : -1.0f;
  bounce_.exit.addGlossy(hit, -along, chance, weight, sum);
  if (bounce_.of_patches) bounce_.exit.addPatches(hit, -along, weight, *bounce_.of_patches, sum);
}

}  // namespace lambent::baker
