#include "study/stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/restitution.h"
#include "sinew/residual/tree.h"
#include "sinew/skeleton/rotation.h"
#include "study/accuracy_clock.h"
#include "study/audit/work.h"

namespace sinew::study {
namespace {

constexpr int kWarmUp = 3;        ///< steps in which caches fill
constexpr double kMoment = 1e-4;  ///< s: whence a start came and where it goes, by its speeds

/// What a world of T rounds coordinates and rotations to, of their size.
template <class T>
constexpr double kRounding = double(std::numeric_limits<T>::epsilon());

/// Where joints are (joint → world) `later` seconds after a start, by their speeds there.
template <class T>
std::vector<Transform<double>> poses_after(const Skeleton& skeleton, const std::vector<JointJet<T>>& start,
                                           double later) {
  std::vector<Transform<double>> poses;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const JointJet<T>& jet = start[static_cast<std::size_t>(i)];
    const Quat<double> turn = rotation_exp<double>(later * jet.omega.template cast<double>());
    const Transform<double> local{
        jet.rotation.template cast<double>() * turn,
        jet.translation.template cast<double>() + later * jet.velocity.template cast<double>()};
    const int parent = skeleton.joints[static_cast<std::size_t>(i)].parent;
    poses.push_back(parent < 0 ? local : poses[static_cast<std::size_t>(parent)] * local);
  }
  return poses;
}

}  // namespace

int Measurement::passes_percentile(double share) const {
  int below = 0;
  for (std::size_t n = 0; n < pass_histogram.size(); ++n)
    if ((below += pass_histogram[n]) >= share * solved && below > 0) return static_cast<int>(n);
  return 0;
}

double Measurement::slowest_over_median() const {
  if (solved_us.empty()) return 0;
  std::vector<float> times = solved_us;
  const auto middle = times.begin() + std::ssize(times) / 2;
  std::nth_element(times.begin(), middle, times.end());
  return double(*std::max_element(middle, times.end())) / double(*middle);
}

void Measurement::count(const CharacterReport& r) {
  ++solved;
  unconverged += !r.converged;
  restarts += r.restarts;
  passes += r.outer_passes;
  simplified_steps += r.simplified_steps;
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
  leap = std::max(leap, o.leap);
  unsure = std::max(unsure, o.unsure);
  instants += o.instants;
  seen += o.seen;
  blind += o.blind;
  joint_gap = std::max(joint_gap, o.joint_gap);
  joint_angle = std::max(joint_angle, o.joint_angle);
  penetration = std::max(penetration, o.penetration);
  unconverged += o.unconverged;
  restarts += o.restarts;
  solved += o.solved;
  passes += o.passes;
  simplified_steps += o.simplified_steps;
  factorisations += o.factorisations;
  most_passes = std::max(most_passes, o.most_passes);
  most_factorisations = std::max(most_factorisations, o.most_factorisations);
  for (std::size_t i = 0; i < pass_histogram.size(); ++i) pass_histogram[i] += o.pass_histogram[i];
  microseconds += o.microseconds;
  solved_us.insert(solved_us.end(), o.solved_us.begin(), o.solved_us.end());
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
      world_(std::make_unique<World<T>>(settings)),
      books_(settings.gravity, kRounding<T>) {
  around_.ground = settings.ground;
  around_.ground_height = settings.ground_height;
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
          scene.characters[c].settings);
  for (const scene::SceneProp& prop : scene.props) enter(prop.settings);
  for (const Collider& obstacle : scene.obstacles) around_.obstacles.push_back(audit::solid_of(obstacle));
}

/// Opens the books of a character that has been put into the world.
template <class T>
void Stage<T>::enter(const Skeleton& skeleton, const std::vector<JointJet<T>>& start,
                     const CharacterSettings& as) {
  audit::Member member = audit::member_of(skeleton);
  member.touches_ground = as.ground_contact;
  member.touches_itself = as.self_collision;
  books_.add(member, poses_after(skeleton, start, -kMoment), poses_after(skeleton, start, 0),
             poses_after(skeleton, start, kMoment), kMoment);
  roots_.push_back(as.root);
  balance();
}

