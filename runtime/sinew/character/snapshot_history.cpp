#include "sinew/character/snapshot_history.h"

#include <algorithm>

#include "sinew/character/residual_coder.h"
#include "sinew/optimizer/bossak.h"

namespace sinew {
namespace {

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

/// body → world as the step computes it from a local pose and the parent's.
template <class T>
Mat3<T> rotation_of(const std::vector<Transform<T>>& local, const Tree<T>& tree, int body,
                    const std::vector<Mat3<T>>& rotation) {
  const Mat3<T> relative = local[body].rotation.toRotationMatrix();
  if (tree.parent[body] < 0) return relative;
  Mat3<T> product;
  product.noalias() = rotation[tree.parent[body]] * relative;
  return product;
}

/// Where the last step began. Its rotations are kept in the problem, for they give those of the bodies to the
/// bit.
template <class T>
void visit_pose_before(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  const auto visit = [&](const char* name, auto visit_body) {
    ResidualCoder<T> coder(name, stream);
    for (int i = 0; i < s.tree.bodies; ++i) visit_body(coder, i);
  };
  visit("pose rotation before", [&](auto& coder, int i) {
    for (int n = 0; n < 3; ++n)
      coder.value(s.problem.start[i].rotation.coeffs()[n], s.wanted[i].rotation.coeffs()[n]);
  });
  visit("pose rotation before, last member", [&](auto& coder, int i) {
    Quat<T>& rotation = s.problem.start[i].rotation;
    coder.value(rotation.w(), last_of(rotation, s.wanted[i].rotation));
    s.wanted[i].rotation = rotation;
  });
  visit("rotation before", [&](auto& coder, int i) {
    coder.values(h.rotation_before[i], rotation_of(s.wanted, s.tree, i, h.rotation_before));
  });
  forward_kinematics<T>(s.tree, s.wanted, s.local[0].translation, s.guessed);
  visit("centre of mass before",
        [&](auto& coder, int i) { coder.values(h.center_before[i], s.guessed.center[i]); });
}

/// Angular momentum of a body that turns at `rate`.
template <class T>
Vec3<T> momentum_of(const Mat3<T>& inertia, const Mat3<T>& rotation, const Mat3<T>& rate) {
  const Mat3<T> spin = rate * rotation.transpose();
  const Vec3<T> omega(spin(2, 1) - spin(1, 2), spin(0, 2) - spin(2, 0), spin(1, 0) - spin(0, 1));
  return rotation * (inertia * (rotation.transpose() * omega)) / 2;
}

/// Where bodies are at the pose, in order and as far as they are known to the bit.
template <class T>
void visit_places(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  {
    ResidualCoder<T> coder("rotation", stream);
    for (int i = 0; i < s.tree.bodies; ++i)
      coder.values(h.rotation[i], rotation_of(s.local, s.tree, i, h.rotation));
  }
  ResidualCoder<T> coder("centre of mass", stream);
  std::copy_n(s.local.begin(), s.tree.bodies, s.wanted.begin());
  forward_kinematics<T>(s.tree, s.wanted, s.local[0].translation, s.guessed);
  for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.center[i], s.guessed.center[i]);
}

/// Velocities as the scheme has them of places now, before (`known`: the history's, else as the joints'
/// speeds have it) and, kept in `guessed`, a step before that.
template <class T>
void visit_velocities(CharacterState<T>& s, bool known, ByteStream& stream) {
  History<T>& h = s.history;
  const T step = s.rate_step > T(0) ? s.rate_step : T(1);
  const bool second = known && h.scheme == Scheme::kBdf2;
  const T w = second && s.rate_step_before > T(0) ? step / s.rate_step_before : T(1);
  const T k1 = second ? (1 + 2 * w) / (1 + w) : T(1), k2 = second ? w * w / (1 + w) : T(0);
  {
    ResidualCoder<T> coder("velocity", stream);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Vec3<T>& guess = s.guessed.center[i];
      const Vec3<T>& before = known ? h.center_before[i] : guess;
      const Vec3<T> velocity = (k1 * (h.center[i] - before) - k2 * (before - guess)) / step;
      const Vec3<T> pushed = velocity + h.changed.push;
      coder.values(h.velocity[i], Vec3<T>(pushed + h.changed.faster(h.center[i], pushed)));
    }
  }
  {
    ResidualCoder<T> coder("rotation rate", stream);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Mat3<T>& guess = s.guessed.rotation[i];
      const Mat3<T>& before = known ? h.rotation_before[i] : guess;
      const Mat3<T> rate = (k1 * (h.rotation[i] - before) - k2 * (before - guess)) / step;
      coder.values(h.rotation_rate[i], Mat3<T>(rate + h.changed.faster(h.rotation[i], rate)));
    }
  }
  ResidualCoder<T> coder("angular momentum", stream);
  for (int i = 0; i < s.tree.bodies; ++i)
    coder.values(h.momentum[i], momentum_of(s.tree.inertia[i], h.rotation[i], h.rotation_rate[i]));
}

