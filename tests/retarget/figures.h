// The demo character in several sizes and rest poses.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "convert/convert.h"
#include "fixtures/paths.h"
#include "retarget/planting.h"
#include "retarget/retarget.h"

namespace sinew::retarget::test {

constexpr double kDegree = 0.017453292519943295;

inline Asset converted(const std::string& path, double unit = 0) {
  Asset asset;
  nlohmann::json report, options = nlohmann::json::object();
  if (unit > 0) options["unit"] = unit;
  const Error error = convert::convert_files({path}, options, asset, report);
  EXPECT_FALSE(error) << error.message;
  return asset;
}

/// As tall as that, m; it stands 1.75 m tall in its file.
inline const Asset& mannequin(double height = 1.75) {
  static std::map<double, Asset> made;
  if (!made.count(height))
    made[height] = converted(source_dir() + "/assets/character/mannequin.glb", height / 1.75);
  return made[height];
}

/// Turns a joint's rest, and all that hangs on it, about a model axis.
inline void turn_rest(Skeleton& skeleton, Role role, const Vec3<double>& rotation_vector) {
  const int joint = skeleton.find(role);
  const Quat<double> above = model_rest(skeleton)[skeleton.joints[joint].parent].rotation;
  const double angle = rotation_vector.norm();
  const Quat<double> turn(Eigen::AngleAxisd(angle, rotation_vector / angle));
  Quat<double>& rest = skeleton.joints[joint].rest.rotation;
  rest = (above.conjugate() * turn * above * rest).normalized();
}

/// Largest angle between the model rotations of two motions, rad, over all joints and frames.
inline double apart(const Motion& a, const Motion& b) {
  double most = 0;
  EXPECT_EQ(a.model.size(), b.model.size());
  for (std::size_t f = 0; f < std::min(a.model.size(), b.model.size()); ++f)
    for (std::size_t j = 0; j < a.model[f].size(); ++j)
      most = std::max(most, a.model[f][j].rotation.angularDistance(b.model[f][j].rotation));
  return most;
}

/// Largest distance between the joints of two motions, m.
inline double distance(const Motion& a, const Motion& b) {
  double most = 0;
  for (std::size_t f = 0; f < std::min(a.model.size(), b.model.size()); ++f)
    for (std::size_t j = 0; j < a.model[f].size(); ++j)
      most = std::max(most, (a.model[f][j].translation - b.model[f][j].translation).norm());
  return most;
}

}  // namespace sinew::retarget::test