template <class T>
void Stage<T>::enter(const PropSettings& prop) {
  const auto after = [&](double later) {
    const Quat<double> turn = rotation_exp<double>(later * prop.angular_velocity);
    return std::vector<Transform<double>>{
        {turn * prop.pose.rotation, prop.pose.translation + later * prop.velocity}};
  };
  books_.add(audit::loose_solid(prop.shape, prop.size, prop.mass, prop.hull), after(-kMoment), after(0),
             after(kMoment), kMoment);
  balance();
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
  (void)world_->character(index).reset();
  enter(skeleton, start, settings);
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
  around_.obstacles.push_back(audit::solid_of(obstacle));
}

template <class T>
void Stage<T>::push(const scene::Impulse& push, double h) {
  const auto& [c, joint, point, impulse, lasts] = push;
  const Status status = scene::apply(push, T(h), *world_);
  if (!status) {
    m_.refused = status.reason;
    return;
  }
  const int body = body_of(c, joint);
  const Transform<double> model = character(c).model()[body].template cast<double>();
  const Vec3<double> local = model.inverse() * point;
  pushes_.push_back({c, body, local, point, impulse, books_.arriving(c, body, local), strikes_ && !lasts});
}

/// The simulated joint that carries a joint.
template <class T>
int Stage<T>::body_of(int c, int joint) const {
  const Skeleton& skeleton = world_->character(c).skeleton();
  while (joint >= skeleton.body_count) joint = skeleton.joints[static_cast<std::size_t>(joint)].parent;
  return joint;
}

/// Whether a character's root goes where it is driven in the step that is to come.
template <class T>
bool Stage<T>::root_is_driven(int c) const {
  const auto index = static_cast<std::size_t>(c);
  if (!script_) return roots_[index] == RootDrive::kKinematic;
  return scene::value_at(script_->scene.characters[index].root, script_->time, RootDrive::kKinematic) ==
         RootDrive::kKinematic;
}

/// Of the impulses on a character that act at once, and how far that may be off.
template <class T>
double Stage<T>::work_of_strikes(int c, double& unsure) const {
  std::vector<audit::PointImpulse> impulses;
  for (const Push& p : pushes_)
    if (p.character == c && p.strikes) {
      impulses.push_back({p.joint, p.before, p.impulse, p.speed.value});
      unsure += p.impulse.norm() * p.speed.error;
    }
  if (impulses.empty()) return 0;
  return audit::work_of_impulses(books_.members()[static_cast<std::size_t>(c)], poses_of(c),
                                 root_is_driven(c), impulses);
}

/// Everybody's bodies where the world says that they are: characters, then props.
template <class T>
std::vector<Transform<double>> Stage<T>::poses() const {
  std::vector<Transform<double>> all;
  for (int c = 0; c < world_->character_count(); ++c) {
    const Character<T> one = world_->character(c);
    for (int i = 0; i < one.skeleton().body_count; ++i)
      all.push_back(one.model()[static_cast<std::size_t>(i)].template cast<double>());
  }
  for (int p = 0; p < world_->prop_count(); ++p) all.push_back(world_->prop_pose(p).template cast<double>());
  return all;
}

/// A load is a constant force over the step, so its work is force times the way of the point that it is fixed
/// to.
template <class T>
double Stage<T>::work_of_loads(double h) const {
  double work = 0;
  for (const Push& p : pushes_) {
    if (p.strikes) continue;
    const Transform<double> model =
        world_->character(p.character).model()[static_cast<std::size_t>(p.joint)].template cast<double>();
    work += (p.impulse / h).dot(model * p.local - p.before);
  }
  return work;
}

/// Muscles and driven roots: torque at the end of the step times the way made. Where it is negative (a muscle
/// that brakes) the energy must go down by as much. `after`: where everybody is now.
template <class T>
double Stage<T>::work_of_muscles(const std::vector<Transform<double>>& after) const {
  double work = 0;
  std::size_t first = 0;
  for (int c = 0; c < world_->character_count(); ++c) {
    const audit::Member& member = books_.members()[static_cast<std::size_t>(c)];
    const auto torque = world_->character(c).torque();
    const std::vector<double> torques(torque.begin(), torque.begin() + member.dofs);
    work += audit::work_of_torques(member, poses_of(c),
                                   audit::Poses(after).subspan(first, member.bodies.size()), torques);
    first += member.bodies.size();
  }
  return work;
}

