#include "sinew/character/snapshot.h"

#include <algorithm>

#include "sinew/character/residual_coder.h"

namespace sinew {
namespace {

/// Also tells zeros of different sign apart.
template <class Values>
bool same_bits(const Values& a, const Values& b) {
  return std::memcmp(a.data(), b.data(), sizeof(*a.data()) * a.size()) == 0;
}

/// An enumeration as one byte, kept within what it knows.
template <class E>
void visit_enum(const char* name, E& e, E last, ByteStream& stream) {
  auto byte = static_cast<std::uint8_t>(e);
  stream.value(name, byte);
  if (stream.reading()) e = static_cast<E>(std::min(byte, static_cast<std::uint8_t>(last)));
}

template <class T>
void visit_levels(CharacterState<T>& s, ByteStream& stream) {
  LevelState& l = s.levels;
  visit_enum("level", l.level, Level::kSubsteps, stream);
  visit_enum("cap of the budget", l.cap, Level::kSubsteps, stream);
  visit_enum("highest level", s.detail.most, Level::kSubsteps, stream);
  std::uint8_t flags =
      static_cast<std::uint8_t>((l.asleep ? 1 : 0) + (s.detail.bake ? 2 : 0) + (l.wake ? 4 : 0));
  stream.value("asleep, baked, to be woken", flags);
  if (stream.reading()) {
    l.asleep = (flags & 1) != 0;
    s.detail.bake = (flags & 2) != 0;
    l.wake = (flags & 4) != 0;
  }
  const CharacterDetail usual;
  const bool detailed =
      s.detail.significance != usual.significance || s.detail.check_every != usual.check_every;
  if (stream.part("has a detail of its own", detailed)) {
    stream.value("significance", s.detail.significance);
    stream.value("steps between checks", s.detail.check_every);
    if (stream.reading()) s.detail.check_every = std::max(s.detail.check_every, 1);
  } else if (stream.reading()) {
    s.detail.significance = usual.significance;
    s.detail.check_every = usual.check_every;
  }
  stream.value("time above the level", l.unneeded);
  stream.value("cost", l.cost);
  stream.value("steps", l.steps);
  if (stream.part("is capped", l.cap != Level::kSubsteps || l.cap_age < LevelState().cap_age)) {
    stream.value("age of the cap", l.cap_age);
    stream.value("cost spared", l.spared);
  } else if (stream.reading()) {
    l.cap_age = LevelState().cap_age;
    l.spared = 0;
  }
  if (stream.part("rests", l.still > 0 || l.nap >= 0)) {
    stream.value("time at rest", l.still);
    stream.value("who sleeps with it", l.nap);
  } else if (stream.reading()) {
    l.still = 0;
    l.nap = -1;
  }
}

template <class T>
void visit_pose(CharacterState<T>& s, ByteStream& stream) {
  const auto rest = [&](std::size_t i) { return s.skeleton.joints[i].rest.template cast<T>(); };
  {
    ResidualCoder<T> coder("pose rotation", stream);
    for (std::size_t i = 0; i < s.local.size(); ++i) coder.rotation(s.local[i].rotation, rest(i).rotation);
  }
  {
    ResidualCoder<T> coder("pose translation", stream);
    for (std::size_t i = 0; i < s.local.size(); ++i)
      coder.values(s.local[i].translation, rest(i).translation);
  }
  for (int i = 0; i < s.tree.bodies; ++i) {
    JointJet<T>& last = s.target_before[i];
    const bool elsewhere =
        last.rotation.coeffs() != s.local[i].rotation.coeffs() || last.translation != s.local[i].translation;
    if (stream.part("joint is off its last target", elsewhere)) {
      ResidualCoder<T> coder("last target", stream);
      coder.rotation(last.rotation, s.local[i].rotation);
      coder.values(last.translation, s.local[i].translation);
    } else if (stream.reading()) {
      last.rotation = s.local[i].rotation;
      last.translation = s.local[i].translation;
    }
  }
}

/// The first so many members of one joint's six.
template <class T, class Predicted>
void visit_dofs(ResidualCoder<T>& coder, std::array<T, 6>& values, int count, Predicted predicted) {
  for (int k = 0; k < count; ++k) coder.value(values[k], predicted(k));
}

template <class T>
void visit_joints(CharacterState<T>& s, ByteStream& stream) {
  const auto zero = [](int) { return T(0); };
  stream.value("span of the joint speeds", s.rate_step);
  {
    ResidualCoder<T> coder("joint speed", stream);
    for (int i = 0; i < s.tree.bodies; ++i) visit_dofs(coder, s.rate[i], s.tree.dof_count(i), zero);
  }
  // The next step's guess looks further back only while nothing changes.
  if (stream.part("joint speeds change steadily", s.rate_step > T(0) && s.steps_unchanged > 0)) {
    ResidualCoder<T> coder("joint speed before", stream);
    for (int i = 0; i < s.tree.bodies; ++i)
      visit_dofs(coder, s.rate_before[i], s.tree.dof_count(i), [&](int k) { return s.rate[i][k]; });
  }
  for (int i = 0; i < s.tree.bodies; ++i) {
    Deviation<T>& d = s.deviation[i];
    constexpr std::array<T, 6> none{};
    const bool deviates = !same_bits(d.offset, none) || !same_bits(d.rate, none);
    auto flags =
        static_cast<std::uint8_t>((d.on_animation ? 1 : 0) + (d.released ? 2 : 0) + (deviates ? 4 : 0));
    stream.value("joint on the animation, released, off it", flags);
    if (stream.reading()) {
      d = {};
      d.on_animation = (flags & 1) != 0;
      d.released = (flags & 2) != 0;
    }
    if ((flags & 4) == 0 && !stream.bounding()) continue;
    ResidualCoder<T> coder("deviation", stream);
    const JointJet<T>& last = s.target_before[i];
    const std::array<T, 6> offset =
        joint_offset_value<T>(s.tree, i, {last.rotation, last.translation}, s.local[i]);
    visit_dofs(coder, d.offset, s.tree.dof_count(i), [&](int k) { return offset[k]; });
    visit_dofs(coder, d.rate, s.tree.dof_count(i), [&](int k) { return s.rate[i][k]; });
  }
  ResidualCoder<T> coder("load", stream);
  for (T& load : s.load) coder.value(load, T(0));
}

/// Poses a step earlier than `pose` [body], going by the speeds of the joints; bodies relative to the root's
/// place now. `pose` is moved there.
template <class T>
void step_back(const CharacterState<T>& s, const std::vector<std::array<T, 6>>& rate, T h,
               std::vector<Transform<T>>& pose, Kinematics<T>& out) {
  for (int i = 0; i < s.tree.bodies; ++i) {
    std::array<T, 6> back = rate[i];
    for (T& r : back) r *= -h;
    pose[i] = at_offset<T>(s.tree, i, pose[i], back);
  }
  forward_kinematics<T>(s.tree, pose, s.local[0].translation, out);
}

/// Where bodies are at the pose, in order and as far as they are known to the bit.
template <class T>
void visit_places(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  {
    ResidualCoder<T> coder("rotation", stream);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Mat3<T> relative = s.local[i].rotation.toRotationMatrix();
      Mat3<T> rotation = relative;  // as the step computes it
      if (s.tree.parent[i] >= 0) rotation.noalias() = h.rotation[s.tree.parent[i]] * relative;
      coder.values(h.rotation[i], rotation);
    }
  }
  ResidualCoder<T> coder("centre of mass", stream);
  std::copy_n(s.local.begin(), s.tree.bodies, s.wanted.begin());
  forward_kinematics<T>(s.tree, s.wanted, s.local[0].translation, s.guessed);
  for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.center[i], s.guessed.center[i]);
}

