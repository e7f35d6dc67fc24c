// Joint places as the project's own importer finds them in a file.
#pragma once

#include <algorithm>
#include <map>

#include "exported.h"
#include "import/source_scene.h"

namespace sinew::exporting::test {

/// m: the largest distance between a joint of a motion and where a file has it at the same key. The file's
/// keys have to be the motion's.
inline double furthest_in_importer(const import::SourceScene& scene, const Skeleton& skeleton,
                                   const Motion& motion) {
  const auto clip = std::find_if(scene.clips.begin(), scene.clips.end(),
                                 [&](const auto& c) { return c.name == motion.name; });
  EXPECT_NE(clip, scene.clips.end()) << motion.name;
  std::vector<const import::SourceChannel*> channels(scene.nodes.size(), nullptr);
  for (const import::SourceChannel& c : clip->channels) channels[static_cast<std::size_t>(c.node)] = &c;
  double furthest = 0;
  for (std::size_t k = 0; k < motion.times.size(); ++k) {
    std::vector<Eigen::Matrix4d> world;
    std::map<std::string, Vec3<double>> places;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
      Eigen::Matrix4d local = scene.nodes[n].local;
      if (const import::SourceChannel* c = channels[n]) {
        if (!c->positions.empty())
          local.block<3, 1>(0, 3) = c->positions.size() == 1 ? c->positions[0] : c->positions.at(k);
        if (!c->rotations.empty())
          local.block<3, 3>(0, 0) =
              (c->rotations.size() == 1 ? c->rotations[0] : c->rotations.at(k)).toRotationMatrix();
      }
      const int parent = scene.nodes[n].parent;
      world.push_back(parent < 0 ? local : Eigen::Matrix4d(world[static_cast<std::size_t>(parent)] * local));
      const Vec3<double> at = world.back().block<3, 1>(0, 3);
      places[scene.nodes[n].original_name] = {at.z(), at.x(), at.y()};
    }
    const std::vector<Transform<double>> pose = model_pose(skeleton, motion.frames[k]);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const auto found = places.find(skeleton.joints[j].name);
      EXPECT_NE(found, places.end()) << skeleton.joints[j].name;
      furthest = std::max(furthest, (found->second - pose[j].translation).norm());
    }
  }
  return furthest;
}

}  // namespace sinew::exporting::test