/// What Bossak's scheme carries: velocities as the joints' rates have them, accelerations, and what of the
/// joints' rows has lasted.
template <class T>
void visit_one_step(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  std::uint8_t known = h.accelerates ? 1 : 0;
  stream.value("accelerations are known", known);
  if (stream.reading()) h.accelerates = known != 0;
  const auto visit = [&](const char* name, bool marks, auto visit_body) {
    ResidualCoder<T> coder(name, stream, marks);
    for (int i = 0; i < s.tree.bodies; ++i) visit_body(coder, i);
  };
  // As EndVelocities moves the bodies, at the pose that visit_places left.
  const Kinematics<T>& k = s.guessed;
  std::vector<Vec3<T>>&spin = s.problem.moment, &slide = s.problem.force;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int parent = s.tree.parent[i], first = s.tree.first_dof[i];
    spin[i] = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : spin[parent];
    slide[i] = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : slide[parent];
    std::array<T, 6> rate = s.rate[i];
    if (s.tree.type[i] == JointType::kFree) {
      const Vec3<T> turned = s.local[i].rotation * Vec3<T>(rate[3], rate[4], rate[5]);
      for (int a = 0; a < 3; ++a) rate[3 + a] = turned[a];
    }
    for (int dof = first; dof < s.tree.first_dof[i + 1]; ++dof) {
      spin[i] += rate[dof - first] * k.w[dof];
      slide[i] += rate[dof - first] * k.v[dof];
    }
  }
  visit("velocity", false, [&](auto& coder, int i) {
    coder.values(h.velocity[i], Vec3<T>(slide[i] + spin[i].cross(h.center[i])));
  });
  visit("angular momentum", true, [&](auto& coder, int i) {
    const Mat3<T>& r = h.rotation[i];
    coder.values(h.momentum[i], Vec3<T>(r * (s.tree.inertia[i] * (r.transpose() * spin[i]))));
  });
  visit("rotation rate", true, [&](auto& coder, int i) {
    coder.values(h.rotation_rate[i], rotation_rate_of<T>(s.tree, i, h.rotation[i], h.momentum[i]));
  });
  visit("acceleration", false, [&](auto& coder, int i) {
    coder.values(h.acceleration[i], i > 0 ? h.acceleration[i - 1] : Vec3<T>(Vec3<T>::Zero()));
    coder.values(h.torque[i], Vec3<T>(Vec3<T>::Zero()));
  });
  ResidualCoder<T> coder("what of a joint's rows lasts", stream);
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    coder.value(s.smooth[dof], T(0));
    coder.value(s.lasting[dof], s.smooth[dof]);
    coder.value(s.lasting_before[dof], s.lasting[dof]);
  }
}

}  // namespace

template <class T>
void visit_history(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  const Vec3<double> rounded = s.local[0].translation.template cast<double>();
  {
    ResidualCoder<double> coder("place", stream);
    coder.values(h.place, rounded);
  }
  stream.value("span of the history", h.step_before);
  std::uint8_t scheme = static_cast<std::uint8_t>(h.scheme);
  stream.value("scheme", scheme);
  if (stream.reading())
    h.scheme = static_cast<Scheme>(std::min(scheme, static_cast<std::uint8_t>(Scheme::kBossak)));
  const bool one_step = stream.part("accelerations are carried", s.one_step);
  if (stream.reading()) s.one_step = one_step;
  if (stream.part("changed after the solve", !one_step && !h.changed.none())) {
    MotionChange<T>& c = h.changed;
    stream.value("what it was scaled by", c.factor);
    for (Vec3<T>* v : {&c.push, &c.center, &c.velocity, &c.spin, &c.turn})
      stream.array("how it was changed", v->data(), 3);
  } else {
    h.changed = {};
  }
  visit_places(s, stream);
  if (one_step) visit_one_step(s, stream);
  if (one_step && !stream.bounding()) return;
  step_back<T>(s, s.rate, s.rate_step / h.changed.factor, s.wanted, s.guessed);
  const bool known = stream.part("contacts have been the same", s.steps_unchanged > 0);
  if (known) {
    visit_pose_before(s, stream);
    step_back<T>(s, s.rate_before, s.rate_step_before, s.wanted, s.guessed);
  }
  visit_velocities(s, known, stream);
  if (!known) return;
  {
    ResidualCoder<T> coder("velocity before", stream);
    const T step = s.rate_step_before > T(0) ? s.rate_step_before : T(1);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Vec3<T> faster = h.changed.scaled(h.center[i], h.velocity[i]) / h.changed.factor;
      coder.values(h.velocity_before[i], Vec3<T>((h.center_before[i] - s.guessed.center[i]) / step + faster));
    }
  }
  ResidualCoder<T> coder("angular momentum before", stream);
  for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.momentum_before[i], h.momentum[i]);
}

template void visit_history<float>(CharacterState<float>&, ByteStream&);
template void visit_history<double>(CharacterState<double>&, ByteStream&);

}  // namespace sinew