/// Velocities, going by places now, before (`h.…_before`, or as the joints' speeds have it) and before that.
template <class T>
void visit_velocities(CharacterState<T>& s, bool second, ByteStream& stream) {
  History<T>& h = s.history;
  const T step = s.rate_step > T(0) ? s.rate_step : T(1);
  const T k1 = second ? T(1.5) : T(1), k2 = second ? T(0.5) : T(0);
  {
    ResidualCoder<T> coder("velocity", stream);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Vec3<T> before = second ? h.center_before[i] : s.guessed.center[i];
      coder.values(h.velocity[i],
                   Vec3<T>((k1 * (h.center[i] - before) - k2 * (before - s.guessed.center[i])) / step));
    }
  }
  {
    ResidualCoder<T> coder("rotation rate", stream);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Mat3<T> before = second ? h.rotation_before[i] : s.guessed.rotation[i];
      coder.values(h.rotation_rate[i],
                   Mat3<T>((k1 * (h.rotation[i] - before) - k2 * (before - s.guessed.rotation[i])) / step));
    }
  }
  ResidualCoder<T> coder("angular momentum", stream);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = h.rotation[i];
    const Mat3<T> spin = h.rotation_rate[i] * r.transpose();
    const Vec3<T> omega =
        T(0.5) * Vec3<T>(spin(2, 1) - spin(1, 2), spin(0, 2) - spin(2, 0), spin(1, 0) - spin(0, 1));
    coder.values(h.momentum[i], Vec3<T>(r * (s.tree.inertia[i] * (r.transpose() * omega))));
  }
}

