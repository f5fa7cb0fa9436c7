#include "editor/gizmo/gizmo.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "editor/gizmo/projection.hpp"
#include "runtime/scene/transforms.hpp"
#include "tests/support/differences.hpp"
#include "views.hpp"

namespace lambent::editor {
namespace {

using testing::kViewport;
using testing::lookAt;

glm::dmat4 worldOf(const GizmoTarget& target, const scene::Transform& local) {
  return glm::dmat4(target.world_from_parent) * glm::dmat4(scene::localMatrix(local));
}
glm::dvec3 place(const GizmoTarget& target, const scene::Transform& local) {
  return glm::dvec3(worldOf(target, local)[3]);
}

// Lists parents as files have them: none, rotated and scaled, mirrored, non-uniformly scaled, sheared, far
// away and tiny.
std::vector<glm::mat4> parents() {
  const glm::mat4 one(1.0f);
  const glm::mat4 turned = glm::rotate(one, 0.8f, glm::normalize(glm::vec3(1.0f, 2.0f, 3.0f)));
  glm::mat4 sheared = one;
  sheared[1][0] = 0.6f;
  return {one,
          glm::scale(turned, glm::vec3(3.0f)),
          glm::scale(turned, glm::vec3(-1.0f, 1.0f, 1.0f)),
          glm::scale(turned, glm::vec3(0.2f, 5.0f, -1.0f)),
          turned * sheared,
          glm::scale(glm::translate(one, glm::vec3(0.1f, 0.0f, 0.0f)), glm::vec3(1e-3f))};
}

// Makes a target at (0.3, 0.2, -0.1) in the world, for any parent.
GizmoTarget targetBelow(const glm::mat4& parent) {
  GizmoTarget target;
  target.world_from_parent = parent;
  target.local.translation = glm::vec3(glm::inverse(parent) * glm::vec4(0.3f, 0.2f, -0.1f, 1.0f));
  target.local.rotation = glm::normalize(glm::quat(0.7f, 0.2f, -0.4f, 0.1f));
  target.local.scale = glm::vec3(1.0f, 2.0f, 0.5f);
  return target;
}

constexpr glm::vec3 kEye(2.0f, 3.0f, 4.0f), kAt(0.3f, 0.2f, -0.1f);

TEST(Gizmo, DraggingAnAxisBySomePixelsMovesByWhatIsSeenAsThosePixels) {
  for (const bool perspective : {true, false}) {
    const spec::View view = lookAt(kEye, kAt, perspective);
    const Projection projection(view, kViewport);
    for (const GizmoSpace space : {GizmoSpace::World, GizmoSpace::Local}) {
      for (const glm::mat4& parent : parents()) {
        const GizmoTarget target = targetBelow(parent);
        for (const Handle handle : {Handle::X, Handle::Y, Handle::Z}) {
          Gizmo gizmo;
          gizmo.options.space = space;
          gizmo.setView(view, kViewport);
          gizmo.setTargets({target});
          const auto grab = gizmo.handleScreenPoint(handle);
          if (!grab) continue;  // points at the viewer
          ASSERT_EQ(gizmo.hit(*grab), handle);
          ASSERT_TRUE(gizmo.press(*grab));
          const glm::dvec3 axis =
              space == GizmoSpace::Local
                  ? glm::normalize(glm::dvec3(worldOf(target, target.local)[static_cast<int>(handle) - 1]))
                  : glm::dvec3(glm::mat3(1.0f)[static_cast<int>(handle) - 1]);
          const glm::dvec2 from = *projection.toScreen(place(target, target.local));
          const glm::dvec2 along =
              glm::normalize(*projection.toScreen(place(target, target.local) + 0.01 * axis) - from);
          for (const double pixels : {-120.0, -1.0, 25.0, 200.0}) {
            // A movement perpendicular to the axis changes nothing.
            const glm::dvec2 pointer =
                glm::dvec2(*grab) + pixels * along + 37.0 * glm::dvec2(-along.y, along.x);
            const scene::Transform moved = gizmo.drag(glm::vec2(pointer))[0];
            const glm::dvec3 way = place(target, moved) - place(target, target.local);
            EXPECT_LT(glm::length(glm::cross(way, axis)), 1e-5) << "leaves the axis";
            // The grabbed point of the axis is seen that much further along.
            const double t = glm::dot(way, axis);
            const double taken = *projection.alongLine(place(target, target.local), axis, along,
                                                       glm::dot(along, glm::dvec2(*grab)));
            const glm::dvec2 seen = *projection.toScreen(place(target, target.local) + (taken + t) * axis);
            EXPECT_NEAR(glm::dot(along, seen - glm::dvec2(*grab)), pixels, 0.02)
                << handleWord(handle) << (perspective ? " perspective" : " orthographic");
            EXPECT_EQ(moved.rotation, target.local.rotation);
            EXPECT_EQ(moved.scale, target.local.scale);
          }
          EXPECT_EQ(gizmo.drag(*grab)[0].translation, target.local.translation) << "back to where it began";
          gizmo.release();
        }
      }
    }
  }
}

TEST(Gizmo, DraggingInAPlaneOrThePictureKeepsThePointUnderThePointer) {
  for (const bool perspective : {true, false}) {
    const spec::View view = lookAt(kEye, kAt, perspective);
    const Projection projection(view, kViewport);
    for (const glm::mat4& parent : parents()) {
      const GizmoTarget target = targetBelow(parent);
      for (const Handle handle : {Handle::XY, Handle::YZ, Handle::ZX, Handle::Screen}) {
        Gizmo gizmo;
        gizmo.setView(view, kViewport);
        gizmo.setTargets({target});
        ASSERT_TRUE(gizmo.press(handle, *gizmo.pivotScreenPoint())) << handleWord(handle);
        const glm::vec2 pointer = *gizmo.pivotScreenPoint() + glm::vec2(31.0f, -17.0f);
        const glm::dvec3 now = place(target, gizmo.drag(pointer)[0]);
        EXPECT_LT(glm::length(*projection.toScreen(now) - glm::dvec2(pointer)), 0.02);
        const glm::dvec3 normal = handle == Handle::XY   ? glm::dvec3(0, 0, 1)
                                  : handle == Handle::YZ ? glm::dvec3(1, 0, 0)
                                  : handle == Handle::ZX ? glm::dvec3(0, 1, 0)
                                                         : projection.back();
        EXPECT_NEAR(glm::dot(now - place(target, target.local), normal), 0.0, 1e-5);
      }
    }
  }
}

TEST(Gizmo, ARingFollowsThePointerAndTurnsRigidlyBelowAnyParent) {
  for (const bool perspective : {true, false}) {
    const spec::View view = lookAt(kEye, kAt, perspective);
    const Projection projection(view, kViewport);
    for (const glm::mat4& parent : parents()) {
      const GizmoTarget target = targetBelow(parent);
      const glm::dmat4 before = worldOf(target, target.local);
      for (const Handle handle : {Handle::X, Handle::Y, Handle::Z}) {
        Gizmo gizmo;
        gizmo.options.mode = GizmoMode::Rotate;
        gizmo.setView(view, kViewport);
        gizmo.setTargets({target});
        const glm::dvec3 pivot = place(target, target.local);
        glm::dvec3 axis(0.0), e1(0.0);
        axis[static_cast<int>(handle) - 1] = 1.0;
        e1[static_cast<int>(handle) % 3] = 1.0;
        const glm::dvec3 e2 = glm::cross(axis, e1);
        const auto at = [&](double angle) {
          return glm::vec2(*projection.toScreen(pivot + 0.2 * (std::cos(angle) * e1 + std::sin(angle) * e2)));
        };
        ASSERT_TRUE(gizmo.press(handle, at(0.3)));
        // The pointer moves in steps, by more than a full circle.
        std::vector<scene::Transform> turned;
        for (int step = 1; step <= 80; ++step) turned = gizmo.drag(at(0.3 + 0.1 * step));
        const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 8.0, axis));
        const glm::dmat4 now = worldOf(target, turned[0]);
        const double size = glm::length(before[0]) + glm::length(before[1]) + glm::length(before[2]);
        for (int column = 0; column < 3; ++column)
          EXPECT_LT(glm::length(glm::dvec3(now[column]) - turn * glm::dvec3(before[column])), 2e-5 * size);
        EXPECT_LT(glm::length(glm::dvec3(now[3] - before[3])), 1e-5);
        EXPECT_EQ(gizmo.readout().substr(0, 7), std::string(handleWord(handle)) + " +458.");
      }
    }
  }
}

