// MJCF: MuJoCo makes the same mechanics of it.
#include "export/mjcf.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bodies.h"
#include "exported.h"

namespace sinew::exporting::test {
namespace {

struct FreeMujoco {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using Model = std::unique_ptr<mjModel, FreeMujoco>;
using Data = std::unique_ptr<mjData, FreeMujoco>;

Model compiled(const Skeleton& skeleton, std::vector<std::string>& notes) {
  char why[1000] = "";
  const std::string path = written("body.xml", write_mjcf(skeleton, notes));
  Model model(mj_loadXML(path.c_str(), nullptr, why, sizeof why));
  EXPECT_TRUE(model) << why;
  return model;
}

Model compiled(const Skeleton& skeleton) {
  std::vector<std::string> notes;
  return compiled(skeleton, notes);
}

int body_of(const mjModel& m, const Skeleton& skeleton, int joint) {
  const int id = mj_name2id(&m, mjOBJ_BODY, skeleton.joints[static_cast<std::size_t>(joint)].name.c_str());
  EXPECT_GT(id, 0) << skeleton.joints[static_cast<std::size_t>(joint)].name;
  return id;
}

/// Puts one joint into MuJoCo's coordinates.
void set_position(const Joint& joint, const JointState& state, mjtNum* qpos) {
  const auto put = [&](const Quat<double>& q, int at) {
    const double numbers[] = {q.w(), q.x(), q.y(), q.z()};
    std::copy(numbers, numbers + 4, qpos + at);
  };
  if (joint.type == JointType::kFree) {
    std::copy(state.position.data(), state.position.data() + 3, qpos);
    put(state.rotation, 3);
  } else if (joint.type == JointType::kBall) {
    put(state.rotation, 0);
  } else {
    std::copy(state.q, state.q + dof_count(joint.type), qpos);
  }
}

/// [MuJoCo's degree of freedom][ours]: the velocities of its coordinates by ours. Only free joints' differ:
/// they turn about their own axes there, about the parent's here.
Eigen::MatrixXd velocities(const mjModel& m, const Skeleton& s, const std::vector<JointState>& states) {
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(m.nv, m.nv);
  int dof = 0;
  for (int i = 0; i < s.body_count; ++i) {
    const Joint& joint = s.joints[static_cast<std::size_t>(i)];
    const int count = dof_count(joint.type), at = m.body_dofadr[body_of(m, s, i)];
    if (count > 0) map.block(at, dof, count, count).setIdentity();
    if (joint.type == JointType::kFree)
      map.block<3, 3>(at + 3, dof + 3) =
          states[static_cast<std::size_t>(i)].rotation.toRotationMatrix().transpose();
    dof += count;
  }
  return map;
}

double largest(const Eigen::MatrixXd& m) {
  return m.cwiseAbs().maxCoeff();
}

void expect_same_mechanics(const Skeleton& s) {
  const Model m = compiled(s);
  ASSERT_TRUE(m);
  const int n = s.dof_total();
  ASSERT_EQ(m->nv, n);
  m->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_PASSIVE | mjDSBL_ACTUATION;
  const Data d(mj_makeData(m.get()));
  std::mt19937 random(7);
  for (int trial = 0; trial < 5; ++trial) {
    const std::vector<JointState> states = random_states(s, random);
    for (int i = 0; i < s.body_count; ++i)
      if (dof_count(s.joints[static_cast<std::size_t>(i)].type) > 0)
        set_position(s.joints[static_cast<std::size_t>(i)], states[static_cast<std::size_t>(i)],
                     d->qpos + m->jnt_qposadr[m->body_jntadr[body_of(*m, s, i)]]);
    std::fill(d->qvel, d->qvel + n, 0);
    mj_forward(m.get(), d.get());
    std::vector<mjtNum> full(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    mj_fullM(m.get(), full.data(), d->qM);
    Eigen::MatrixXd mass = Eigen::Map<Eigen::MatrixXd>(full.data(), n, n);
    Eigen::VectorXd bias = Eigen::Map<Eigen::VectorXd>(d->qfrc_bias, n);
    const Eigen::MatrixXd map = velocities(*m, s, states);
    mass = (map.transpose() * mass * map).eval();
    bias = (map.transpose() * bias).eval();
    const DynamicsResult ours = evaluate_dynamics(s, states, {0, 0, -9.81});
    EXPECT_LT(largest(ours.mass_matrix - mass) / largest(mass), 1e-9) << "trial " << trial;
    EXPECT_LT(largest(ours.inverse_dynamics - bias) / largest(bias), 1e-9) << "weight, trial " << trial;
  }
}

TEST(MjcfExport, MassMatrixAndWeightOfEveryJointTypeAreMujocosToNineDigits) {
  expect_same_mechanics(chain_of_all_joints(JointType::kFree));
  expect_same_mechanics(chain_of_all_joints(JointType::kFixed));
}

TEST(MjcfExport, MassMatrixOfTheCharacterIsMujocosToNineDigits) {
  expect_same_mechanics(mannequin().skeleton);
}

TEST(MjcfExport, FreeJointWithinTheTreeMovesAsWell) {
  Skeleton s = chain_of_all_joints(JointType::kFixed);
  s.joints[4].type = JointType::kFree;
  const Model m = compiled(s);
  ASSERT_TRUE(m);
  EXPECT_EQ(m->nv, s.dof_total());
}

TEST(MjcfExport, LimitsDampingAndTorquesAreTheBodys) {
  const Skeleton s = chain_of_all_joints(JointType::kFree);
  std::vector<std::string> notes;
  const Model m = compiled(s, notes);
  ASSERT_TRUE(m);
  const int hinge = m->body_jntadr[body_of(*m, s, 1)], ball = m->body_jntadr[body_of(*m, s, 3)];
  EXPECT_TRUE(m->jnt_limited[hinge]);
  EXPECT_EQ(m->jnt_range[2 * hinge], -1);
  EXPECT_EQ(m->jnt_range[2 * hinge + 1], 1.5);
  EXPECT_EQ(m->dof_damping[m->jnt_dofadr[hinge]], 0.5);
  EXPECT_EQ(m->dof_frictionloss[m->jnt_dofadr[hinge]], 0.1);
  EXPECT_NEAR(m->jnt_range[2 * ball + 1], std::sqrt(3 * 1.5 * 1.5), 1e-12);
  EXPECT_EQ(m->nu, s.dof_total() - 6);
  const int motor = mj_name2id(m.get(), mjOBJ_ACTUATOR, "part 1");  // with the muscle beside it
  ASSERT_GE(motor, 0);
  EXPECT_EQ(m->actuator_forcerange[2 * motor], -16);
  EXPECT_EQ(m->actuator_forcerange[2 * motor + 1], 13);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("largest angle"), std::string::npos);
  EXPECT_NE(notes[0].find("(part 3)"), std::string::npos);
}

TEST(MjcfExport, MotorOnABallJointPullsAboutTheChildsAxis) {
  const Skeleton s = chain_of_all_joints(JointType::kFixed);
  const Model m = compiled(s);
  ASSERT_TRUE(m);
  const Data d(mj_makeData(m.get()));
  std::mt19937 random(5);
  const std::vector<JointState> states = random_states(s, random);
  const int body = body_of(*m, s, 3);
  set_position(s.joints[3], states[3], d->qpos + m->jnt_qposadr[m->body_jntadr[body]]);
  const int motor = mj_name2id(m.get(), mjOBJ_ACTUATOR, "part 3_y");
  ASSERT_GE(motor, 0);
  d->ctrl[motor] = 3;
  mj_forward(m.get(), d.get());
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(d->qfrc_actuator[m->body_dofadr[body] + k], k == 1 ? 3 : 0, 1e-12) << k;
}

TEST(MjcfExport, CollidersAndRidersAreWhereTheyWere) {
  const Skeleton s = chain_of_all_joints(JointType::kFixed);
  const Model m = compiled(s);
  ASSERT_TRUE(m);
  const Data d(mj_makeData(m.get()));
  mj_kinematics(m.get(), d.get());
  const std::vector<Transform<double>> rest = rest_pose(s);
  ASSERT_EQ(m->ngeom, 4);  // with the floor
  for (std::size_t c = 0; c < 3; ++c) {
    const Collider& collider = s.colliders[c];
    const Transform<double> at = rest[static_cast<std::size_t>(collider.joint)] * collider.local;
    const mjtNum* geom = d->geom_xpos + 3 * (c + 1);
    EXPECT_LT((Vec3<double>(geom[0], geom[1], geom[2]) - at.translation).norm(), 1e-12);
    EXPECT_EQ(m->geom_size[3 * (c + 1)], collider.size.x());
    EXPECT_EQ(m->geom_friction[3 * (c + 1)], collider.friction);
  }
  EXPECT_EQ(m->geom_size[3 * 2 + 1], s.colliders[1].size.z());
  const Vec3<double> at = (rest[7] * s.joints[8].rest).translation;
  ASSERT_EQ(m->nsite, 1);
  EXPECT_LT((Vec3<double>(d->site_xpos[0], d->site_xpos[1], d->site_xpos[2]) - at).norm(), 1e-12);
}

TEST(MjcfExport, NamesThatMujocoCannotTakeAreChanged) {
  Skeleton s = chain_of_all_joints(JointType::kFixed);
  s.joints[0].name = "world";
  s.joints[2].name = s.joints[1].name = "a \"<twin>\" & more";
  const Model m = compiled(s);
  ASSERT_TRUE(m);
  EXPECT_GT(mj_name2id(m.get(), mjOBJ_BODY, "world_2"), 0);
  EXPECT_GT(mj_name2id(m.get(), mjOBJ_BODY, "a \"<twin>\" & more_2"), 0);
}

TEST(MjcfExport, SaysWhichJointMovesNoMass) {
  Skeleton s = chain_of_all_joints(JointType::kFree);
  s.joints[1].type = JointType::kBall;
  std::vector<std::string> notes;
  write_mjcf(s, notes);
  for (const std::string& note : notes) EXPECT_EQ(note.find("no mass"), std::string::npos) << note;
  s.joints[0].mass = 0;  // and turns about the ball without anybody noticing
  s.joints[0].inertia.setZero();
  write_mjcf(s, notes);
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("moves no mass against the others") != std::string::npos &&
           note.find("(part 0)") != std::string::npos;
  }));
}