/// Uses `wanted` and `guessed`, which every step makes anew.
template <class T>
void visit_history(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  const Vec3<double> rounded = s.local[0].translation.template cast<double>();
  if (stream.part("place is finer than the pose's", h.place != rounded))
    stream.array("place", h.place.data(), 3);
  else if (stream.reading())
    h.place = rounded;
  stream.value("span of the history", h.step_before);
  std::uint8_t scheme = static_cast<std::uint8_t>(h.scheme);
  stream.value("scheme", scheme);
  if (stream.reading()) h.scheme = static_cast<Scheme>(std::min(scheme, std::uint8_t{2}));
  visit_places(s, stream);
  step_back<T>(s, s.rate, s.rate_step, s.wanted, s.guessed);
  const bool second = stream.part("contacts have been the same", s.steps_unchanged > 0);
  if (second) {
    {
      ResidualCoder<T> coder("centre of mass before", stream);
      for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.center_before[i], s.guessed.center[i]);
    }
    {
      ResidualCoder<T> coder("rotation before", stream);
      for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.rotation_before[i], s.guessed.rotation[i]);
    }
    step_back<T>(s, s.rate_before, s.rate_step, s.wanted, s.guessed);
  }
  visit_velocities(s, second, stream);
  if (!second) return;
  {
    ResidualCoder<T> coder("velocity before", stream);
    for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.velocity_before[i], h.velocity[i]);
  }
  ResidualCoder<T> coder("angular momentum before", stream);
  for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.momentum_before[i], h.momentum[i]);
}

}  // namespace

template <class T>
void visit_state(CharacterState<T>& s, ByteStream& stream) {
  std::uint8_t root = static_cast<std::uint8_t>(s.settings.root);
  stream.value("root drive", root);
  std::uint8_t parked = s.parked ? 1 : 0;
  stream.value("out of the world", parked);
  if (stream.reading()) s.parked = parked != 0;
  if (stream.reading() && root <= static_cast<std::uint8_t>(RootDrive::kFree))
    s.settings.root = static_cast<RootDrive>(root);
  stream.value("strength", s.settings.strength);
  const auto visit_strengths = [&](const char* name, std::vector<T>& strengths) {
    const bool some = std::any_of(strengths.begin(), strengths.end(), [](T x) { return x != T(1); });
    if (stream.part("has strengths of its own", some))
      stream.array(name, strengths.data(), strengths.size());
    else if (stream.reading())
      std::fill(strengths.begin(), strengths.end(), T(1));
  };
  visit_strengths("strength of a joint", s.joint_strength);
  visit_strengths("strength of a muscle", s.muscle_strength);
  stream.value("contacts that touched", s.contact_signature);
  stream.value("limits that bore", s.limit_signature);
  stream.value("steps with the same contacts", s.steps_unchanged);
  stream.value("energy ceiling", s.energy_ceiling);
  stream.value("stored energy", s.report.elastic_energy);
  visit_levels(s, stream);
  visit_pose(s, stream);
  visit_joints(s, stream);
  visit_history(s, stream);
  if (!stream.reading()) return;
  s.owed = {};
  s.impulses.clear();
  s.refresh_limits();
  s.update_model();
}

