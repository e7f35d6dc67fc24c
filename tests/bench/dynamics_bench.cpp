// One step of the 37-DOF humanoid at 1/60 s, on our runtime and on MuJoCo's, same model, same start, same
// run: limp in free flight, feet on the floor with muscles at a moving pose, limp on the floor. And the
// residual pass. Counters p50_us, p99_us are of single steps; `unknown` is the mean number of degrees of
// freedom solved for.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "bench/wu37.h"
#include "sinew/character/world.h"
#include "sinew/residual/residual_pass.h"
#include "sinew/residual/tree.h"

namespace sinew::bench {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr double kTorque = 150;  // N·m, every muscle
constexpr int kFrames = 120;     // of a run, then it starts anew: 2 s

enum class Situation { kFlight, kMuscles, kOnFloor };

/// Degree of freedom `d`'s speed at the start of a flight, rad/s: 1 rms.
double start_speed(int d) {
  std::mt19937 random(static_cast<unsigned>(d + 1));
  return std::normal_distribution<double>(0, 1)(random);
}

/// Both knees' angle (rad) and rate at time t: a squat of a third of a radian, feet left on the floor.
double knee(double t) {
  return 0.3 * (1 - std::cos(2 * t));
}
double knee_rate(double t) {
  return 0.6 * std::sin(2 * t);
}

class Times {
 public:
  /// Runs `step` as one timed iteration.
  template <class Step>
  void time(benchmark::State& state, const Step& step) {
    const auto begin = std::chrono::steady_clock::now();
    step();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    state.SetIterationTime(seconds);
    us_.push_back(1e6 * seconds);
  }
  void report(benchmark::State& state) {
    std::sort(us_.begin(), us_.end());
    state.counters["p50_us"] = us_[us_.size() / 2];
    state.counters["p99_us"] = us_[us_.size() * 99 / 100];
  }