TEST(Gizmo, ARingSeenFromItsEdgeTurnsByItsRadiusInPixels) {
  Gizmo gizmo;
  gizmo.options.mode = GizmoMode::Rotate;
  gizmo.setView(lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, false), kViewport);
  gizmo.setTargets({GizmoTarget{}});
  const auto grab = gizmo.handleScreenPoint(Handle::Y);  // a line from left to right
  ASSERT_TRUE(grab);
  ASSERT_TRUE(gizmo.press(*grab));
  ASSERT_EQ(gizmo.active(), Handle::Y);
  const scene::Transform turned = gizmo.drag(*grab + glm::vec2(gizmo.options.size_px, 0.0f))[0];
  EXPECT_NEAR(2.0f * std::acos(turned.rotation.w), 1.0f, 1e-4f) << "a radian";
  EXPECT_GT(turned.rotation.y, 0.0f) << "what stands before the centre goes to the right";
}

TEST(Gizmo, ScalingFollowsThePointerAlongTheNodesOwnAxes) {
  for (const glm::mat4& parent : parents()) {
    const GizmoTarget target = targetBelow(parent);
    Gizmo gizmo;
    gizmo.options.mode = GizmoMode::Scale;
    gizmo.options.space = GizmoSpace::Local;
    gizmo.setView(lookAt(kEye, kAt, false), kViewport);
    gizmo.setTargets({target});
    const glm::vec2 center = *gizmo.pivotScreenPoint();
    for (const Handle handle : {Handle::X, Handle::Y, Handle::Z}) {
      const auto grab = gizmo.handleScreenPoint(handle);
      if (!grab) continue;
      ASSERT_TRUE(gizmo.press(*grab));
      const scene::Transform scaled = gizmo.drag(center + 1.5f * (*grab - center))[0];
      for (int axis = 0; axis < 3; ++axis) {
        const float factor = axis == static_cast<int>(handle) - 1 ? 1.5f : 1.0f;
        EXPECT_NEAR(scaled.scale[axis], factor * target.local.scale[axis], 1e-3f);
      }
      EXPECT_EQ(scaled.rotation, target.local.rotation);
      gizmo.release();
    }
    ASSERT_TRUE(gizmo.press(center));
    ASSERT_EQ(gizmo.active(), Handle::Screen);
    const scene::Transform doubled = gizmo.drag(center + glm::vec2(gizmo.options.size_px, 0.0f))[0];
    EXPECT_LT(glm::length(doubled.scale - 2.0f * target.local.scale), 1e-5f);
  }
}

