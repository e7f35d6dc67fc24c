// Inverse dynamics, mass matrix and forward dynamics of real robots against MuJoCo, fixed base, random
// states.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>

#include "convert/convert.h"
#include "fixtures/paths.h"
#include "sinew/residual/dynamics.h"

namespace sinew {
namespace {

/// The URDF as MuJoCo can take it: no meshes (their files are elsewhere), nothing fused, and 1e-12 kg for
/// links without mass (it refuses less). Joints that Sinew fixed (locked, or moving no mass) are fixed there
/// too.
std::string for_mujoco(const std::string& path, const Skeleton& skeleton) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string urdf = text.str();
  for (const char* tag : {"visual", "collision", "transmission", "gazebo", "mujoco"})  // whole elements
    for (std::size_t at; (at = urdf.find(std::string("<") + tag)) != std::string::npos;) {
      const std::string close = std::string("</") + tag + ">";
      const std::size_t end = urdf.find(close, at), tag_end = urdf.find('>', at);
      if (urdf[tag_end - 1] == '/' || end == std::string::npos)
        urdf.erase(at, tag_end + 1 - at);
      else
        urdf.erase(at, end + close.size() - at);
    }
  for (const Joint& joint : skeleton.joints) {
    const std::size_t at = urdf.find("<joint name=\"" + joint.source_joint + "\"");
    if (joint.type != JointType::kFixed || joint.source_joint.empty() || at == std::string::npos) continue;
    const std::size_t type = urdf.find("type=\"", at) + 6;
    urdf.replace(type, urdf.find('"', type) - type, "fixed");
  }
  const std::size_t root = urdf.find('>', urdf.find("<robot")) + 1;
  urdf.insert(root,
              "<mujoco><compiler fusestatic=\"false\" balanceinertia=\"true\" boundmass=\"2e-15\" "
              "boundinertia=\"2e-15\" strippath=\"true\"/></mujoco>");
  return urdf;
}

double largest(const Eigen::MatrixXd& m) {
  return std::max(1e-12, m.cwiseAbs().maxCoeff());
}

class Robot : public testing::TestWithParam<const char*> {};

TEST_P(Robot, AgreesWithMujocoToNineDigits) {
  const std::string path = shared_dir() + "/assets/urdf/" + GetParam();
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no ../shared here: " << GetParam() << " was not compared";
  Asset asset;
  nlohmann::json report;
  const convert::Error error = convert::convert_files({path}, {{"free_base", false}}, asset, report);
  ASSERT_FALSE(error) << error.message;
  const auto vfs = std::make_unique<mjVFS>();  // a megabyte: too much for the stack
  mj_defaultVFS(vfs.get());
  const std::string urdf = for_mujoco(path, asset.skeleton);
  ASSERT_EQ(mj_makeEmptyFileVFS(vfs.get(), "robot.urdf", static_cast<int>(urdf.size())), 0);
  std::copy(urdf.begin(), urdf.end(), static_cast<char*>(vfs->filedata[vfs->nfile - 1]));
  char why[1000] = "";
  mjModel* m = mj_loadXML("robot.urdf", vfs.get(), why, sizeof why);
  mj_deleteVFS(vfs.get());
  ASSERT_TRUE(m) << "MuJoCo cannot load " << GetParam() << ": " << why;
  m->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_PASSIVE | mjDSBL_ACTUATION;
  for (int i = 0; i < m->nv; ++i) m->dof_armature[i] = m->dof_damping[i] = m->dof_frictionloss[i] = 0;
  mjData* d = mj_makeData(m);

  Skeleton& s = asset.skeleton;
  std::vector<int> of_dof;  // MuJoCo's address of each of our degrees of freedom
  for (const Joint& joint : s.joints)
    if (dof_count(joint.type) == 1) {
      const int id = mj_name2id(m, mjOBJ_JOINT, joint.source_joint.c_str());
      ASSERT_GE(id, 0) << joint.source_joint;
      of_dof.push_back(m->jnt_dofadr[id]);
    }
  const int n = static_cast<int>(of_dof.size());
  ASSERT_EQ(n, m->nv);
  // MuJoCo keeps principal moments and axes, from Jacobi rotations that it stops at 1 - cos < 1e-12, an angle
  // of 1.4e-6 rad (mju_eig3): ours must agree so far, and are then replaced by them, so that the dynamics can
  // be compared to nine digits. Inertias that no body can have are repaired in different ways; there theirs
  // is taken as it is.
  const std::string notes = report.value("notes", nlohmann::json::array()).dump();
  for (Joint& joint : s.joints) {
    const int id = mj_name2id(m, mjOBJ_BODY, joint.name.c_str());
    if (id <= 0 || joint.mass <= 0) continue;
    EXPECT_NEAR(m->body_mass[id], joint.mass, 1e-12 * joint.mass) << joint.name;
    const mjtNum* q = m->body_iquat + 4 * id;
    const Mat3<double> axes = Quat<double>(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    const Vec3<double> moments(m->body_inertia[3 * id], m->body_inertia[3 * id + 1],
                               m->body_inertia[3 * id + 2]);
    const Mat3<double> theirs = axes * moments.asDiagonal() * axes.transpose();
    const bool repaired = notes.find("link '" + joint.name + "': inertia that no") != std::string::npos;
    if (!repaired) {
      EXPECT_LT(largest(theirs - joint.inertia), 1e-6 * largest(joint.inertia) + 2e-12) << joint.name;
    }
    joint.inertia = 0.5 * (theirs + theirs.transpose());
  }
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, 1);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<JointState> states(static_cast<std::size_t>(s.body_count));
    int dof = 0;
    for (int i = 0; i < s.body_count; ++i) {
      if (dof_count(s.joints[static_cast<std::size_t>(i)].type) != 1) continue;
      JointState& state = states[static_cast<std::size_t>(i)];
      const int at = of_dof[static_cast<std::size_t>(dof++)];
      d->qpos[at] = state.q[0] = normal(random);
      d->qvel[at] = state.v[0] = normal(random);
      d->qacc[at] = state.a[0] = normal(random);
    }
    const DynamicsResult ours = evaluate_dynamics(s, states, {0, 0, -9.81});
    std::vector<double> acceleration(d->qacc, d->qacc + n);
    mj_inverse(m, d);
    Eigen::VectorXd inverse(n), forward(n);
    for (int k = 0; k < n; ++k) inverse[k] = d->qfrc_inverse[of_dof[static_cast<std::size_t>(k)]];
    mj_forward(m, d);
    std::vector<mjtNum> full(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    mj_fullM(m, full.data(), d->qM);
    Eigen::MatrixXd mass(n, n);
    for (int r = 0; r < n; ++r) {
      forward[r] = d->qacc[of_dof[static_cast<std::size_t>(r)]];
      for (int c = 0; c < n; ++c) mass(r, c) = full[of_dof[r] * n + of_dof[c]];
    }
    EXPECT_LT(largest(ours.inverse_dynamics - inverse) / largest(inverse), 1e-9);
    EXPECT_LT(largest(ours.mass_matrix - mass) / largest(mass), 1e-9);
    // Forward dynamics divides by the smallest inertia: relative to the condition that the accelerations
    // themselves show.
    EXPECT_LT(largest(ours.forward_dynamics - forward) / largest(forward), 1e-9);
  }
  mj_deleteData(d);
  mj_deleteModel(m);
}

INSTANTIATE_TEST_SUITE_P(Urdf, Robot,
                         testing::Values("bullet_humanoid.urdf", "bullet_quadruped.urdf", "panda.urdf",
                                         "romeo.urdf", "simple_humanoid_classical.urdf", "solo12.urdf",
                                         "unitree_g1_29dof.urdf", "unitree_h1.urdf"));

}  // namespace
}  // namespace sinew
