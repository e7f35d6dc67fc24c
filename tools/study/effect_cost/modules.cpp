#include "study/effect_cost/modules.h"

#include "sinew/character/contacts.h"
#include "sinew/effects/buoyancy.h"
#include "sinew/effects/check_batch.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/impulse.h"
#include "sinew/effects/joint_damping.h"
#include "sinew/effects/joint_limit.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/muscle.h"
#include "sinew/effects/restitution.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"
#include "sinew/effects/support.h"
#include "sinew/effects/wind.h"

namespace sinew::study {

std::unique_ptr<Effect<float>> make_module(const std::string& name, const std::vector<std::string>& joints) {
  if (name == "wind") {
    WindSettings breeze;
    breeze.velocity = {5, 1, 0};
    breeze.joints = joints;
    return std::make_unique<Wind<float>>(breeze);
  }
  if (name == "buoyancy") {
    BuoyancySettings sea;
    sea.level = 100;
    sea.flow = {0.5, 0.1, 0};
    sea.joints = joints;
    return std::make_unique<Buoyancy<float>>(sea);
  }
  if (name == "joint_spring") {
    JointSpringSettings spring;
    spring.damping = 1;
    spring.joints = joints;
    return std::make_unique<JointSpring<float>>(spring);
  }
  if (name == "force_field") {
    ForceFieldSettings pull;
    pull.center = {3, 2, 1};
    pull.acceleration = 2;
    pull.joints = joints;
    return std::make_unique<ForceField<float>>(pull);
  }
  return nullptr;
}

bool declare_module(const std::string& name, World<float>& world) {
  if (name == "restitution") return bool(world.declare<Restitution>());
  if (name == "continuous_detection") return bool(world.declare<ContinuousDetection>());
  if (name == "muscles") return bool(world.declare<Muscles>());
  if (name == "impulses") return bool(world.declare<Impulses>());
  if (name == "batches") return bool(world.declare<Batches>());
  if (name == "contacts") return bool(world.declare<Contacts>());
  if (name == "support") return world.declare<Contacts>() && world.declare<Support>();
  return false;
}

void declare_term(const std::string& name, StepPlan<float>& plan) {
  if (name == "muscles") Muscles<float>::declare(plan);
  const bool touches =
      name == "ground" || name == "obstacle" || name == "self_collision" || name == "character_contact";
  if (touches) Contacts<float>::declare(plan);
  if (name == "joint_limits") JointLimits<float>::declare(plan);
  if (name == "joint_damping" || name == "dry_friction") JointDamping<float>::declare(plan);
}

void begin_contact(const Kinematics<float>& a, const Kinematics<float>* b, Contact<float>& contact) {
  begin_step<float>(a, b, contact);
}

namespace {

Status add_loops(int count, World<float>& world) {
  Status status;
  for (int i = 0; i < count && status; ++i) {
    LoopSettings pin;
    pin.a.kind = AnchorKind::kCharacter;
    pin.a.joint = i + 1;
    pin.a.frame.translation = {1, 0, 0};
    const Vec3<float> tip = world.character(0).model()[i + 1] * Vec3<float>(1, 0, 0);
    pin.b.frame.translation = tip.cast<double>();
    (void)world.add_loop(pin, status);
  }
  return status;
}

ParticleBody block(int cells) {
  SoftTissueSettings tissue;
  make_block({0.1, 0.1, 0.1 * cells}, {1, 1, cells}, tissue);
  tissue.fixed = {0, 1, 2, 3};
  return make_soft_tissue(tissue);
}

ParticleBody strand(int particles) {
  StrandSettings hair;
  hair.particles = particles;
  hair.length = 0.05 * particles;
  return make_strand(hair);
}

ParticleBody strip(int rows) {
  ClothSettings cloth;
  make_grid(0.1, 0.1 * rows, 1, rows, cloth);
  cloth.fixed = {0, 1};
  return make_cloth(cloth);
}

}  // namespace

Status add_ties(const std::string& name, int count, World<float>& world) {
  Status status;
  if (name == "loops") return add_loops(count, world);
  if (count == 0) return status;
  if (name == "strand")
    (void)world.add_particles(strand(count), status);
  else if (name == "cloth")
    (void)world.add_particles(strip(count), status);
  else if (name == "soft_tissue")
    (void)world.add_particles(block(count), status);
  else
    return Status::error(Code::kInvalidArgument, "no such effect");
  return status;
}

}  // namespace sinew::study