template <class T>
double Stage<T>::depth() const {
  const std::vector<audit::Member>& members = books_.members();
  std::vector<audit::Poses> poses;
  double deepest = 0;
  for (std::size_t m = 0; m < members.size(); ++m) {
    poses.push_back(poses_of(static_cast<int>(m)));
    deepest = std::max(deepest, audit::depth_in(around_, members[m], poses.back()));
  }
  return settings_.body_contact ? std::max(deepest, audit::deepest_between(members, poses)) : deepest;
}

template <class T>
double Stage<T>::depth(int member) const {
  const std::vector<audit::Member>& members = books_.members();
  const audit::Member& one = members[static_cast<std::size_t>(member)];
  double deepest = audit::depth_in(around_, one, poses_of(member));
  for (std::size_t m = 0; m < members.size(); ++m)
    if (static_cast<int>(m) != member)
      deepest = std::max(
          deepest, audit::depth_between(one, poses_of(member), members[m], poses_of(static_cast<int>(m))));
  return deepest;
}

template <class T>
double Stage<T>::loop_gap(int loop) const {
  const auto place = [&](const Anchor& anchor) {
    if (anchor.kind == AnchorKind::kCharacter)
      return poses_of(anchor.index)[static_cast<std::size_t>(anchor.joint)] * anchor.frame;
    if (anchor.kind == AnchorKind::kProp)
      return poses_of(world_->character_count() + anchor.index)[0] * anchor.frame;
    return anchor.frame;
  };
  const LoopSettings& l = script_->scene.loops[static_cast<std::size_t>(loop)];
  return (place(l.a).translation - place(l.b).translation).norm();
}

/// Joints and depths now.
template <class T>
void Stage<T>::look() {
  for (std::size_t m = 0; m < books_.members().size(); ++m) {
    const audit::Poses poses = poses_of(static_cast<int>(m));
    for (const Transform<double>& pose : poses)
      if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) m_.finite = false;
    const audit::Gap gap = audit::joint_gap(books_.members()[m], poses, kRounding<T>);
    m_.joint_gap = std::max(m_.joint_gap, gap.distance);
    m_.joint_angle = std::max(m_.joint_angle, gap.angle);
  }
  m_.penetration = std::max(m_.penetration, depth());
}

/// What the books show so far.
template <class T>
void Stage<T>::balance() {
  const audit::Balance& b = books_.balance();
  m_.kinetic_start = b.kinetic_start;
  m_.kinetic_end = b.kinetic_end;
  m_.kinetic_most = b.kinetic_most;
  m_.energy_gain = b.gain;
  m_.worst_rise = b.rise;
  m_.leap = b.leap;
  m_.unsure = b.unsure;
  m_.instants = b.instants;
  m_.seen = b.seen;
  m_.blind = b.blind;
  m_.work = b.work;
}

template <class T>
void Stage<T>::count(const CharacterReport& r) {
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
  const bool known = books_.begun();
  double work = 0, unsure = 0;
  for (int c = 0; known && c < world_->character_count(); ++c) work += work_of_strikes(c, unsure);
  const double begin = processor_seconds();
  const Status status = world_->step(T(h));
  const double microseconds = 1e6 * (processor_seconds() - begin);
  m_.microseconds += microseconds;
  if (!status) {
    m_.refused = status.reason;
    return false;
  }
  ++m_.steps;
  const std::vector<Transform<double>> now = poses();
  if (known) work += work_of_loads(h) + work_of_muscles(now);
  pushes_.clear();
  books_.record(h, now, work, unsure);
  look();
  balance();
  const int solved = m_.solved;
  for (int c = 0; c < world_->character_count(); ++c) count(character(c).report());
  for (int p = 0; p < world_->prop_count(); ++p) count(world_->prop_report(p));
  if (m_.solved > solved && m_.steps > kWarmUp) m_.solved_us.push_back(static_cast<float>(microseconds));
  return true;
}

template Energy energy_of<float>(const Skeleton&, const std::vector<JointJet<float>>&, const Vec3<double>&);
template Energy energy_of<double>(const Skeleton&, const std::vector<JointJet<double>>&, const Vec3<double>&);
template std::vector<JointJet<float>> rest_jets<float>(const Skeleton&);
template std::vector<JointJet<double>> rest_jets<double>(const Skeleton&);
template class Stage<float>;
template class Stage<double>;

}  // namespace sinew::study
