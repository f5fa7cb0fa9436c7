#include "reference/digest.hpp"

#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "runtime/bundle/checksum.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker::reference {

namespace {

// The length of a list is hashed, too, so that different inputs differ. Only types without padding are
// allowed.
class Digest {
 public:
  template <typename... T>
  void add(const T&... values) {
    (addOne(values), ...);
  }
  template <typename T>
  void addList(const std::vector<T>& list) {
    addOne(list.size());
    addOne(bundle::checksum(std::as_bytes(std::span(list))));
  }
  std::uint64_t value() const { return bundle::checksum(bytes_); }

 private:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void addOne(const T& value) {
    const auto raw = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  std::vector<std::byte> bytes_;
};

void add(const gltf::TextureRef& ref, Digest& digest) {
  digest.add(ref.texture, ref.texcoord, ref.offset, ref.scale, ref.rotation_rad);
}

// The fields for reflection are hashed between the other values and the other textures.
void add(const gltf::Material& material, Digest& digest) {
  const auto addValues = [&](bool reflection) {
    gltf::forEachMaterialValue([&](const auto& field) {
      if ((field.part == gltf::MaterialPart::Reflection) == reflection) digest.add(material.*field.member);
    });
  };
  const auto addTextures = [&](bool reflection) {
    gltf::forEachMaterialTexture([&](const auto& field) {
      if ((field.part == gltf::MaterialPart::Reflection) == reflection) add(material.*field.member, digest);
    });
  };
  addValues(false), addValues(true);
  addTextures(true), addTextures(false);
}

void add(const Scene& scene, Digest& digest) {
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    digest.add(world[n], scene.nodes[n].mesh, scene.nodes[n].light);
  for (const SceneMesh& mesh : scene.meshes) {
    digest.add(mesh.primitives.size());
    for (const ScenePrimitive& primitive : mesh.primitives) {
      const bundle::MeshData& data = primitive.mesh;
      digest.add(primitive.material);
      digest.addList(data.positions), digest.addList(data.normals), digest.addList(data.normal_weights);
      digest.addList(data.texcoords0);
      digest.addList(data.texcoords1), digest.addList(data.colors), digest.addList(data.tangents);
      digest.addList(data.indices);
    }
  }
  for (const gltf::Material& material : scene.materials) add(material, digest);
  for (const MeasuredBrdf& brdf : scene.brdfs) digest.addList(brdf.measurements);
  for (const gltf::Texture& texture : scene.textures)
    digest.add(texture.image, texture.sampler.wrap_s, texture.sampler.wrap_t, texture.sampler.mag_filter);
  for (const SceneImage& image : scene.images) digest.addList(image.file_bytes);
  digest.add(scene.volumes.size());
  for (const SceneVolume& volume : scene.volumes) {
    digest.add(volume.node, volume.size, volume.node_from_grid, volume.albedo, volume.g);
    digest.addList(volume.density);
  }
  for (const gltf::Light& l : scene.lights)
    digest.add(l.type, l.color, l.intensity, l.range_m, l.inner_cone_rad, l.outer_cone_rad);
}

void add(const spec::DistantLights& lights, Digest& digest) {
  digest.add(lights.constant, lights.discs.size());
  for (const spec::Disc& disc : lights.discs) digest.add(disc.direction, disc.radius_rad, disc.radiance);
  for (const spec::EnvironmentMap& environment_map : lights.environment_maps) {
    digest.add(environment_map.layout, environment_map.image.width, environment_map.image.height);
    digest.addList(environment_map.image.texels);
  }
}

void add(const std::vector<spec::LocalLight>& shapes, Digest& digest) {
  digest.add(shapes.size());
  for (const spec::LocalLight& shape : shapes) {
    digest.add(shape.index());
    if (const auto* sphere = std::get_if<spec::SphereLight>(&shape))
      digest.add(sphere->position_ws, sphere->radius_m, sphere->radiance);
    else if (const auto* disc = std::get_if<spec::DiscLight>(&shape))
      digest.add(disc->position_ws, disc->normal_ws, disc->radius_m, disc->radiance);
  }
}

}  // namespace

std::uint64_t digestOf(const Scene& scene, const spec::DistantLights& lights,
                       const std::vector<spec::LocalLight>& shapes, const spec::View& view,
                       const Options& options) {
  Digest digest;
  for (const char c : std::string_view(LAMBENT_VERSION " " LAMBENT_ISA)) digest.add(c);
  add(scene, digest);
  add(lights, digest);
  add(shapes, digest);
  digest.add(view.view_from_world, view.clip_from_view);
  const BandLimit limit = options.band_limit.value_or(BandLimit{.in = 0, .out = {}});
  digest.add(options.size.width, options.size.height, options.spp, options.seed, limit.in,
             limit.out.value_or(0), options.bounces.has_value(), options.bounces.value_or(0),
             options.rotate_light_deg);
  return digest.value();
}

}  // namespace lambent::baker::reference
