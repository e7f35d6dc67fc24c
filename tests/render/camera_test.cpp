// Where the camera stands.
#include "render/camera.h"

#include <gtest/gtest.h>

#include "render/figure.h"

namespace sinew::render {
namespace {

using fixtures::bare_humanoid;
using fixtures::swinging;

TEST(Turntable, IsOneFullRevolutionAfterTheFramesThatWereAskedFor) {
  scene::Recording rec = swinging(bare_humanoid(), 1);
  rec.frames.resize(31, rec.frames[0]);
  for (scene::Frame& frame : rec.frames) frame = rec.frames[0];
  const std::vector<View> views = plan_turntable(rec, 16.f / 9, 30);
  ASSERT_EQ(views.size(), 31u);
  const float radius = (views[0].eye - views[0].target).norm();
  // float rounding of a position a few metres away
  EXPECT_LT((views[30].eye - views[0].eye).norm(), 1e-5f);
  EXPECT_LT((views[15].eye + views[0].eye - 2 * views[0].target).head<2>().norm(), 1e-5f);
  for (const View& view : views) EXPECT_NEAR((view.eye - view.target).norm(), radius, 1e-5f);
  for (std::size_t n = 1; n < views.size(); ++n)
    EXPECT_NEAR((views[n].eye - views[n - 1].eye).norm(), (views[1].eye - views[0].eye).norm(), 1e-5f);
}

TEST(Camera, KeepsEveryPointOfTheFigureInThePicture) {
  const scene::Recording rec = swinging(bare_humanoid(), 1);
  for (const float aspect : {16.f / 9, 1.f, 9.f / 16}) {
    const std::vector<View> views = plan_camera(rec, aspect);
    ASSERT_EQ(views.size(), rec.frames.size());
    for (std::size_t n = 0; n < views.size(); ++n) {
      const View& v = views[n];
      const Vec3<float> ahead = (v.target - v.eye).normalized(),
                        right = ahead.cross(Vec3<float>::UnitZ()).normalized(), up = right.cross(ahead);
      const float half = std::tan(v.vertical_fov / 2);
      for (const Transform<float>& joint : rec.frames[n].characters[0].model) {
        const Vec3<float> d = joint.translation - v.eye;
        EXPECT_LT(std::abs(d.dot(up)), half * d.dot(ahead));
        EXPECT_LT(std::abs(d.dot(right)), half * aspect * d.dot(ahead));
      }
    }
  }
}

TEST(Camera, FollowsAWalkerWithoutJumps) {
  scene::Recording rec = swinging(bare_humanoid(), 2);
  for (scene::Frame& frame : rec.frames)
    for (Transform<float>& joint : frame.characters[0].model)
      joint.translation.x() += 1.4f * float(frame.time);  // m/s
  rec.camera.follow_character = 0;
  const std::vector<View> views = plan_camera(rec, 1.6f);
  EXPECT_GT(views.back().target.x() - views.front().target.x(), 2);  // of 2.8 m: ends are smoothed
  for (std::size_t n = 1; n < views.size(); ++n)                     // never faster than twice the walker
    EXPECT_LT((views[n].target - views[n - 1].target).norm(), 2 * 1.4f / 30);
}

TEST(Camera, FollowsSeveralThatFlyThroughTheSceneTogether) {
  scene::Recording rec = swinging(bare_humanoid(), 2);
  rec.characters.push_back(rec.characters[0]);
  for (scene::Frame& frame : rec.frames) {
    frame.characters.push_back(frame.characters[0]);
    for (std::size_t c = 0; c < 2; ++c)
      for (Transform<float>& joint : frame.characters[c].model)
        joint.translation += Vec3<float>(5.f * float(frame.time), float(c), 0);  // m/s, m
  }
  const std::vector<View> views = plan_camera(rec, 1.6f);
  EXPECT_GT(views.back().target.x() - views.front().target.x(), 8);  // of 10 m: ends are smoothed
  EXPECT_NEAR((views.back().eye - views.back().target).norm(), (views[0].eye - views[0].target).norm(), 0.5f)
      << "no further off than two figures beside each other ask for";
}

TEST(Camera, FloorOfASceneWithoutGroundIsBelowEverything) {
  scene::Recording rec = swinging(bare_humanoid(), 1);
  const float standing = lowest_point(rec, rec.frames.size());
  for (Transform<float>& joint : rec.frames.back().characters[0].model) joint.translation.z() -= 3;
  EXPECT_LT(lowest_point(rec, rec.frames.size()), standing - 2);
  EXPECT_FLOAT_EQ(lowest_point(rec, 1), lowest_point(swinging(bare_humanoid(), 1), 1));
}

TEST(Camera, ScalesLightAndGridWithTheFigure) {
  scene::Recording rec = swinging(bare_humanoid(), 0.1);
  const float adult = plan_camera(rec, 1.6f)[0].unit;
  EXPECT_NEAR(adult, 1, 0.25f);  // the fixture has no head: somewhat less than an adult
  auto asset = bare_humanoid();
  for (Collider& c : asset->skeleton.colliders) {
    c.local.translation *= 0.01;
    c.size *= 0.01;
  }
  rec.characters = {asset};
  for (scene::Frame& frame : rec.frames)
    for (Transform<float>& joint : frame.characters[0].model) joint.translation *= 0.01f;
  EXPECT_NEAR(plan_camera(rec, 1.6f)[0].unit, 0.01f * adult, 1e-5f);
}

}  // namespace
}  // namespace sinew::render
