#include "convert/muscles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "convert/contact_windows.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/effects/support.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::convert {
namespace {

/// Rows of a right-hand joint for rotations about x (forward), y (left) and z (up) of the model, standing
/// with the arms hanging and the palms to the thighs. A left-hand joint has x and z the other way round.
struct Group {
  std::vector<Role> roles;
  bool arm;
  const char* plus[3];
  const char* minus[3];
};

const Group kGroups[] = {{{Role::kPelvis, Role::kSpine, Role::kChest},
                          false,
                          {"lumbar_lateral", "lumbar_flexion", "lumbar_rotation"},
                          {"lumbar_lateral", "lumbar_extension", "lumbar_rotation"}},
                         {{Role::kNeck, Role::kHead},
                          false,
                          {"neck_lateral", "neck_flexion", "neck_rotation"},
                          {"neck_lateral", "neck_extension", "neck_rotation"}},
                         {{Role::kClavicleL, Role::kClavicleR},
                          false,
                          {"clavicle_depression", "clavicle_depression", "clavicle_protraction"},
                          {"clavicle_elevation", "clavicle_elevation", "clavicle_retraction"}},
                         {{Role::kUpperArmL, Role::kUpperArmR},
                          true,
                          {"shoulder_adduction", "shoulder_extension", "shoulder_internal_rotation"},
                          {"shoulder_abduction", "shoulder_flexion", "shoulder_external_rotation"}},
                         {{Role::kForearmL, Role::kForearmR},
                          true,
                          {"elbow_flexion", "elbow_extension", "forearm_pronation"},
                          {"elbow_flexion", "elbow_flexion", "forearm_supination"}},
                         {{Role::kHandL, Role::kHandR},
                          true,
                          {"wrist_flexion", "wrist_ulnar_deviation", "forearm_pronation"},
                          {"wrist_extension", "wrist_radial_deviation", "forearm_supination"}},
                         {{Role::kThighL, Role::kThighR},
                          false,
                          {"hip_adduction", "hip_extension", "hip_internal_rotation"},
                          {"hip_abduction", "hip_flexion", "hip_external_rotation"}},
                         {{Role::kShinL, Role::kShinR},
                          false,
                          {"knee_flexion", "knee_flexion", "knee_flexion"},
                          {"knee_flexion", "knee_extension", "knee_flexion"}},
                         {{Role::kFootL, Role::kFootR},
                          false,
                          {"subtalar_inversion", "ankle_plantarflexion", "subtalar_inversion"},
                          {"subtalar_eversion", "ankle_dorsiflexion", "subtalar_eversion"}},
                         {{Role::kToesL, Role::kToesR},
                          false,
                          {"toes_flexion", "toes_flexion", "toes_flexion"},
                          {"toes_flexion", "toes_extension", "toes_flexion"}}};

bool is_left(Role role) {
  for (const Role left : {Role::kClavicleL, Role::kUpperArmL, Role::kForearmL, Role::kHandL, Role::kThighL,
                          Role::kShinL, Role::kFootL, Role::kToesL})
    if (role == left) return true;
  return false;
}

}  // namespace

bool anatomical_axes(Role role, const Vec3<double>& bone, const Quat<double>& rest, AnatomicalAxes& out) {
  for (const Group& group : kGroups) {
    if (std::find(group.roles.begin(), group.roles.end(), role) == group.roles.end()) continue;
    Quat<double> raised = Quat<double>::Identity();
    if (group.arm) raised = rotation_between<double>(-Vec3<double>::UnitZ(), bone);
    out.axes = (rest.conjugate() * raised).toRotationMatrix();
    for (int k = 0; k < 3; ++k) {
      const bool mirrored = is_left(role) && k != 1;
      out.plus[k] = mirrored ? group.minus[k] : group.plus[k];
      out.minus[k] = mirrored ? group.plus[k] : group.minus[k];
    }
    return true;
  }
  return false;
}

void set_muscles(const AnatomicalAxes& anatomy, const std::map<std::string, double>& rows, double scale,
                 Joint& joint) {
  const auto along = [&](const Vec3<double>& direction) {
    const Vec3<double> d = anatomy.axes.transpose() * direction;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double share = d[k] / rows.at(d[k] > 0 ? anatomy.plus[k] : anatomy.minus[k]);
      sum += share * share;
    }
    return scale / std::sqrt(sum);
  };
  if (joint.type == JointType::kRevolute) {
    const bool same = joint.axis.dot(anatomy.axes.col(1)) > 0;
    joint.dofs[0].torque_plus = scale * rows.at(same ? anatomy.plus[1] : anatomy.minus[1]);
    joint.dofs[0].torque_minus = scale * rows.at(same ? anatomy.minus[1] : anatomy.plus[1]);
  } else if (joint.type == JointType::kBall) {
    for (int k = 0; k < 3; ++k) {
      joint.dofs[k].torque_plus = along(Vec3<double>::Unit(k));
      joint.dofs[k].torque_minus = along(-Vec3<double>::Unit(k));
    }
  }
}

