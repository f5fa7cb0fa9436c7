// Tests where reflection probes are placed.
#include "runtime/lighting/probe_places.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lambent::lighting {
namespace {

void addAllRound(SurfaceVoxels& voxels, const glm::ivec3& voxel) {
  voxels.add(voxel, glm::vec3(0.577f));
  voxels.add(voxel, glm::vec3(-0.577f));
}

// Returns a room of this size with walls that face inwards, or a body with walls that face outwards.
SurfaceVoxels box(const glm::vec3& size, bool inwards) {
  SurfaceVoxels voxels = SurfaceVoxels::over(glm::vec3(0.0f), size);
  const glm::ivec3 last = voxels.count - 2;
  for (int z = 1; z <= last.z; ++z)
    for (int y = 1; y <= last.y; ++y)
      for (int x = 1; x <= last.x; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const glm::ivec3 voxel(x, y, z);
          glm::vec3 normal(0.0f);
          if (voxel[axis] == 1) normal[axis] = inwards ? 1.0f : -1.0f;
          if (voxel[axis] == last[axis]) normal[axis] = inwards ? -1.0f : 1.0f;
          voxels.add(voxel, normal);
        }
  return voxels;
}

TEST(ProbePlaces, TheFirstStandsInTheAirOfAClosedRoom) {
  const glm::vec3 size(4.0f, 2.5f, 3.0f);
  const auto places = chooseProbePlaces(box(size, /*inwards=*/true), 1);
  ASSERT_EQ(places.size(), 1u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(places[0][axis], 0.2f);
    EXPECT_LT(places[0][axis], size[axis] - 0.2f);
  }
}

TEST(ProbePlaces, ARoomDividedByAWallGetsAProbeOnEachSide) {
  SurfaceVoxels voxels = box({4.0f, 2.0f, 2.0f}, /*inwards=*/true);
  const int middle = voxels.count.x / 2;
  for (int z = 1; z < voxels.count.z - 1; ++z)
    for (int y = 1; y < voxels.count.y - 1; ++y) addAllRound(voxels, {middle, y, z});
  const auto places = chooseProbePlaces(voxels, 2);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_LT((places[0].x - 2.0f) * (places[1].x - 2.0f), 0.0f);
}

TEST(ProbePlaces, ANicheBetweenAFloorAndABodyIsNoRoom) {
  SurfaceVoxels voxels = SurfaceVoxels::over(glm::vec3(0.0f), glm::vec3(4.0f, 2.0f, 4.0f));
  for (int z = 1; z < voxels.count.z - 1; ++z)
    for (int x = 1; x < voxels.count.x - 1; ++x) {
      voxels.add({x, 1, z}, glm::vec3(0, 1, 0));
      for (int y = 2; y < 18; ++y) {
        const glm::vec3 from = glm::vec3(x, y, z) - glm::vec3(20.0f, 10.0f, 20.0f);
        if (glm::dot(from, from) < 64.0f) addAllRound(voxels, {x, y, z});
      }
    }
  EXPECT_TRUE(chooseProbePlaces(voxels, 16).empty());
}

}  // namespace
}  // namespace lambent::lighting
