#include "study/stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/restitution.h"
#include "sinew/muscle/joint_coordinates.h"
#include "sinew/skeleton/rotation.h"
#include "study/impulse_work.h"

namespace sinew::study {
namespace {

constexpr double kBackwards = 1e-5;  ///< s: whence a start came, by its speeds

}  // namespace

int Measurement::passes_percentile(double share) const {
  int below = 0;
  for (std::size_t n = 0; n < pass_histogram.size(); ++n)
    if ((below += pass_histogram[n]) >= share * solved && below > 0) return static_cast<int>(n);
  return 0;
}

void Measurement::count(const CharacterReport& r) {
  ++solved;
  unconverged += !r.converged;
  restarts += r.restarts;
  passes += r.outer_passes;
  chords += r.chords;
  factorisations += r.factorisations;
  const int planned = std::max(r.substeps - r.splits, 1);
  const int passes_each = (r.outer_passes + planned - 1) / planned;
  most_passes = std::max(most_passes, passes_each);
  most_factorisations = std::max(most_factorisations, (r.factorisations + planned - 1) / planned);
  ++pass_histogram[std::min<std::size_t>(static_cast<std::size_t>(passes_each), pass_histogram.size() - 1)];
}

void Measurement::merge(const Measurement& o) {
  steps += o.steps;
  finite = finite && o.finite;
  kinetic_most = std::max(kinetic_most, o.kinetic_most);
  energy_gain = std::max(energy_gain, o.energy_gain);
  worst_rise = std::max(worst_rise, o.worst_rise);
  joint_gap = std::max(joint_gap, o.joint_gap);
  penetration = std::max(penetration, o.penetration);
  unconverged += o.unconverged;
  restarts += o.restarts;
  solved += o.solved;
  passes += o.passes;
  chords += o.chords;
  factorisations += o.factorisations;
  most_passes = std::max(most_passes, o.most_passes);
  most_factorisations = std::max(most_factorisations, o.most_factorisations);
  for (std::size_t i = 0; i < pass_histogram.size(); ++i) pass_histogram[i] += o.pass_histogram[i];
  microseconds += o.microseconds;
  if (refused.empty()) refused = o.refused;
}

template <class T>
std::vector<JointJet<T>> rest_jets(const Skeleton& skeleton) {
  std::vector<JointJet<T>> jets(skeleton.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = skeleton.joints[i].rest.rotation.template cast<T>();
    jets[i].translation = skeleton.joints[i].rest.translation.template cast<T>();
  }
  return jets;
}

template <class T>
Energy energy_of(const Skeleton& skeleton, const std::vector<JointJet<T>>& jets,
                 const Vec3<double>& gravity) {
  const Tree<T> tree(skeleton);
  Kinematics<T> kinematics(tree);
  Motion<T> motion(tree);
  std::vector<Vec3<T>> force(tree.bodies), moment(tree.bodies);
  inertial_wrenches<T>(tree, std::span(jets).first(tree.bodies), Vec3<T>::Zero(), Vec3<T>::Zero(), kinematics,
                       motion, force, moment);
  Energy e;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> w = kinematics.rotation[i].transpose() * motion.omega[i];
    e.kinetic += 0.5 * double(tree.mass[i] * motion.velocity[i].squaredNorm() + w.dot(tree.inertia[i] * w));
    e.potential -= double(tree.mass[i]) * gravity.dot(kinematics.center[i].template cast<double>());
  }
  return e;
}

template <class T>
Stage<T>::Stage(const WorldSettings& settings, Compared scheme)
    : settings_(settings),
      strikes_(scheme == Compared::kBossak),
      world_(std::make_unique<World<T>>(settings)) {
  for (const Status& status :
       {declare_scheme(scheme, *world_), world_->template declare<ContinuousDetection>(),
        world_->template declare<Restitution>()})
    if (!status) m_.refused = status.reason;
}

template <class T>
Stage<T>::Stage(const scene::Scene& scene, Compared scheme) : Stage(scene.world, scheme) {
  script_ = std::make_unique<Script>(scene, *world_);
  if (convert::Error error = script_->play.set_up()) {
    refuse(error.message);
    return;
  }
  for (std::size_t c = 0; c < scene.characters.size(); ++c)
    enter(scene.characters[c].asset->skeleton, script_->play.start(static_cast<int>(c)),
          RootDrive::kKinematic);
  for (const scene::SceneProp& prop : scene.props) enter(prop.settings);
}

