#include "sinew/character/snapshot.h"

#include <algorithm>

#include "sinew/character/residual_coder.h"
#include "sinew/character/snapshot_history.h"
#include "sinew/character/tone.h"
#include "sinew/character/unknowns.h"
#include "sinew/skeleton/digest.h"
#include "sinew/skeleton/fewer_digits.h"

namespace sinew {
namespace {

/// Also tells zeros of different sign apart.
template <class Values>
bool same_bits(const Values& a, const Values& b) {
  return std::memcmp(a.data(), b.data(), sizeof(*a.data()) * a.size()) == 0;
}

template <class T>
void visit_levels(CharacterState<T>& s, ByteStream& stream) {
  LevelState& l = s.levels;
  stream.enumeration("level", l.level, Level::kSubsteps);
  stream.enumeration("cap of the budget", l.cap, Level::kSubsteps);
  stream.enumeration("highest level", s.detail.most, Level::kSubsteps);
  std::uint8_t flags = static_cast<std::uint8_t>((l.asleep ? 1 : 0) + (s.detail.bake ? 2 : 0) +
                                                 (l.wake ? 4 : 0) + (s.deferred.deviations ? 8 : 0));
  stream.value("asleep, baked, to be woken, only falling", flags);
  if (stream.reading()) {
    l.asleep = (flags & 1) != 0;
    s.detail.bake = (flags & 2) != 0;
    l.wake = (flags & 4) != 0;
    s.deferred = {.deviations = (flags & 8) != 0};
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
  if (stream.part("is above what it needs", l.unneeded > 0)) {
    stream.value("time above the level", l.unneeded);
    stream.enumeration("level needed since", l.lower, Level::kSubsteps);
    stream.value("time above that", l.lower_unneeded);
  } else if (stream.reading()) {
    l.unneeded = l.lower_unneeded = 0;
    l.lower = Level::kAsleep;
  }
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

/// What a joint's pose is predicted from. Where a prop was added, or a character stands at rest, is no part
/// of a world's make-up: roots are predicted from the world's origin.
template <class T>
Transform<T> predicted_pose(const CharacterState<T>& s, std::size_t i) {
  if (i >= static_cast<std::size_t>(s.tree.bodies)) return s.skeleton.joints[i].rest.template cast<T>();
  return s.tree.parent[i] < 0 ? Transform<T>() : s.tree.rest[i];
}

template <class T>
void visit_pose(CharacterState<T>& s, ByteStream& stream) {
  const auto rest = [&](std::size_t i) { return predicted_pose(s, i); };
  const auto visit = [&](const char* name, auto visit_joint) {
    ResidualCoder<T> coder(name, stream, true);
    for (std::size_t i = 0; i < s.local.size(); ++i) visit_joint(coder, i, s.local[i]);
  };
  ResidualCoder<T>("pose rotation", stream, true).unpredicted([&](const auto& visit_number) {
    for (std::size_t i = 0; i < s.local.size(); ++i)
      for (int n = 0; n < 3; ++n) visit_number(s.local[i].rotation.coeffs()[n], rest(i).rotation.coeffs()[n]);
  });
  visit("pose rotation's last member", [&](auto& coder, std::size_t i, Transform<T>& x) {
    coder.value_but_sign(x.rotation.w(), last_of(x.rotation, rest(i).rotation));
  });
  visit("pose translation", [&](auto& coder, std::size_t i, Transform<T>& x) {
    coder.values(x.translation, rest(i).translation);
  });
}

constexpr std::uint8_t kOnAnimation = 1, kReleased = 2, kElsewhere = 4, kDeviates = 8;

/// What there is of each joint, kept in `baked`.
template <class T>
void visit_flags(CharacterState<T>& s, ByteStream& stream) {
  constexpr std::array<T, 6> none{};
  ResidualCoder<std::uint32_t> coder("joint on the animation, released, off its last target, deviating",
                                     stream, true);
  std::uint32_t flags = 0;  // mostly those of the joint before
  for (int i = 0; i < s.tree.bodies; ++i) {
    JointJet<T>& last = s.own_last_target()[i];
    Deviation<T>& d = s.deviation[i];
    // Of what only falls nobody asks where its animation was.
    const bool asked = !s.deferred.deviations || s.tree.dof_count(i) == 0;
    const bool elsewhere = asked && (last.rotation.coeffs() != s.local[i].rotation.coeffs() ||
                                     last.translation != s.local[i].translation);
    const bool deviates = !same_bits(d.offset, none) || !same_bits(d.rate, none);
    s.baked[i] =
        static_cast<std::uint8_t>((d.on_animation ? kOnAnimation : 0) + (d.released ? kReleased : 0) +
                                  (elsewhere ? kElsewhere : 0) + (deviates ? kDeviates : 0));
    const std::uint32_t before = flags;
    flags = s.baked[i];
    coder.value(flags, before);
    if (!stream.reading()) continue;
    s.baked[i] = static_cast<std::uint8_t>(flags);
    d = {};
    d.on_animation = (s.baked[i] & kOnAnimation) != 0;
    d.released = (s.baked[i] & kReleased) != 0;
    last.rotation = s.local[i].rotation;
    last.translation = s.local[i].translation;
  }
}

template <class T>
void visit_joints(CharacterState<T>& s, ByteStream& stream) {
  const auto visit = [&](const char* name, std::uint8_t flag, auto visit_joint) {
    ResidualCoder<T> coder(name, stream, flag == kElsewhere);
    for (int i = 0; i < s.tree.bodies; ++i)
      if (stream.bounding() || flag == 0 || (s.baked[i] & flag) != 0) visit_joint(coder, i);
  };
  const auto dofs = [&](ResidualCoder<T>& coder, int i, std::array<T, 6>& values,
                        const std::array<T, 6>& predicted) {
    for (int k = 0; k < s.tree.dof_count(i); ++k) coder.value(values[k], predicted[k]);
  };
  visit_flags(s, stream);
  visit("last target's rotation", kElsewhere, [&](auto& coder, int i) {
    for (int n = 0; n < 3; ++n)
      coder.value(s.own_last_target()[i].rotation.coeffs()[n], s.local[i].rotation.coeffs()[n]);
  });
  visit("last target's rotation's last member", kElsewhere, [&](auto& coder, int i) {
    Quat<T>& last = s.own_last_target()[i].rotation;
    coder.value(last.w(), last_of(last, s.local[i].rotation));
  });
  visit("last target's translation", kElsewhere, [&](auto& coder, int i) {
    coder.values(s.own_last_target()[i].translation, s.local[i].translation);
  });
  stream.value("span of the joint speeds", s.rate_step);
  ResidualCoder<T>("joint speed", stream).unpredicted([&](const auto& visit_number) {
    for (int i = 0; i < s.tree.bodies; ++i)
      for (int k = 0; k < s.tree.dof_count(i); ++k) visit_number(s.rate[i][k], T(0));
  });
  // The next step's guess looks further back only while nothing changes.
  if (stream.part("joint speeds change steadily",
                  s.rate_step > T(0) && s.steps_unchanged >= kUnchangedSteps)) {
    ResidualCoder<T> coder("joint speed before", stream, false, kHalfOfDigits<T>);
    for (int i = 0; i < s.tree.bodies; ++i) dofs(coder, i, s.rate_before[i], s.rate[i]);
  }
  visit("deviation", kDeviates, [&](auto& coder, int i) {
    const JointJet<T>& last = s.own_last_target()[i];
    dofs(coder, i, s.deviation[i].offset,
         joint_offset_value<T>(s.tree, i, {last.rotation, last.translation}, s.local[i]));
  });
  visit("deviation's rate", kDeviates, [&](auto& coder, int i) {
    // As if the target had stood still.
    std::array<T, 6> back = s.rate[i];
    for (T& r : back) r *= -s.rate_step;
    const JointJet<T>& last = s.own_last_target()[i];
    std::array<T, 6> rate = joint_offset_value<T>(s.tree, i, {last.rotation, last.translation},
                                                  at_offset<T>(s.tree, i, s.local[i], back));
    for (int k = 0; k < 6; ++k)
      rate[k] = s.rate_step > T(0) ? (s.deviation[i].offset[k] - rate[k]) / s.rate_step : T(0);
    dofs(coder, i, s.deviation[i].rate, rate);
  });
  ResidualCoder<T> coder("load", stream, true);
  T before = T(0);  // none, or saturated like the one before
  for (T& load : s.load) {
    coder.value(load, before);
    before = load;
  }
}

/// How the animation moved at the end of the last step, for parts of the next one: what is on it moves so.
template <class T>
void visit_last_speeds(CharacterState<T>& s, ByteStream& stream) {
  if (s.deferred.deviations && !stream.bounding()) return;  // what only falls follows none
  const History<T>& h = s.history;
  const auto spin = [&](int body) {
    const Mat3<T>& r = h.rotation[body];
    return Vec3<T>(s.tree.inverse_inertia[body] * (r.transpose() * h.momentum[body]));  // body axes
  };
  {
    ResidualCoder<T> coder("last target's velocity", stream, true);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const int parent = s.tree.parent[i];
      const Quat<T> inward = s.local[i].rotation.conjugate();
      const Vec3<T> carried = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : Vec3<T>(inward * spin(parent));
      coder.values(s.own_last_target()[i].omega, Vec3<T>(spin(i) - carried));
      coder.values(s.own_last_target()[i].velocity, Vec3<T>(Vec3<T>::Zero()));
    }
  }
  if (!stream.part("muscles with a tone were asked for", s.problem.law.present.tone)) return;
  ResidualCoder<T> coder("last target's acceleration", stream, true);
  for (int i = 0; i < s.tree.bodies; ++i) {
    coder.values(s.own_last_target()[i].alpha, Vec3<T>(Vec3<T>::Zero()));
    coder.values(s.own_last_target()[i].acceleration, Vec3<T>(Vec3<T>::Zero()));
  }
}

/// Stiffnesses that were asked for.
template <class T>
void visit_tone(CharacterState<T>& s, ByteStream& stream) {
  std::vector<ToneOfDof<T>>& tone = s.problem.law.tone;
  if (stream.part("has a tone", s.problem.law.present.tone)) {
    if (stream.reading()) reserve_for_tone(s);
    ResidualCoder<T> coder("tone", stream);  // mostly that of the joint before
    ToneOfDof<T> before;
    before.stiffness = T(0);
    ToneOfDof<T> later;  // that may be asked for until the snapshot is taken
    const std::size_t count = stream.bounding() ? static_cast<std::size_t>(s.tree.dofs) : tone.size();
    for (std::size_t dof = 0; dof < count; ++dof) {
      ToneOfDof<T>& of = stream.bounding() ? later : tone[dof];
      coder.value(of.stiffness, before.stiffness);
      coder.value(of.damping_ratio, before.damping_ratio);
      before = of;
    }
  } else if (stream.reading()) {
    std::fill(tone.begin(), tone.end(), ToneOfDof<T>{});
  }
  if (stream.reading()) s.problem.law.refresh_presence();
}

}  // namespace

template <class T>
void visit_state(CharacterState<T>& s, ByteStream& stream) {
  constexpr std::uint8_t kDisplaced = 0x80, kMeetsItself = 0x40, kPassesItself = 0x20, kDrive = 0x1f;
  std::uint8_t root = static_cast<std::uint8_t>(s.settings.root) |
                      (s.grounding.by.any() ? kDisplaced : std::uint8_t{0}) |
                      (s.self_collision == SelfCollision::kOn ? kMeetsItself : std::uint8_t{0}) |
                      (s.self_collision == SelfCollision::kOff ? kPassesItself : std::uint8_t{0});
  stream.value("root drive", root);
  const bool displaced = (root & kDisplaced) != 0;
  if (stream.reading())
    s.self_collision = (root & kMeetsItself) != 0    ? SelfCollision::kOn
                       : (root & kPassesItself) != 0 ? SelfCollision::kOff
                                                     : SelfCollision::kAsCreated;
  root &= kDrive;
  stream.flag("out of the world", s.parked);
  if (stream.reading() && root <= static_cast<std::uint8_t>(RootDrive::kGrounded))
    s.settings.root = static_cast<RootDrive>(root);
  stream.value("strength", s.settings.strength);
  if (stream.reading()) s.grounding = {};
  visit_tone(s, stream);
  if (s.grounded() || displaced || s.problem.law.present.tone || stream.bounding()) {
    stream.value("displaced along x", s.grounding.by.x);
    stream.value("displaced along y", s.grounding.by.y);
    stream.value("displaced about z", s.grounding.by.yaw);
    stream.value("displaced along z", s.grounding.by.z);
    stream.value("stands as it should", s.grounding.rest);
    stream.value("nothing has acted", s.grounding.alone);
    stream.value("help, N", s.grounding.help_force);
    stream.value("help, N·m", s.grounding.help_torque);
    stream.value("height of what it stood on", s.grounding.level);
    stream.flag("next to its animation", s.grounding.returns);
  }
  const auto visit_strengths = [&](const char* name, std::vector<T>& strengths) {
    const bool some = std::any_of(strengths.begin(), strengths.end(), [](T x) { return x != T(1); });
    if (stream.part("has strengths of its own", some))
      stream.array(name, strengths.data(), strengths.size());
    else if (stream.reading())
      std::fill(strengths.begin(), strengths.end(), T(1));
  };
  visit_strengths("strength of a joint", s.joint_strength);
  visit_strengths("strength of a muscle", s.muscle_strength);
  visit_strengths("activation of a joint", s.activation);
  stream.value("contacts that touched", s.contact_signature);
  stream.value("steps with the same contacts", s.steps_unchanged);
  {
    constexpr int kSuspended = 64;  // more than there are; the rest of the byte was 0 in snapshots of before
    auto both = static_cast<std::uint8_t>(s.collision_suspended + kSuspended * s.unsolved);
    stream.value("steps of suspended collision, and unsolved ones", both);
    s.collision_suspended = static_cast<std::uint8_t>(both % kSuspended);
    s.unsolved = static_cast<std::uint8_t>(both / kSuspended);
  }
  stream.value("energy ceiling", s.energy_ceiling);
  {
    ResidualCoder<double> coder("energy lent by surfaces, stored energy", stream, true);
    coder.value(s.depenetration_energy, 0);
    coder.value(s.report.elastic_energy, 0);
  }
  {
    ResidualCoder<std::uint64_t> coder("limits that bore", stream, true);
    coder.value(s.limit_signature, 0);
  }
  visit_levels(s, stream);
  visit_pose(s, stream);
  visit_joints(s, stream);
  visit_history(s, stream);
  visit_last_speeds(s, stream);
  if (!stream.reading()) return;
  s.clear_deviations();
  s.impulses.clear();
  s.forces.clear();
  s.refresh_limits();
  s.pose_changed();
}

/// Impulses, or forces.
template <class T>
void visit_pushes(const CharacterState<T>& s, std::vector<ExternalForce<T>>& pushes, ByteStream& stream) {
  std::uint32_t count = static_cast<std::uint32_t>(pushes.size());
  stream.value("number of impulses or forces", count);
  if (stream.reading()) pushes.resize(std::min<std::size_t>(count, pushes.capacity()));
  for (ExternalForce<T>& push : pushes) {
    stream.value("its body", push.body);
    if (stream.reading()) push.body = std::clamp(push.body, 0, s.tree.bodies - 1);
    stream.vector("its point", push.local);
    stream.vector("impulse or force", push.force);
  }
}

template <class T>
void visit_inputs(CharacterState<T>& s, ByteStream& stream) {
  s.own_last_target();
  stream.flag("comes back", s.grounding.comes_back);
  stream.flag("rides", s.grounding.rides);
  stream.flag("has a hand", s.grounding.has_hand);
  stream.value("presses, m", s.grounding.presses);
  for (JointJet<T>& jet : s.target) {
    stream.rotation("target rotation", jet.rotation);
    stream.vector("target angular velocity", jet.omega);
    stream.vector("target angular acceleration", jet.alpha);
    stream.vector("target translation", jet.translation);
    stream.vector("target velocity", jet.velocity);
    stream.vector("target acceleration", jet.acceleration);
  }
  visit_pushes(s, s.impulses, stream);
  visit_pushes(s, s.forces, stream);
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

/// Of a world's make-up: scalar, states, their joints and what poses are predicted from, which loops close
/// slowly. Bytes fit worlds of the same make-up.
template <class T>
std::uint64_t layout_of(const MovingParts<T>& world) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  std::uint64_t hash = 0xcbf29ce484222325ull;
  const auto add = [&](std::uint64_t x) { hash = (hash ^ x) * 0x100000001b3ull; };
  const auto add_numbers = [&](const auto& numbers) {
    for (const T x : numbers.reshaped()) add(Eigen::numext::bit_cast<Bits>(x));
  };
  add(sizeof(T));
  for (const auto& s : world.states) {
    add(s->local.size());
    add(s->muscle_strength.size());
    for (const JointType type : s->tree.type) add(static_cast<std::uint64_t>(type));
    for (std::size_t i = 0; i < s->local.size(); ++i) {
      const Transform<T> predicted = predicted_pose(*s, i);
      add_numbers(predicted.rotation.coeffs());
      add_numbers(predicted.translation);
    }
  }
  for (const auto& c : world.couplings) {
    add(c->stencils.size());
    add(c->closes_slowly ? 1 : 0);
  }
  for (const auto& bytes : world.games) add(bytes.size());
  return hash;
}

template <class T>
void visit_lagged(std::vector<LaggedForce<T>>& lagged, ByteStream& stream) {
  std::uint32_t count = static_cast<std::uint32_t>(lagged.size());
  stream.value("number of contact forces", count);
  // Whoever saved may have had more room; each takes more than a byte.
  if (stream.reading())
    lagged.resize(std::min<std::size_t>(count, std::max(lagged.capacity(), stream.left())));
  // An identity in three parts of 45 bits, eight numbers and at most three bytes more each.
  if (stream.bounding()) return stream.reserve_capacity(lagged.capacity() * (17 + 8 * (sizeof(T) + 3)));
  {
    ResidualCoder<std::uint32_t> coder("contact", stream, true);
    std::array<std::uint32_t, 3> before{};
    for (LaggedForce<T>& contact : lagged) {
      std::array<std::uint32_t, 3> parts = {static_cast<std::uint32_t>(contact.id >> 32),
                                            static_cast<std::uint32_t>(contact.id >> 16) & 0xffffu,
                                            static_cast<std::uint32_t>(contact.id) & 0xffffu};
      for (int n = 0; n < 3; ++n) coder.value(parts[n], before[n]);
      if (stream.reading()) contact.id = std::uint64_t(parts[0]) << 32 | parts[1] << 16 | parts[2];
      before = parts;
    }
  }
  const auto visit = [&](const char* name, auto visit_contact, int rounded = 0) {
    ResidualCoder<T> coder(name, stream, true, rounded);
    T before = T(0);
    for (LaggedForce<T>& contact : lagged) {
      [[maybe_unused]] auto& [id, force, stiffness, offset, smooth, lasting, earlier, elastic] =
          contact;  // a new member will not compile here
      visit_contact(coder, contact, before);
    }
  };
  ResidualCoder<T>("contact force", stream, true).unpredicted([&](const auto& visit_number) {
    for (LaggedForce<T>& contact : lagged) visit_number(contact.force, T(0));
  });
  visit("contact stiffness", [](auto& coder, auto& c, T& before) {
    coder.value(c.stiffness, before);
    before = c.stiffness;
  });
  visit("contact offset", [](auto& coder, auto& c, T&) { coder.value(c.offset, T(0)); });
  visit(
      "lasting contact force", [](auto& coder, auto& c, T&) { coder.value(c.lasting, c.force); },
      kHalfOfDigits<T>);
  visit(
      "contact force before", [](auto& coder, auto& c, T&) { coder.value(c.before, c.lasting); },
      kHalfOfDigits<T>);
  // All of it, or what has lasted.
  visit("smooth contact force",
        [](auto& coder, auto& c, T&) { coder.value(c.smooth, std::min(c.force, c.lasting)); });
  visit(
      "elastic slip",
      [](auto& coder, auto& c, T&) {
        for (T& e : c.elastic) coder.value(e, T(0));
      },
      kHalfOfDigits<T>);
}

void visit_budget(BudgetState& budget, ByteStream& stream) {
  stream.value("forecast of the cost", budget.forecast);
  stream.value("cost of a unit of work", budget.scale);
  stream.value("steps above the budget", budget.over);
  stream.value("steps below it", budget.under);
}

template <class T>
void visit_coupling(Coupling<T>& coupling, ByteStream& stream) {
  stream.flag("loop is closed", coupling.active);
  if (!coupling.closes_slowly) return;
  for (Stencil<T>& e : coupling.stencils) {
    stream.vector("what is left open of a loop", e.offset);
    stream.vector("smooth part of a loop's pull", e.carried.smooth);
    stream.vector("a loop's pull, if it lasts", e.carried.last);
    stream.vector("the same a step before", e.carried.before);
  }
}

/// What belongs to nobody.
template <class T>
void visit_world(const MovingParts<T>& world, ByteStream& stream) {
  visit_budget(world.budget, stream);
  for (const auto& c : world.couplings) visit_coupling(*c, stream);
  visit_lagged(world.lagged, stream);
  for (const std::span<std::byte> bytes : world.games)
    stream.array("the game's own bytes", reinterpret_cast<unsigned char*>(bytes.data()), bytes.size());
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
  if (content == Content::kInputs)
    for (const auto& s : world.states)
      for (const auto* v : {&s->impulses, &s->forces})
        room += (v->capacity() - v->size()) * (sizeof(int) + 6 * sizeof(T));
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