template <class T>
void visit_inputs(CharacterState<T>& s, ByteStream& stream) {
  for (JointJet<T>& jet : s.target) {
    stream.rotation("target rotation", jet.rotation);
    stream.vector("target angular velocity", jet.omega);
    stream.vector("target angular acceleration", jet.alpha);
    stream.vector("target translation", jet.translation);
    stream.vector("target velocity", jet.velocity);
    stream.vector("target acceleration", jet.acceleration);
  }
  std::uint32_t count = static_cast<std::uint32_t>(s.impulses.size());
  stream.value("number of impulses", count);
  if (stream.reading()) s.impulses.resize(std::min<std::size_t>(count, s.impulses.capacity()));
  for (ExternalForce<T>& impulse : s.impulses) {
    stream.value("impulse's body", impulse.body);
    if (stream.reading()) impulse.body = std::clamp(impulse.body, 0, s.tree.bodies - 1);
    stream.vector("impulse's point", impulse.local);
    stream.vector("impulse", impulse.force);
  }
}

namespace {

struct Header {
  std::uint32_t content = 0, bytes = 0;
  std::uint64_t layout = 0, digest = 0;
};

void visit_header(Header& header, ByteStream& stream) {
  stream.value("header", header.content);
  stream.value("header", header.bytes);
  stream.value("header", header.layout);
  stream.value("header", header.digest);
}

/// FNV-1a.
std::uint64_t digest(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const std::byte b : bytes) hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3ull;
  return hash;
}

/// Of a world's make-up: scalar, states and their joints. Bytes fit worlds of the same make-up.
template <class T>
std::uint64_t layout_of(const MovingParts<T>& world) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  const auto add = [&](std::uint64_t x) { hash = (hash ^ x) * 0x100000001b3ull; };
  add(sizeof(T));
  for (const auto& s : world.states) {
    add(s->local.size());
    add(s->muscle_strength.size());
    for (const JointType type : s->tree.type) add(static_cast<std::uint64_t>(type));
  }
  for (const auto& c : world.couplings) add(c->stencils.size());
  return hash;
}

template <class T>
void visit_lagged(std::vector<LaggedForce<T>>& lagged, ByteStream& stream) {
  std::uint32_t count = static_cast<std::uint32_t>(lagged.size());
  stream.value("number of contact forces", count);
  if (stream.reading()) lagged.resize(std::min<std::size_t>(count, lagged.capacity()));
  {
    ResidualCoder<std::uint64_t> coder("contact", stream);
    std::uint64_t before = 0;
    for (LaggedForce<T>& contact : lagged) {
      coder.value(contact.id, before);
      before = contact.id;
    }
  }
  ResidualCoder<T> coder("contact force", stream);
  T stiff = T(0);
  for (LaggedForce<T>& contact : lagged) {
    auto& [id, force, stiffness, offset] = contact;  // all of it: a new member will not compile here
    coder.value(force, T(0));
    coder.value(stiffness, stiff);
    coder.value(offset, T(0));
    stiff = stiffness;
  }
}

void visit_budget(BudgetState& budget, ByteStream& stream) {
  stream.value("forecast of the cost", budget.forecast);
  stream.value("cost of a unit of work", budget.scale);
  stream.value("steps above the budget", budget.over);
  stream.value("steps below it", budget.under);
}