/// Opens the books of a character that has been put into the world.
template <class T>
void Stage<T>::enter(const Skeleton& skeleton, const std::vector<JointJet<T>>& start, RootDrive root) {
  const Energy e = energy_of<T>(skeleton, start, settings_.gravity);
  kinetic_ += e.kinetic;
  energy_ += e.kinetic + e.potential;
  Member member{Tree<T>(skeleton), root, Tree<double>(skeleton), {}, {}, kBackwards};
  for (std::size_t i = 0; i < start.size(); ++i) {
    const JointJet<T>& jet = start[i];
    const Quat<double> back = rotation_exp<double>(-kBackwards * jet.omega.template cast<double>());
    const Vec3<double> way = kBackwards * jet.velocity.template cast<double>();
    const Transform<double> ago{jet.rotation.template cast<double>() * back,
                                jet.translation.template cast<double>() - way};
    const int parent = skeleton.joints[i].parent;
    member.earlier.push_back(parent < 0 ? ago : member.earlier[static_cast<std::size_t>(parent)] * ago);
  }
  members_.push_back(std::make_unique<Member>(std::move(member)));
}

template <class T>
void Stage<T>::enter(const PropSettings& prop) {
  const double kinetic = 0.5 * prop.mass * prop.velocity.squaredNorm();
  kinetic_ += kinetic;
  energy_ += kinetic - prop.mass * settings_.gravity.dot(prop.pose.translation);
  fresh_ = fresh_ || prop.angular_velocity.norm() > 0;  // its spin is booked when the first report comes
}

template <class T>
int Stage<T>::add(const Skeleton& skeleton, const CharacterSettings& settings,
                  const std::vector<JointJet<T>>& jets) {
  Status status;
  const int index = world_->add_character(skeleton, settings, status);
  if (index < 0) {
    m_.refused = status.reason;
    return index;
  }
  const std::vector<JointJet<T>> start = jets.empty() ? rest_jets<T>(skeleton) : jets;
  status = world_->character(index).set_target(start);
  if (!status) m_.refused = status.reason;
  world_->character(index).reset();
  enter(skeleton, start, settings.root);
  return index;
}

template <class T>
int Stage<T>::add_prop(const PropSettings& prop) {
  Status status;
  const int index = world_->add_prop(prop, status);
  if (index < 0) {
    m_.refused = status.reason;
    return index;
  }
  enter(prop);
  return index;
}

template <class T>
void Stage<T>::add_obstacle(const Collider& obstacle) {
  if (const Status status = world_->add_obstacle(obstacle); !status) m_.refused = status.reason;
}

template <class T>
void Stage<T>::push(const scene::Impulse& push, double h) {
  const auto& [c, joint, point, impulse, lasts] = push;
  const Status status = scene::apply(push, T(h), *world_);
  if (!status) {
    m_.refused = status.reason;
    return;
  }
  const Transform<double> model = character(c).model()[joint].template cast<double>();
  const Member& member = *members_[static_cast<std::size_t>(c)];
  const Vec3<double> local = model.inverse() * point;
  const Vec3<double> ago = member.earlier[static_cast<std::size_t>(joint)] * local;
  pushes_.push_back({c, joint, local, point, impulse, (point - ago) / member.span, strikes_ && !lasts});
}

/// Whether a character's root goes where it is led in the step that is to come.
template <class T>
bool Stage<T>::root_is_led(int c) const {
  const auto index = static_cast<std::size_t>(c);
  if (!script_) return members_[index]->root == RootDrive::kKinematic;
  return scene::value_at(script_->scene.characters[index].root, script_->time, RootDrive::kKinematic) ==
         RootDrive::kKinematic;
}

/// Of the impulses on a character that act at once.
template <class T>
double Stage<T>::work_of_strikes(int c) const {
  const Member& member = *members_[static_cast<std::size_t>(c)];
  std::vector<PointImpulse> impulses;
  for (const Push& p : pushes_)
    if (p.character == c && p.strikes) {
      int body = p.joint;
      while (body >= member.exact.bodies) body = world_->character(c).skeleton().joints[body].parent;
      impulses.push_back({body, p.before, p.impulse, p.speed});
    }
  if (impulses.empty()) return 0;
  std::vector<Transform<double>> local;
  for (int i = 0; i < member.exact.bodies; ++i) local.push_back(member.local[i].template cast<double>());
  return work_of_impulses(member.exact, local, root_is_led(c), impulses);
}

/// Where everybody is before a step of h seconds.
template <class T>
void Stage<T>::remember_poses(double h) {
  for (std::size_t c = 0; c < members_.size(); ++c) {
    Member& member = *members_[c];
    const auto local = character(static_cast<int>(c)).local();
    member.local.assign(local.begin(), local.end());
    member.earlier.clear();
    for (const Transform<T>& model : character(static_cast<int>(c)).model())
      member.earlier.push_back(model.template cast<double>());
    member.span = h;
  }
}

/// A load is a constant force over the step, so its work is force times the way of the point that it is fixed
/// to. What strikes has done its work before the step.
template <class T>
double Stage<T>::work_of_pushes(double h) {
  double work = 0;
  for (std::size_t c = 0; c < members_.size(); ++c) work += work_of_strikes(static_cast<int>(c));
  for (const Push& p : pushes_) {
    if (p.strikes) continue;
    const Transform<double> model = character(p.character).model()[p.joint].template cast<double>();
    work += (p.impulse / h).dot(model * p.local - p.before);
  }
  pushes_.clear();
  return work;
}