TEST(Gizmo, SeveralTargetsTurnAboutTheLast) {
  std::vector<GizmoTarget> targets(2);
  targets[0].local.translation = {1.0f, 0.0f, 0.0f};
  targets[1].local.translation = {-1.0f, 0.0f, 0.0f};
  targets[1].world_from_parent = glm::scale(glm::mat4(1.0f), glm::vec3(1.0f, 1.0f, -1.0f));
  Gizmo gizmo;
  gizmo.setView(lookAt({0.0f, 5.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, false), kViewport);
  gizmo.options.mode = GizmoMode::Rotate;
  gizmo.options.snap = true;
  gizmo.options.snap_deg = 90.0f;
  gizmo.setTargets(targets);
  const glm::vec2 center = *gizmo.pivotScreenPoint();
  ASSERT_TRUE(gizmo.press(Handle::Y, center + glm::vec2(90.0f, 0.0f)));
  // From above with -Z up: a left turn of the picture is one about +Y; 80 degrees snap to 90.
  const float angle = 80.0f * std::numbers::pi_v<float> / 180.0f;
  const auto turned = gizmo.drag(center + 90.0f * glm::vec2(std::cos(angle), -std::sin(angle)));
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-5; };
  EXPECT_TRUE(near(place(targets[0], turned[0]), {-1, 0, -2}));
  EXPECT_TRUE(near(place(targets[1], turned[1]), {-1, 0, 0}));
}

TEST(Gizmo, AnAxisThatPointsAtTheViewerHasNoHandleAndNothingLeavesTheScene) {
  Gizmo gizmo;
  const GizmoTarget target;
  gizmo.setTargets({target});
  for (const bool perspective : {true, false}) {
    gizmo.setView(lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, perspective), kViewport);
    EXPECT_FALSE(gizmo.handleScreenPoint(Handle::Z));
    EXPECT_FALSE(gizmo.handleScreenPoint(Handle::ZX)) << "a plane seen edge on";
    EXPECT_TRUE(gizmo.handleScreenPoint(Handle::X));
    EXPECT_FALSE(gizmo.press(Handle::Z, *gizmo.pivotScreenPoint()));
  }
  // The axis points steeply away: a drag towards and beyond its vanishing point stays finite.
  gizmo.setView(lookAt({1.0f, 1.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, true), kViewport);
  const auto grab = gizmo.handleScreenPoint(Handle::Z);
  ASSERT_TRUE(grab);
  ASSERT_TRUE(gizmo.press(*grab));
  for (float x = -3000.0f; x <= 3000.0f; x += 10.0f) {
    const glm::vec3 now = gizmo.drag(*grab + glm::vec2(x, 0.7f * x))[0].translation;
    ASSERT_LT(glm::length(now), 5000.0f) << x;
    ASSERT_LT(now.z, 5.0f) << "in front of the eye";
  }
  gizmo.release();
  gizmo.setView(lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 10.0f}, true), kViewport);
  EXPECT_FALSE(gizmo.pivotScreenPoint()) << "behind the eye";
  EXPECT_EQ(gizmo.hit({400.0f, 300.0f}), Handle::None);
  EXPECT_TRUE(gizmo.paint().empty());
}