template <class T>
void visit_coupling(Coupling<T>& coupling, ByteStream& stream) {
  std::uint8_t active = coupling.active ? 1 : 0;
  stream.value("loop is closed", active);
  if (stream.reading()) coupling.active = active != 0;
  if (!coupling.leads_out) return;
  for (Stencil<T>& e : coupling.stencils) stream.vector("what is left open of a loop", e.offset);
}

/// What belongs to nobody.
template <class T>
void visit_world(const MovingParts<T>& world, ByteStream& stream) {
  visit_budget(world.budget, stream);
  for (const auto& c : world.couplings) visit_coupling(*c, stream);
  visit_lagged(world.lagged, stream);
}

/// The bytes behind the header.
template <class T>
void visit(const MovingParts<T>& world, Content content, ByteStream& stream) {
  for (const auto& s : world.states)
    content == Content::kState ? visit_state(*s, stream) : visit_inputs(*s, stream);
  if (content == Content::kState) visit_world(world, stream);
}

}  // namespace

template <class T>
std::size_t bytes_at_most(const MovingParts<T>& world, Content content) {
  ByteStream stream = ByteStream::bound();
  visit(world, content, stream);
  std::size_t room = kHeaderBytes + stream.position();
  if (content == Content::kState)
    room += (world.lagged.capacity() - world.lagged.size()) * (sizeof(std::uint64_t) + 3 * sizeof(T) + 4);
  else
    for (const auto& s : world.states)
      room += (s->impulses.capacity() - s->impulses.size()) * (sizeof(int) + 6 * sizeof(T));
  return room;
}

template <class T>
std::size_t write_bytes(const MovingParts<T>& world, Content content, std::span<std::byte> out) {
  if (out.size() < kHeaderBytes) return 0;
  ByteStream body = ByteStream::writer(out.subspan(kHeaderBytes));
  visit(world, content, body);
  if (!body.ok()) return 0;
  const std::size_t bytes = kHeaderBytes + body.position();
  Header header{static_cast<std::uint32_t>(content), static_cast<std::uint32_t>(bytes), layout_of(world),
                digest(out.subspan(kHeaderBytes, body.position()))};
  ByteStream head = ByteStream::writer(out);
  visit_header(header, head);
  return bytes;
}

template <class T>
Status read_bytes(const MovingParts<T>& world, Content content, std::span<const std::byte> in) {
  Header header;
  ByteStream head = ByteStream::reader(in);
  visit_header(header, head);
  if (!head.ok() || header.content != static_cast<std::uint32_t>(content))
    return Status::error(Code::kBadFile, "not a snapshot");
  if (header.bytes != in.size()) return Status::error(Code::kBadFile, "snapshot is cut off");
  if (header.layout != layout_of(world))
    return Status::error(Code::kInvalidArgument, "snapshot of a world with other characters, props or loops");
  if (header.digest != digest(in.subspan(kHeaderBytes)))
    return Status::error(Code::kBadFile, "snapshot was changed");
  ByteStream body = ByteStream::reader(in.subspan(kHeaderBytes));
  visit(world, content, body);
  return body.ok() ? Status{} : Status::error(Code::kBadFile, "snapshot ends early");
}

template <class T>
SnapshotField field_at(const MovingParts<T>& world, std::size_t byte) {
  if (byte < kHeaderBytes) return {-1, "header"};
  ByteStream stream = ByteStream::namer(byte - kHeaderBytes);
  for (std::size_t n = 0; n < world.states.size(); ++n) {
    visit_state(*world.states[n], stream);
    if (*stream.name()) return {static_cast<int>(n), stream.name()};
  }
  visit_world(world, stream);
  return {-1, stream.name()};
}

SINEW_SNAPSHOT_INSTANCES(template, float)
SINEW_SNAPSHOT_INSTANCES(template, double)

}  // namespace sinew