namespace {

constexpr double kRate = 60;  ///< frames a second at which clips are looked at

/// Frames for which a torque has to be asked, 50 ms: the time constant with which human muscle is activated
/// and let go (Zajac 1989; 10–15 and 40–50 ms). What a marker's jump asks for a frame or two, up to a
/// thousand times a person's strength, is no muscle's.
constexpr int kSustained = 3;

/// A skeleton's residual pass and what it works on.
struct Pass {
  explicit Pass(const Skeleton& skeleton)
      : tree(skeleton), kinematics(tree), motion(tree), force(tree.bodies), moment(tree.bodies) {
    jets.resize(skeleton.joints.size());
    for (const Collider& c : skeleton.colliders)
      if (c.joint < skeleton.body_count) append_contact_points<double>(c, points);
  }
  /// Poses, and the wrenches [body] that the clip asks for; false when it has no such frame.
  bool run(const Clip& clip, int frame) {
    if (!SamplingJob<double>{&clip, frame / kRate, jets}.Run()) return false;
    inertial_wrenches<double>(tree, jets, {0, 0, -9.81}, Vec3<double>::Zero(), kinematics, motion, force,
                              moment);
    return true;
  }

  Tree<double> tree;
  Kinematics<double> kinematics;
  Motion<double> motion;
  std::vector<Vec3<double>> force, moment;
  std::vector<JointJet<double>> jets;
  std::vector<ContactPoint<double>> points;
};

int frames_of(const Clip& clip) {
  return std::max(1, static_cast<int>(clip.duration * kRate));
}

/// Height of the floor that a clip moves on, m.
double floor_under(const Clip& clip, Pass& pass) {
  std::vector<double> lowest;
  for (int f = 0; f < frames_of(clip); ++f) {
    if (!pass.run(clip, f)) continue;
    double low = 1e9;
    for (const ContactPoint<double>& p : pass.points)
      low = std::min(
          low, (pass.kinematics.origin[p.body] + pass.kinematics.rotation[p.body] * p.local).z() - p.radius);
    lowest.push_back(low);
  }
  return floor_of(std::move(lowest));
}

/// The largest value that a series holds for `frames` running, or 0 where it never rises above.
double peak_held(const std::vector<double>& series, int frames) {
  const int length = std::min(frames, static_cast<int>(series.size()));
  double peak = 0;
  for (auto first = series.begin(); first + length <= series.end(); ++first)
    peak = std::max(peak, *std::min_element(first, first + length));
  return peak;
}

/// What a clip asks of each degree of freedom, N·m: [dof][frame], both directions as positive numbers.
struct Demand {
  std::vector<std::vector<double>> plus, minus;
};

Demand demand_of(const Clip& clip, Pass& pass) {
  const Tree<double>& tree = pass.tree;
  const double floor = floor_under(clip, pass);
  const SupportPoints<double> support(tree, pass.points);
  std::vector<StandingPoint<double>> room(support.points.size());
  std::vector<double> torque(tree.dofs);
  Demand demand{std::vector<std::vector<double>>(tree.dofs), std::vector<std::vector<double>>(tree.dofs)};
  for (int f = 0; f < frames_of(clip); ++f) {
    if (!pass.run(clip, f)) continue;
    share_support<double>(support, pass.kinematics.rotation, pass.kinematics.origin,
                          LevelGround<double>{floor}, {}, room, pass.force, pass.moment);
    project_wrenches<double>(tree, pass.kinematics, pass.force, pass.moment, torque);
    for (int d = 0; d < tree.dofs; ++d) {
      demand.plus[d].push_back(torque[d]);
      demand.minus[d].push_back(-torque[d]);
    }
  }
  return demand;
}

}  // namespace