 private:
  std::vector<double> us_;
};

/// The pose of frame n of a situation.
template <class T>
std::vector<JointJet<T>> jets_of(const Skeleton& s, Situation what, double t) {
  std::vector<JointJet<T>> jets(s.joints.size());
  int dof = 0;
  for (int i = 0; i < s.body_count; ++i) {
    const Joint& joint = s.joints[i];
    jets[i].rotation = joint.rest.rotation.cast<T>();
    jets[i].translation = joint.rest.translation.cast<T>();
    const bool hinge = joint.type == JointType::kRevolute;
    for (int k = 0; what == Situation::kFlight && k < (hinge ? 1 : 3); ++k, ++dof)
      jets[i].omega +=
          ((hinge ? joint.axis : Vec3<double>(Vec3<double>::Unit(k))) * start_speed(dof)).cast<T>();
    if (what == Situation::kMuscles && hinge && joint.name.starts_with("shin")) {
      jets[i].rotation *= Quat<T>(Eigen::AngleAxis<T>(T(knee(t)), joint.axis.cast<T>()));
      jets[i].omega = (joint.axis * knee_rate(t)).cast<T>();
    }
  }
  // The feet's soles are 0.09 m below their joints, these 0.85 m below the pelvis' hips.
  if (what == Situation::kMuscles) jets[0].translation.z() = T(1.3);
  if (what == Situation::kOnFloor) jets[0].translation.z() = T(1.5);
  return jets;
}

template <class T>
void sinew_step(benchmark::State& state, Situation what) {
  const ModelPointer model = load_wu37();
  const Skeleton skeleton = skeleton_of(*model, kTorque);
  WorldSettings settings;
  settings.ground = what != Situation::kFlight;
  World<T> world(settings);
  CharacterSettings how;
  how.root = RootDrive::kFree;
  how.strength = what == Situation::kMuscles ? 1 : 0;
  Status status;
  const int index = world.add_character(skeleton, how, status);
  if (!status) return state.SkipWithError(status.reason);
  Character<T> character = world.character(index);
  std::vector<std::vector<JointJet<T>>> frames;
  for (int n = 0; n <= kFrames; ++n) frames.push_back(jets_of<T>(skeleton, what, n * kStep));
  Times times;
  int n = kFrames;
  double unknown = 0, passes = 0;
  for (auto _ : state) {
    if (n == kFrames) {
      n = 0;
      (void)character.set_target(frames[0]);
      (void)character.reset();
    }
    ++n;
    if (what == Situation::kMuscles) (void)character.set_target(frames[n]);
    times.time(state, [&] { benchmark::DoNotOptimize(world.step(T(kStep))); });
    unknown += character.report().unknown_dofs;
    passes += character.report().outer_passes;
  }
  times.report(state);
  state.counters["unknown"] = benchmark::Counter(unknown, benchmark::Counter::kAvgIterations);
  state.counters["passes"] = benchmark::Counter(passes, benchmark::Counter::kAvgIterations);
}

constexpr double kRate = 1 / 0.1;  // 1/s, as Accuracy::return_time

/// Critical damping at the muscles' rate as joint damping, which MuJoCo integrates implicitly.
std::vector<double> damp(mjModel& m, const mjData& d) {
  std::vector<double> inertia(m.nv);
  for (int v = 6; v < m.nv; ++v) {
    inertia[v] = d.qM[m.dof_Madr[v]];
    m.dof_damping[v] = 2 * inertia[v] * kRate;
  }
  return inertia;
}

/// What a servo adds to the damping: spring and the wanted speed, within the muscles' strength.
void mujoco_servos(const mjModel& m, mjData& d, const Skeleton& s, const std::vector<double>& inertia,
                   const std::vector<JointJet<double>>& jets) {
  for (int b = 2; b < m.nbody; ++b) {  // without world and root
    const int joint = m.body_jntadr[b], q = m.jnt_qposadr[joint], v = m.jnt_dofadr[joint];
    const JointJet<double>& jet = jets[b - 1];
    const Quat<double> wanted = s.joints[b - 1].rest.rotation.conjugate() * jet.rotation;
    double error[3] = {0, 0, 0};
    const bool hinge = m.jnt_type[joint] == mjJNT_HINGE;
    if (hinge) {
      error[0] = 2 * std::atan2(wanted.vec().dot(s.joints[b - 1].axis), wanted.w()) - d.qpos[q];
    } else {
      const mjtNum want[4] = {wanted.w(), wanted.x(), wanted.y(), wanted.z()};
      mju_subQuat(error, want, d.qpos + q);
    }
    for (int k = 0; k < (hinge ? 1 : 3); ++k) {
      const double speed = hinge ? jet.omega.dot(s.joints[b - 1].axis) : jet.omega[k];
      d.qfrc_applied[v + k] = std::clamp(
          inertia[v + k] * kRate * kRate * error[k] + m.dof_damping[v + k] * speed, -kTorque, kTorque);
    }
  }
}

void mujoco_step(benchmark::State& state, Situation what, int integrator) {
  const ModelPointer model = load_wu37();
  model->opt.timestep = kStep;
  model->opt.integrator = integrator;
  if (what == Situation::kFlight) model->opt.disableflags |= mjDSBL_CONTACT;
  const Skeleton skeleton = skeleton_of(*model, kTorque);
  const DataPointer data(mj_makeData(model.get()));
  mjData& d = *data;
  mj_forward(model.get(), &d);
  const std::vector<double> inertia = what == Situation::kMuscles ? damp(*model, d) : std::vector<double>();
  Times times;
  int n = kFrames;
  for (auto _ : state) {
    if (n == kFrames) {
      n = 0;
      mj_resetData(model.get(), &d);
      const auto jets = jets_of<double>(skeleton, what, 0);
      for (int k = 0; k < 3; ++k) d.qpos[k] = jets[0].translation[k];
      for (int b = 1; b < model->nbody; ++b) {  // the same speeds in MuJoCo's order: free joints linear first
        const int joint = model->body_jntadr[b], v = model->jnt_dofadr[joint];
        if (model->jnt_type[joint] == mjJNT_HINGE)
          d.qvel[v] = jets[b - 1].omega.dot(skeleton.joints[b - 1].axis);
        else
          for (int k = 0; k < 3; ++k)
            d.qvel[v + k + (model->jnt_type[joint] == mjJNT_FREE ? 3 : 0)] = jets[b - 1].omega[k];
      }
      mj_forward(model.get(), &d);
    }
    ++n;
    if (what == Situation::kMuscles)
      mujoco_servos(*model, d, skeleton, inertia, jets_of<double>(skeleton, what, n * kStep));
    times.time(state, [&] { mj_step(model.get(), &d); });
  }
  times.report(state);
  state.counters["warnings"] =
      d.warning[mjWARN_BADQPOS].number + d.warning[mjWARN_BADQVEL].number + d.warning[mjWARN_BADQACC].number;
}

/// Torques alone, in body axes.
template <class T>
void residual_torques(benchmark::State& state) {
  const Skeleton skeleton = skeleton_of(*load_wu37(), kTorque);
  const Tree<T> tree(skeleton);
  const std::vector<JointJet<T>> jets = jets_of<T>(skeleton, Situation::kFlight, 0);
  std::vector<BodyMotion<T>> bodies(tree.bodies);
  std::vector<T> residual(tree.dofs);
  for (auto _ : state) {
    sinew::residual_pass<T>(tree, jets, Vec3<T>(0, 0, T(-9.81)), bodies, residual);
    benchmark::DoNotOptimize(residual.data());
    benchmark::ClobberMemory();
  }
}

/// The same, and where every body is and how it moves in the world.
template <class T>
void residual_pass(benchmark::State& state) {
  const Skeleton skeleton = skeleton_of(*load_wu37(), kTorque);
  const Tree<T> tree(skeleton);
  const std::vector<JointJet<T>> jets = jets_of<T>(skeleton, Situation::kFlight, 0);
  Kinematics<T> kinematics(tree);
  Motion<T> motion(tree);
  std::vector<Vec3<T>> force(tree.bodies), moment(tree.bodies);
  std::vector<T> residual(tree.dofs);
  for (auto _ : state) {
    inertial_wrenches<T>(tree, jets, Vec3<T>(0, 0, T(-9.81)), Vec3<T>::Zero(), kinematics, motion, force,
                         moment);
    project_wrenches<T>(tree, kinematics, force, moment, residual);
    benchmark::DoNotOptimize(residual.data());
  }
}

void sinew_float(benchmark::State& state, Situation what) {
  sinew_step<float>(state, what);
}
void sinew_double(benchmark::State& state, Situation what) {
  sinew_step<double>(state, what);
}
void mujoco_euler(benchmark::State& state, Situation what) {
  mujoco_step(state, what, mjINT_EULER);
}
void mujoco_implicit(benchmark::State& state, Situation what) {
  mujoco_step(state, what, mjINT_IMPLICIT);
}

#define SINEW_ENGINE(engine, name, what) \
  BENCHMARK_CAPTURE(engine, name, what)->UseManualTime()->Unit(benchmark::kMicrosecond)
#define SINEW_SITUATION(name, what)       \
  SINEW_ENGINE(sinew_float, name, what);  \
  SINEW_ENGINE(sinew_double, name, what); \
  SINEW_ENGINE(mujoco_euler, name, what); \
  SINEW_ENGINE(mujoco_implicit, name, what)
SINEW_SITUATION(limp_flight, Situation::kFlight);
SINEW_SITUATION(muscles_on_floor, Situation::kMuscles);
SINEW_SITUATION(limp_on_floor, Situation::kOnFloor);
BENCHMARK(residual_pass<float>)->Unit(benchmark::kNanosecond);
BENCHMARK(residual_pass<double>)->Unit(benchmark::kNanosecond);
BENCHMARK(residual_torques<float>)->Unit(benchmark::kNanosecond);
BENCHMARK(residual_torques<double>)->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace sinew::bench
