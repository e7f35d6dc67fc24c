#include "convert/muscles.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/sampling_job.h"
#include "sinew/effects/support.h"

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
    if (group.arm) raised = Quat<double>::FromTwoVectors(-Vec3<double>::UnitZ(), bone);
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

void strengthen(const std::vector<Clip>& clips, double margin, Skeleton& skeleton, nlohmann::json& report) {
  const Tree<double> tree(skeleton);
  Kinematics<double> kinematics(tree);
  Motion<double> motion(tree);
  std::vector<Vec3<double>> force(tree.bodies), moment(tree.bodies);
  std::vector<double> torque(tree.dofs), highest(tree.dofs, 0.0), lowest(tree.dofs, 0.0);
  std::vector<const Clip*> asks(tree.bodies, nullptr);
  std::vector<double> most(tree.bodies, 0.0);
  std::vector<JointJet<double>> jets(skeleton.joints.size());
  std::vector<ContactPoint<double>> points;
  for (const Collider& c : skeleton.colliders)
    if (c.joint < skeleton.body_count) append_contact_points<double>(c, points);
  for (const Clip& clip : clips) {
    double floor = 1e9;  // the clip's own
    const int frames = std::max(1, static_cast<int>(clip.duration * 60));
    for (int pass = 0; pass < 2; ++pass)
      for (int f = 0; f < frames; ++f) {
        if (!SamplingJob<double>{&clip, f / 60.0, 1, jets}.Run()) continue;
        inertial_wrenches<double>(tree, jets, {0, 0, -9.81}, Vec3<double>::Zero(), kinematics, motion, force,
                                  moment);
        if (pass == 0) {
          for (const ContactPoint<double>& p : points)
            floor = std::min(
                floor, (kinematics.origin[p.body] + kinematics.rotation[p.body] * p.local).z() - p.radius);
          continue;
        }
        share_support<double>(tree, kinematics, points, floor, {}, force, moment);
        project_wrenches<double>(tree, kinematics, force, moment, torque);
        for (int i = 0; i < tree.bodies; ++i)
          for (int d = tree.first_dof[i]; d < tree.first_dof[i] + dof_count(skeleton.joints[i].type); ++d) {
            highest[d] = std::max(highest[d], torque[d]);
            lowest[d] = std::min(lowest[d], torque[d]);
            if (std::abs(torque[d]) > most[i]) {
              most[i] = std::abs(torque[d]);
              asks[i] = &clip;
            }
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
                                 {"peak_in_clip", asks[i] ? asks[i]->name : ""},
                                 {"limits_Nm", limits},
                                 {"raised_for_clips", raised}});
  }
}

}  // namespace sinew::convert