// Bodies rest on the floor by their colliders, and do not touch each other.
TEST(MjcfExport, TheCharacterFallsOnTheFloorAndStaysThere) {
  const Skeleton s = mannequin().skeleton;
  const Model m = compiled(s);
  ASSERT_TRUE(m);
  const Data d(mj_makeData(m.get()));
  while (d->time < 3) mj_step(m.get(), d.get());
  EXPECT_EQ(d->warning[mjWARN_BADQACC].number, 0);
  mj_comPos(m.get(), d.get());
  EXPECT_LT(d->subtree_com[2], 0.5);
  EXPECT_GT(d->subtree_com[2], 0.02);
  for (int c = 0; c < d->ncon; ++c)
    EXPECT_TRUE(m->geom_bodyid[d->contact[c].geom1] == 0 || m->geom_bodyid[d->contact[c].geom2] == 0);
  EXPECT_GT(d->ncon, 2);
}

class ForeignBody : public testing::TestWithParam<const char*> {};

TEST_P(ForeignBody, HasMujocosMassMatrixToNineDigits) {
  const std::string path = shared_asset(GetParam());
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no ../shared here: " << GetParam() << " was not exported";
  expect_same_mechanics(converted(path).skeleton);
}

INSTANTIATE_TEST_SUITE_P(Files, ForeignBody,
                         testing::Values("urdf/romeo.urdf", "urdf/unitree_h1.urdf",
                                         "urdf/unitree_g1_29dof.urdf", "urdf/panda.urdf",
                                         "urdf/bullet_humanoid.urdf", "urdf/solo12.urdf",
                                         "gltf/kaykit_knight.glb", "fbx/geno.fbx"));

}  // namespace
}  // namespace sinew::exporting::test
