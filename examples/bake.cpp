// Bakes a mesh that it has in memory: a bowl of triangles on a floor, and a ball above it that may move. Says
// how far it is while it goes on. Usage: bake OUT.lmb.glb
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <lambent/bake.hpp>

// A surface of revolution about +Y, whose profile goes from angle `from` to angle `to` of a circle.
static void revolve(float from, float to, std::vector<lambent::Vec3>& positions, std::vector<std::uint32_t>& indices) {
  const std::uint32_t around = 48, along = 24;
  for (std::uint32_t j = 0; j <= along; ++j)
    for (std::uint32_t i = 0; i <= around; ++i) {
      const float a = from + (to - from) * float(j) / along, b = 2 * std::numbers::pi_v<float> * float(i) / around;
      positions.push_back({std::sin(a) * std::sin(b), std::cos(a), std::sin(a) * std::cos(b)});
    }
  for (std::uint32_t j = 0; j < along; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t v = j * (around + 1) + i, w = v + around + 1;
      indices.insert(indices.end(), {v, w, v + 1, v + 1, w, w + 1});
    }
}

int main(int count, char** words) {
  if (count != 2) return std::fprintf(stderr, "usage: bake OUT.lmb.glb\n"), 2;
  const float pi = std::numbers::pi_v<float>;
  std::vector<lambent::Vec3> ball, bowl;
  std::vector<std::uint32_t> ball_faces, bowl_faces;
  revolve(0.0f, pi, ball, ball_faces);
  revolve(0.55f * pi, pi, bowl, bowl_faces);
  const std::vector<lambent::Vec3> floor = {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}};
  const std::vector<std::uint32_t> floor_faces = {0, 1, 2, 0, 2, 3};

  lambent::BakeScene scene;
  const lambent::BakeMesh meshes[] = {{.name = "floor", .positions = floor, .indices = floor_faces, .albedo = {0.7f, 0.7f, 0.7f}},
                                      {.name = "bowl",
                                       .positions = bowl,
                                       .normals = bowl,
                                       .indices = bowl_faces,
                                       .albedo = {0.8f, 0.3f, 0.2f},
                                       .double_sided = true,
                                       .world_from_mesh = {1.5f, 0, 0, 0, 0, 1.5f, 0, 0, 0, 0, 1.5f, 0, 0, 1.55f, 0, 1}},
                                      {.name = "ball",
                                       .positions = ball,
                                       .normals = ball,
                                       .indices = ball_faces,
                                       .movable = true,
                                       .world_from_mesh = {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 2.2f, 0, 1}}};
  for (const lambent::BakeMesh& mesh : meshes)
    if (const auto added = scene.add(mesh); !added) return std::puts(added.failure().line().c_str()), 1;

  lambent::Baker baker;
  for (const auto& [name, value] : {std::pair{"quality", "draft"}, {"rays", "256"}, {"bounces", "2"}})
    if (const auto set = baker.set(name, value); !set) return std::puts(set.failure().line().c_str()), 1;
  const auto watch = [](const lambent::BakeProgress& seen) {
    std::printf("%3.0f %%  %s, %llu %s\n", 100 * seen.fraction, seen.stage.c_str(), static_cast<unsigned long long>(seen.done),
                seen.unit.c_str());
    return true;  // go on
  };
  const auto baked = baker.run(scene, words[1], watch);
  if (!baked) return std::puts(baked.failure().line().c_str()), 1;
  std::printf("%s: %.1f million rays, %llu bytes, %.1f s\n", words[1], 1e-6 * double(baked->rays),
              static_cast<unsigned long long>(baked->file_bytes), baked->seconds);
}
