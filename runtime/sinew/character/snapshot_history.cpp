#include "sinew/character/snapshot_history.h"

#include <algorithm>

#include "sinew/character/residual_coder.h"
#include "sinew/optimizer/bossak.h"

namespace sinew {
namespace {

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

/// Where bodies are at the pose, in order and as far as they are known to the bit.
template <class T>
void visit_places(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  {
    ResidualCoder<T> coder("rotation", stream, true);
    for (int i = 0; i < s.tree.bodies; ++i)
      coder.values(h.rotation[i], rotation_of(s.local, s.tree, i, h.rotation));
  }
  ResidualCoder<T> coder("centre of mass", stream);
  std::copy_n(s.local.begin(), s.tree.bodies, s.wanted.begin());
  forward_kinematics<T>(s.tree, s.wanted, s.local[0].translation, s.guessed);
  for (int i = 0; i < s.tree.bodies; ++i) coder.values(h.center[i], s.guessed.center[i]);
}

/// Velocities as the joints' rates have them, accelerations, and what of the joints' rows has lasted.
template <class T>
void visit_motion(CharacterState<T>& s, ByteStream& stream) {
  History<T>& h = s.history;
  stream.flag("accelerations are known", h.accelerates);
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
  const auto visit_whole = [&](const char* name, std::vector<Vec3<T>>& all) {
    ResidualCoder<T>(name, stream).unpredicted([&](const auto& visit_number) {
      for (int i = 0; i < s.tree.bodies; ++i)
        for (T& x : all[i]) visit_number(x, T(0));
    });
  };
  visit_whole("acceleration", h.acceleration);
  visit_whole("torque", h.torque);
  ResidualCoder<T> coder("what of a joint's rows lasts", stream, true);
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
  visit_places(s, stream);
  visit_motion(s, stream);
}

template void visit_history<float>(CharacterState<float>&, ByteStream&);
template void visit_history<double>(CharacterState<double>&, ByteStream&);

}  // namespace sinew