/// Muscles and driven roots: torque at the end of the step times the way made. Where it is negative (a muscle
/// that brakes) the energy must go down by as much.
template <class T>
double Stage<T>::work_of_muscles() {
  double work = 0;
  for (std::size_t c = 0; c < members_.size(); ++c) {
    const Member& member = *members_[c];
    const Character<T> now = character(static_cast<int>(c));
    for (int i = 0; i < member.tree.bodies; ++i) {
      const int first = member.tree.first_dof[i], count = member.tree.dof_count(i);
      if (count == 0) continue;
      const auto moved = joint_offset<T>(member.tree, i, member.local[i], now.local()[i]).value;
      for (int k = 0; k < count; ++k) work += double(now.torque()[first + k]) * double(moved[k]);
    }
  }
  return work;
}

template <class T>
void Stage<T>::measure_gaps(int index) {
  const Member& member = *members_[index];
  const auto model = character(index).model();
  for (int i = 0; i < member.tree.bodies; ++i) {
    if (!model[i].translation.allFinite() || !model[i].rotation.coeffs().allFinite()) m_.finite = false;
    const int parent = member.tree.parent[i];
    const JointType type = member.tree.type[i];
    if (parent < 0 || type == JointType::kFree || type == JointType::kPlanar || type == JointType::kPrismatic)
      continue;
    const Vec3<T> socket = model[parent] * member.tree.rest[i].translation;
    m_.joint_gap = std::max(m_.joint_gap, double((model[i].translation - socket).norm()));
  }
}

/// Elastic energy, in runtimes that report it.
template <class Report>
double elastic_of(const Report& report) {
  if constexpr (requires { report.elastic_energy; })
    return report.elastic_energy;
  else
    return 0;
}

template <class T>
void Stage<T>::book(const CharacterReport& r) {
  kinetic_ += r.kinetic_energy;
  energy_ += r.kinetic_energy + r.potential_energy + elastic_of(r);
  m_.finite = m_.finite && std::isfinite(r.kinetic_energy) && std::isfinite(r.potential_energy);
  m_.penetration = std::max(m_.penetration, r.penetration);
  if (r.unknown_dofs > 0 && (r.contacts > 0 || !in_contact_only_)) m_.count(r);
}

template <class T>
Vec3<double> Stage<T>::center_of_mass(int c) {
  const Skeleton& skeleton = character(c).skeleton();
  Vec3<double> sum = Vec3<double>::Zero();
  for (int i = 0; i < skeleton.body_count; ++i)
    sum += skeleton.joints[i].mass *
           (character(c).model()[i].template cast<double>() * skeleton.joints[i].center_of_mass);
  return sum / skeleton.total_mass();
}

/// What the scene asks for in a step of h seconds.
template <class T>
bool Stage<T>::follow_script(double h) {
  const double from = script_->time, to = script_->time += h;
  if (convert::Error error = script_->play.prepare(from, to)) {
    refuse(error.message);
    return false;
  }
  for (const scene::Impulse& p : script_->play.pushes(from, to)) push(p, h);
  return m_.refused.empty();
}

template <class T>
bool Stage<T>::step(double h) {
  if (!m_.refused.empty()) return false;
  if (script_ && !follow_script(h)) return false;
  remember_poses(h);
  if (m_.steps == 0) base_ = energy_, m_.kinetic_start = m_.kinetic_most = kinetic_;
  const auto begin = std::chrono::steady_clock::now();
  const Status status = world_->step(T(h));
  m_.microseconds +=
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  if (!status) {
    m_.refused = status.reason;
    return false;
  }
  ++m_.steps;
  const double before = energy_;
  energy_ = kinetic_ = 0;
  for (int c = 0; c < world_->character_count(); ++c) {
    measure_gaps(c);
    book(character(c).report());
  }
  for (int p = 0; p < world_->prop_count(); ++p) {
    if (!world_->prop_pose(p).translation.allFinite()) m_.finite = false;
    book(world_->prop_report(p));
  }
  const double work = work_of_pushes(h) + work_of_muscles();
  m_.kinetic_end = kinetic_;
  m_.kinetic_most = std::max(m_.kinetic_most, kinetic_);
  if (fresh_) {
    fresh_ = false;
    base_ = energy_ - m_.work;
    return true;
  }
  m_.work += work;
  m_.worst_rise = std::max(m_.worst_rise, energy_ - before - work);
  m_.energy_gain = std::max(m_.energy_gain, energy_ - base_ - m_.work);
  return true;
}

template Energy energy_of<float>(const Skeleton&, const std::vector<JointJet<float>>&, const Vec3<double>&);
template Energy energy_of<double>(const Skeleton&, const std::vector<JointJet<double>>&, const Vec3<double>&);
template std::vector<JointJet<float>> rest_jets<float>(const Skeleton&);
template std::vector<JointJet<double>> rest_jets<double>(const Skeleton&);
template class Stage<float>;
template class Stage<double>;

}  // namespace sinew::study
