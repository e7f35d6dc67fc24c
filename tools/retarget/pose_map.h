// How the joints of one skeleton follow those of another: the retarget pose and the constants of forward
// kinematics.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "retarget/body_map.h"

namespace sinew::retarget {

/// How one joint of the target follows the source: by the turn that a source joint makes away from its rest,
/// or by a mixture of the turns of two.
struct JointMap {
  int a = -1, b = -1;  ///< source joints; −1: keeps its rest relative to its parent
  double blend = 0;    ///< share of b
  Quat<double> rest = Quat<double>::Identity();  ///< joint → model in the retarget pose
};

struct PoseMap {
  const Skeleton* source = nullptr;
  const Skeleton* target = nullptr;
  BodyMap from, to;
  std::vector<Transform<double>> from_rest, to_rest;  ///< joint → model
  std::vector<JointMap> joints;                       ///< [target joint]
  double leg = 0;                                     ///< m, of the source, from hip to ankle
  double scale = 1;                                   ///< target's leg length / source's
};

/// Joints beside the chains (fingers, hair), target → source, by name.
using JointPairs = std::map<std::string, std::string>;

/// The retarget pose turns the target's rest until its bones point where the source's do: the pelvis by the
/// line of the hips, then limb by limb the short way, each carrying along what lies below. Trunk and necks of
/// skinned characters that are less than 20 degrees apart are left, and collar bones and hands less than 45
/// and 30: there rests differ by where joints were put, not by posture. Soles stay level. Joints of chains
/// with equally many joints follow one to one, others by their place along the chain. Joints beside the
/// chains follow those that `pairs` names, or those of the same name, or the same bone of the same finger.
///
/// Skinned: whether a character has a skin; if not, its rest is the first frame of a motion. The skeletons
/// must outlive `out`. An error says which of the two is at fault.
Error map_poses(const Skeleton& source, bool source_skinned, const Skeleton& target, bool target_skinned,
                const JointPairs& pairs, PoseMap& out);

/// Joint → model from joint → parent.
std::vector<Transform<double>> model_of(const Skeleton& skeleton, std::span<const Transform<double>> local);

/// Middle between the two hip joints, m.
Vec3<double> hips_of(const BodyMap& map, std::span<const Transform<double>> model);

/// Forward kinematics of one frame: joint → parent of the target. The root stands where the source's does,
/// times the scale; the pelvis is not placed yet (see place_hips).
std::vector<Transform<double>> follow(const PoseMap& map, std::span<const Transform<double>> local,
                                      std::span<const Transform<double>> model);

/// Shifts the target's pelvis until the middle of its hips is there (m, model).
void place_hips(const PoseMap& map, const Vec3<double>& hips, std::span<Transform<double>> local);

}  // namespace sinew::retarget