TEST(Gizmo, EveryHandleThatIsSeenCanBeTakenByItsPlaceAndHasTheSameSizeAtAnyDistance) {
  for (const GizmoMode mode : {GizmoMode::Move, GizmoMode::Rotate, GizmoMode::Scale}) {
    for (const float distance : {0.5f, 5.0f, 5000.0f}) {
      Gizmo gizmo;
      gizmo.options.mode = mode;
      gizmo.setTargets({GizmoTarget{}});
      gizmo.setView(lookAt(distance * glm::vec3(0.4f, 0.5f, 0.8f), glm::vec3(0.0f), true), kViewport);
      for (const Handle handle : kHandles) {
        const auto grab = gizmo.handleScreenPoint(handle);
        const bool plane = handle == Handle::XY || handle == Handle::YZ || handle == Handle::ZX;
        ASSERT_EQ(grab.has_value(), mode == GizmoMode::Move || !plane) << handleWord(handle);
        if (!grab) continue;
        EXPECT_EQ(gizmo.hit(*grab), handle) << handleWord(handle);
        EXPECT_LT(glm::length(*grab - *gizmo.pivotScreenPoint()), 1.4f * gizmo.options.size_px);
      }
      float reach = 0.0f;
      for (const Stroke& stroke : gizmo.paint())
        for (const glm::vec2& point : stroke.points)
          reach = lambent::testing::larger(reach, glm::length(point - *gizmo.pivotScreenPoint()));
      EXPECT_GT(reach, 0.7f * gizmo.options.size_px);
      EXPECT_LT(reach, 1.6f * gizmo.options.size_px);
    }
  }
}

TEST(Gizmo, AModifierKeySnapsADragOrFreesOneThatSnaps) {
  Gizmo gizmo;
  gizmo.options.snap = true;
  gizmo.options.snap_m = 0.25f;
  gizmo.setTargets({GizmoTarget{}});
  gizmo.setView(lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, false), kViewport);
  const glm::vec2 grab = *gizmo.handleScreenPoint(Handle::X);
  ASSERT_TRUE(gizmo.press(grab));
  const double scale = Projection(lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, false), kViewport)
                           .pixelsPerMetre(glm::dvec3(0.0));
  const glm::vec2 pointer = grab + glm::vec2(0.6f * static_cast<float>(scale), 0.0f);
  EXPECT_EQ(gizmo.drag(pointer)[0].translation.x, 0.5f);
  EXPECT_NEAR(gizmo.drag(pointer, /*other_snap=*/true)[0].translation.x, 0.6f, 1e-4f);
  EXPECT_EQ(gizmo.readout(), "x +0.600 m");
  gizmo.options.snap = false;
  EXPECT_NEAR(gizmo.drag(pointer)[0].translation.x, 0.6f, 1e-4f);
  EXPECT_EQ(gizmo.drag(pointer, /*other_snap=*/true)[0].translation.x, 0.5f);
}

TEST(FinePointer, GoesATenthOfTheWayWhileItIsFineAndDoesNotJumpAfterwards) {
  FinePointer pointer;
  pointer.press({10.0f, 0.0f});
  EXPECT_NEAR(pointer.moved({20.0f, 0.0f}, false).x, 20.0f, 1e-4f);
  EXPECT_NEAR(pointer.moved({70.0f, 0.0f}, true).x, 25.0f, 1e-4f);
  EXPECT_NEAR(pointer.moved({70.0f, 0.0f}, false).x, 25.0f, 1e-4f);
  EXPECT_NEAR(pointer.moved({71.0f, 0.0f}, false).x, 26.0f, 1e-4f);
}

}  // namespace
}  // namespace lambent::editor
