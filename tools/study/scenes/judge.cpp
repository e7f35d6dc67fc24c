#include "study/scenes/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/audit/differences.h"

namespace sinew::study {

using Eigen::Vector3d;

Judge::Judge(const scene::Recording& recording) : recording_(recording) {
  for (const auto& asset : recording.characters) members_.push_back(audit::member_of(asset->skeleton));
  for (const scene::Prop& prop : recording.props)
    members_.push_back(
        audit::loose_solid(prop.shape, prop.size.cast<double>(), double(prop.mass), prop.hull));
  for (const Collider& c : recording.obstacles) around_.obstacles.push_back(audit::solid_of(c));
  around_.ground = recording.ground.has_value();
  if (recording.ground) around_.ground_height = double(*recording.ground);
}

int Judge::frame_at(double seconds) const {
  return std::min(frames() - 1, static_cast<int>(std::lround(seconds * recording_.frame_rate)));
}

std::vector<Transform<double>> Judge::poses(int frame, int member) const {
  const scene::Frame& at = recording_.frames[static_cast<std::size_t>(frame)];
  const auto characters = static_cast<int>(recording_.characters.size());
  std::vector<Transform<double>> poses;
  for (std::size_t b = 0; b < members_[member].bodies.size(); ++b)
    poses.push_back((member < characters ? at.characters[member].model[b]
                                         : at.props[static_cast<std::size_t>(member - characters)].world)
                        .cast<double>());
  for (Transform<double>& pose : poses) pose.rotation.normalize();
  return poses;
}

double Judge::depth_in_surroundings(int frame, int member) const {
  double deepest = 0;
  for (int m = 0; m < members(); ++m)
    if (member < 0 || m == member)
      deepest = std::max(deepest, audit::depth_in(around_, members_[m], poses(frame, m)));
  return deepest;
}

double Judge::depth_between(int frame, int a, int b) const {
  return audit::depth_between(members_[a], poses(frame, a), members_[b], poses(frame, b));
}

double Judge::distance_from_others(int frame, int member) const {
  double least = std::numeric_limits<double>::infinity();
  for (int m = 0; m < members(); ++m)
    if (m != member)
      least = std::min(least, audit::distance_between(members_[member], poses(frame, member), members_[m],
                                                      poses(frame, m)));
  return least;
}

double Judge::depth_between(int frame) const {
  std::vector<std::vector<Transform<double>>> all;
  for (int m = 0; m < members(); ++m) all.push_back(poses(frame, m));
  const std::vector<audit::Poses> at(all.begin(), all.end());
  return audit::deepest_between(members_, at);
}

double Judge::joint_gap(int frame) const {
  double widest = 0;
  for (int m = 0; m < members(); ++m)
    widest = std::max(widest, audit::joint_gap(members_[m], poses(frame, m)).distance);
  return widest;
}

double Judge::fastest(int frame, int member) const {
  double most = 0;
  for (int m = 0; m < members(); ++m) {
    if (member >= 0 && m != member) continue;
    const auto before = poses(frame - 1, m), after = poses(frame, m);
    for (std::size_t b = 0; b < after.size(); ++b) {
      const Vector3d& center = members_[m].bodies[b].center;
      most = std::max(most, (after[b] * center - before[b] * center).norm() / step());
    }
  }
  return most;
}

double Judge::kinetic(int frame, int member) const {
  const auto before = poses(frame - 1, member), after = poses(frame, member);
  double sum = 0;
  for (std::size_t b = 0; b < after.size(); ++b) {
    const audit::Body& body = members_[member].bodies[b];
    const audit::Velocity v = audit::chord(body, before[b], after[b], step(), 0);
    sum += 0.5 *
           (body.mass * v.linear.value.squaredNorm() + v.angular.value.dot(body.inertia * v.angular.value));
  }
  return sum;
}

Vector3d Judge::center_of_mass(int frame, int member) const {
  return audit::center_of_mass(members_[member], poses(frame, member));
}

Vector3d Judge::velocity(int frame, int member) const {
  return (center_of_mass(frame, member) - center_of_mass(frame - 1, member)) / step();
}

bool Judge::finite(int frame) const {
  for (int m = 0; m < members(); ++m)
    for (const Transform<double>& pose : poses(frame, m))
      if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) return false;
  return true;
}

double apart(const scene::Recording& a, int member_a, const scene::Recording& b, int member_b, int frame) {
  const auto points = [frame](const scene::Recording& r, int member) {
    const scene::Frame& at = r.frames[static_cast<std::size_t>(frame)];
    const auto characters = static_cast<int>(r.characters.size());
    std::vector<Vector3d> all;
    if (member >= characters) {
      all.emplace_back(
          at.props[static_cast<std::size_t>(member - characters)].world.translation.cast<double>());
      return all;
    }
    for (const Transform<float>& joint : at.characters[member].model)
      all.emplace_back(joint.translation.cast<double>());
    return all;
  };
  const std::vector<Vector3d> p = points(a, member_a), q = points(b, member_b);
  double furthest = p.size() == q.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i)
    furthest = std::max(furthest, (p[i] - q[i]).norm());
  return furthest;
}

}  // namespace sinew::study