void strengthen(const std::vector<Clip>& clips, double margin, Skeleton& skeleton, nlohmann::json& report) {
  Pass pass(skeleton);
  const Tree<double>& tree = pass.tree;
  std::vector<double> highest(tree.dofs, 0.0), lowest(tree.dofs, 0.0);
  std::vector<const Clip*> asks(tree.bodies, nullptr);
  std::vector<double> most(tree.bodies, 0.0), most_held(tree.bodies, 0.0);
  for (const Clip& clip : clips) {
    const Demand demand = demand_of(clip, pass);
    for (int i = 0; i < tree.bodies; ++i)
      for (int d = tree.first_dof[i]; d < tree.first_dof[i] + dof_count(skeleton.joints[i].type); ++d) {
        const double plus = peak_held(demand.plus[d], kSustained),
                     minus = peak_held(demand.minus[d], kSustained);
        highest[d] = std::max(highest[d], plus);
        lowest[d] = std::min(lowest[d], -minus);
        most[i] = std::max({most[i], peak_held(demand.plus[d], 1), peak_held(demand.minus[d], 1)});
        if (std::max(plus, minus) > most_held[i]) {
          most_held[i] = std::max(plus, minus);
          asks[i] = &clip;
        }
      }
  }
  report["muscles"] = nlohmann::json::array();
  for (int i = 0; i < tree.bodies; ++i) {
    Joint& joint = skeleton.joints[i];
    if (joint.type == JointType::kFree || dof_count(joint.type) == 0) continue;
    nlohmann::json limits = nlohmann::json::array();
    bool raised = false;
    for (int k = 0; k < dof_count(joint.type); ++k) {
      DofLimits& dof = joint.dofs[k];
      const double plus = margin * highest[tree.first_dof[i] + k],
                   minus = -margin * lowest[tree.first_dof[i] + k];
      raised = raised || plus > dof.torque_plus || minus > dof.torque_minus;
      dof.torque_plus = std::max(dof.torque_plus, plus);
      dof.torque_minus = std::max(dof.torque_minus, minus);
      limits.push_back({-dof.torque_minus, dof.torque_plus});
    }
    report["muscles"].push_back({{"joint", joint.name},
                                 {"clips_peak_Nm", most[i]},
                                 {"clips_held_Nm", most_held[i]},
                                 {"peak_in_clip", asks[i] ? asks[i]->name : ""},
                                 {"limits_Nm", limits},
                                 {"raised_for_clips", raised}});
  }
}

std::vector<double> torque_shares(const Clip& clip, const Skeleton& skeleton) {
  Pass pass(skeleton);
  const Tree<double>& tree = pass.tree;
  const Demand demand = demand_of(clip, pass);
  std::vector<double> shares(tree.bodies, 0.0);
  for (int i = 0; i < tree.bodies; ++i) {
    if (skeleton.joints[i].type == JointType::kFree) continue;
    for (int k = 0; k < dof_count(skeleton.joints[i].type); ++k) {
      const int d = tree.first_dof[i] + k;
      const auto [minus, plus] = skeleton.torque_limits(i, k);
      if (plus > 0) shares[i] = std::max(shares[i], peak_held(demand.plus[d], kSustained) / plus);
      if (minus > 0) shares[i] = std::max(shares[i], peak_held(demand.minus[d], kSustained) / minus);
    }
  }
  return shares;
}

TorqueError torque_error(const Clip& clip, const Clip& reference, const Skeleton& skeleton) {
  Pass pass(skeleton);
  const Tree<double>& tree = pass.tree;
  const int frames = frames_of(clip);
  Eigen::MatrixXd meant = Eigen::MatrixXd::Zero(tree.dofs, frames), off = meant;
  const auto torques = [&](const Clip& of, int frame) {
    std::vector<double> torque(tree.dofs, 0.0);
    if (pass.run(of, frame)) project_wrenches<double>(tree, pass.kinematics, pass.force, pass.moment, torque);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(torque.data(), tree.dofs));
  };
  for (int f = 0; f < frames; ++f) {
    meant.col(f) = torques(reference, f);
    off.col(f) = torques(clip, f) - meant.col(f);
  }
  TorqueError error;
  double sum = 0;
  int count = 0;
  for (int i = 0; i < tree.bodies; ++i)
    for (int k = 0; k < dof_count(skeleton.joints[i].type); ++k) {
      if (skeleton.joints[i].type == JointType::kFree) continue;
      const int d = tree.first_dof[i] + k;
      const DofLimits& dof = skeleton.joints[i].dofs[k];
      const double own = meant.row(d).norm() / std::sqrt(frames);
      const double scale = std::max({std::min(dof.torque_minus, dof.torque_plus), own, 1e-9});
      error.largest = std::max(error.largest, off.row(d).cwiseAbs().maxCoeff() / scale);
      sum += off.row(d).squaredNorm() / (scale * scale);
      count += frames;
    }
  error.rms = count > 0 ? std::sqrt(sum / count) : 0;
  return error;
}

}  // namespace sinew::convert
