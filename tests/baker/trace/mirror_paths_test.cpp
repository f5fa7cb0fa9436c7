// Light that smooth dielectrics pass on, against integrals over the half space and against furnaces.
#include "baker/trace/mirror_paths.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/ext/matrix_transform.hpp>

#include "runtime/sh/zonal.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glossy_transport.hpp"

namespace lambent::baker {
namespace {

using testing::flipped;
using testing::grid;
using testing::sceneOf;
using testing::transformed;
using testing::Transport;
using testing::turned;

// A Lacquered scene has the first mesh of a smooth dielectric; the others are white.
struct Lacquered {
  Lacquered(const std::vector<bundle::MeshData>& meshes, float base, float roughness, bool lamp = false)
      : transport(sceneWith(meshes, base, roughness, lamp), /*with_glossy=*/true),
        surfaces(transport),
        mirrors(transport.geometry, transport.rays, transport.colors, surfaces.brdfs, lamp) {
    EXPECT_TRUE(transport.samples.glossy.empty()) << "smooth dielectrics have diffuse samples";
    transport.mirrors = &mirrors;
  }

  static Scene sceneWith(const std::vector<bundle::MeshData>& meshes, float base, float roughness,
                         bool lamp) {
    Scene scene = sceneOf(meshes);
    gltf::Material& lacquer = testing::ownMaterial(scene, 0);
    lacquer.roughness = roughness;
    lacquer.base_color = glm::vec4(glm::vec3(base), 1.0f);
    if (lamp) testing::addPointLight(scene, {0, 0, 1});
    return scene;
  }

  Transport transport;
  testing::TransportBrdfs surfaces;
  MirrorPaths mirrors;
};

// Faces +z.
bundle::MeshData floorOf(float width, int n, const glm::vec3& centre = glm::vec3(0.0f)) {
  return transformed(turned(grid({0, 0, 0}, width, n), 90.0f, {1, 0, 0}),
                     glm::translate(glm::mat4(1.0f), centre));
}
// Faces -z, towards the floor.
bundle::MeshData plateAt(const glm::vec3& place) {
  return flipped(floorOf(0.01f, 7, place));
}
// Returns the mean of a column of what is bounced over the plate's samples, which have rays of their own.
double meanAt(const Transport& t, const TransferField& bounced, const glm::vec3& place, std::size_t column) {
  double sum = 0.0, count = 0.0;
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    if (glm::distance(t.samples.positions[s], place) > 0.01f) continue;
    sum += double{bounced.at(s)[column]};
    ++count;
  }
  EXPECT_EQ(count, 64.0);
  return sum / count;
}

TEST(MirrorPaths, ABlackLacqueredFloorSendsAPlateAboveItTheSkyThatItMirrors) {
  const glm::vec3 place(0, 0, 0.2f);
  const Lacquered floor({floorOf(80.0f, 8), plateAt(place)}, 0.0f, 0.05f);
  const auto baked = floor.transport.bake(5, 4096, 1);
  const double f0 = 0.04;
  for (int l = 0; l < 5; ++l) {
    // E/pi = 2 ∫ F(c) c y_l0(c) dc from above, where a floor that spread it evenly would weigh all with F's
    // mean.
    double mirrored = 0.0, spread = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = (i + 0.5) / kSteps;
      const double fresnel = f0 + (1.0 - f0) * std::pow(1.0 - c, 5);
      const double y = std::sqrt((2 * l + 1) / (4.0 * std::numbers::pi)) * sh::legendre(l, c);
      mirrored += 2.0 * fresnel * c * y / kSteps;
      spread += 2.0 * (f0 + (1.0 - f0) / 21.0) * c * y / kSteps;
    }
    const double found = meanAt(floor.transport, baked.bounced.field, place,
                                static_cast<std::size_t>(sh::coefficientIndex(l, 0)));
    EXPECT_NEAR(found, mirrored, 2e-4) << l;
    if (l > 0) {
      EXPECT_GT(std::abs(mirrored - spread), 3e-3) << l;
    }
  }
}

TEST(MirrorPaths, InAWhiteFurnaceLacquerLosesAndMakesNoLight) {
  // A white floor of any smoothness and a white wall on it: each sees 1 everywhere.
  for (const float roughness : {0.05f, 0.4f}) {
    const bundle::MeshData wall = turned(floorOf(2.0f, 12, {-1, 0, 0}), 90.0f, {0, 1, 0});
    const Lacquered corner({floorOf(2.0f, 12, {1, 0, 0}), wall}, 1.0f, roughness);
    const auto baked = corner.transport.bake(3, 1024, -1, 1e-4);
    double sum = 0.0, largest = 0.0;
    const std::size_t count = corner.transport.samples.size();
    for (std::size_t s = 0; s < count; ++s) {
      const double all = double{testing::uniformRadiance(baked.direct.field.at(s))} +
                         double{testing::uniformRadiance(baked.bounced.field.at(s))};
      sum += all;
      largest = testing::larger(largest, std::abs(all - 1.0));
    }
    EXPECT_NEAR(sum / static_cast<double>(count), 1.0, 0.002) << roughness;
    EXPECT_LT(largest, 0.03) << roughness;
  }
}

TEST(MirrorPaths, ALampsLightLeavesALacqueredFloorInAllDirectionsByWhatItReflectsTowardsEach) {
  const glm::vec3 place(0.7f, 0, 0.5f);
  const Lacquered floor({floorOf(8.0f, 80), plateAt(place)}, 0.0f, 0.3f, /*lamp=*/true);
  const auto baked = floor.transport.bake(2, 4096, 1);
  ASSERT_EQ(baked.bounced.field.columns, 5u);
  double expected = 0.0;
  constexpr int kSteps = 800;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i) {
      const glm::dvec3 at(8.0 * ((i + 0.5) / kSteps - 0.5), 8.0 * ((j + 0.5) / kSteps - 0.5), 0.0);
      const glm::dvec3 to_lamp = glm::dvec3(0, 0, 1) - at, to_plate = glm::dvec3(place) - at;
      const double lamp = glm::length(to_lamp), plate = glm::length(to_plate);
      const double irradiance = to_lamp.z / (lamp * lamp * lamp), cosine = to_plate.z / plate;
      expected += irradiance / std::numbers::pi *
                  double{floor.surfaces.brdfs.layerAlbedo(0, static_cast<float>(cosine))} * cosine * cosine /
                  (plate * plate * std::numbers::pi) * (8.0 / kSteps) * (8.0 / kSteps);
    }
  EXPECT_GT(expected, 1e-3);
  EXPECT_NEAR(meanAt(floor.transport, baked.bounced.field, place, 4), expected, 0.01 * expected);
}

}  // namespace
}  // namespace lambent::baker
