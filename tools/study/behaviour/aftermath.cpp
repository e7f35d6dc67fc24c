#include "study/behaviour/aftermath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "study/audit/member.h"
#include "study/behaviour/slip.h"

namespace sinew::study {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFallen = 0.6;    ///< of the root's height
constexpr double kLifted = 0.02;   ///< m
constexpr double kTouches = 1e-3;  ///< m over the ground

/// A character's solids where they stand in a frame.
class Standing {
 public:
  explicit Standing(const scene::Recording& recording)
      : recording_(recording),
        member_(audit::member_of(recording.characters[0]->skeleton)),
        ground_(double(recording.ground.value_or(0.f))) {
    const Skeleton& skeleton = recording.characters[0]->skeleton;
    foot_of_.assign(member_.bodies.size(), -1);
    const std::array<int, 2> feet{skeleton.find(Role::kFootL), skeleton.find(Role::kFootR)};
    for (std::size_t b = 0; b < foot_of_.size(); ++b)
      for (int side = 0; side < 2; ++side) {
        const int parent = member_.bodies[b].parent;
        if (static_cast<int>(b) == feet[static_cast<std::size_t>(side)] ||
            (parent >= 0 && foot_of_[static_cast<std::size_t>(parent)] == side))
          foot_of_[b] = side;
      }
  }

  std::vector<audit::Solid> at(int frame) {
    std::vector<Transform<double>> poses;
    const auto& model = recording_.frames[static_cast<std::size_t>(frame)].characters[0].model;
    for (std::size_t b = 0; b < member_.bodies.size(); ++b) {
      poses.push_back(model[b].cast<double>());
      poses.back().rotation.normalize();
    }
    whose_.clear();
    return audit::placed(member_, poses, &whose_);
  }

  /// Of a solid of the last frame asked for: the foot that it belongs to, or −1.
  int foot(std::size_t solid) const { return foot_of_[static_cast<std::size_t>(whose_[solid])]; }
  double clearance(const audit::Solid& solid) const { return -audit::below(solid, ground_); }
  double ground() const { return ground_; }

 private:
  const scene::Recording& recording_;
  audit::Member member_;
  double ground_;
  std::vector<int> foot_of_;  ///< [body]
  std::vector<int> whose_;    ///< [solid]
};

}  // namespace

Aftermath aftermath(const scene::Recording& recording) {
  Aftermath found;
  Standing body(recording);
  const auto root = [&](int frame) {
    return double(recording.frames[static_cast<std::size_t>(frame)].characters[0].model[0].translation.z()) -
           body.ground();
  };
  const double height = root(0);
  std::array<Slip, 2> slips;
  std::array<bool, 2> up{};
  std::vector<audit::Solid> before = body.at(0);
  for (int f = 1; f < static_cast<int>(recording.frames.size()); ++f) {
    found.lowest_root = std::min(found.lowest_root, root(f) / height);
    if (found.outcome == Outcome::kFall) continue;
    const std::vector<audit::Solid> now = body.at(f);
    std::array<double, 3> clear{1e9, 1e9, 1e9};  // left foot, right foot, all else
    for (std::size_t s = 0; s < now.size(); ++s) {
      const int foot = body.foot(s);
      double& least = clear[foot < 0 ? 2 : static_cast<std::size_t>(foot)];
      least = std::min(least, body.clearance(now[s]));
      if (foot >= 0) slips[static_cast<std::size_t>(foot)].look(before[s], now[s], body.ground());
    }
    if (found.lowest_root < kFallen || clear[2] < kTouches) {
      found.outcome = Outcome::kFall;
      continue;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      slips[side].end_frame();
      const bool lifted = clear[side] > kLifted && clear[side] < 1e9;
      found.lifts += lifted && !up[side];
      up[side] = lifted;
    }
    if (found.lifts > 0) found.outcome = Outcome::kStep;
    before = now;
  }
  found.slip = std::max(slips[0].furthest(), slips[1].furthest());
  return found;
}

double off_motion(const scene::Recording& is, const scene::Recording& wanted, int frame) {
  const auto f = static_cast<std::size_t>(frame);
  const auto& a = is.frames[f].characters[0].model;
  const auto& b = wanted.frames[f].characters[0].model;
  Vector2d middle_a = Vector2d::Zero(), middle_b = Vector2d::Zero();
  for (std::size_t j = 0; j < a.size(); ++j) {
    middle_a += a[j].translation.cast<double>().head<2>() / double(a.size());
    middle_b += b[j].translation.cast<double>().head<2>() / double(b.size());
  }
  double along = 0, across = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const Vector2d p = a[j].translation.cast<double>().head<2>() - middle_a,
                   q = b[j].translation.cast<double>().head<2>() - middle_b;
    along += q.dot(p);
    across += q.x() * p.y() - q.y() * p.x();
  }
  const Eigen::Rotation2Dd turn(std::atan2(across, along));
  double furthest = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const Vector3d p = a[j].translation.cast<double>(), q = b[j].translation.cast<double>();
    const Vector2d level = p.head<2>() - middle_a - turn * (q.head<2>() - middle_b);
    furthest = std::max(furthest, std::hypot(level.norm(), p.z() - q.z()));
  }
  return furthest;
}

}  // namespace sinew::study
