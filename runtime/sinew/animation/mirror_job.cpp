#include "sinew/animation/mirror_job.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/side_names.h"

namespace sinew {
namespace {

constexpr double kTolerance =
    0.01;  ///< of the skeleton's size: as far as a pair may be from its mirror image
constexpr int kOpen = -2, kNone = -1;

Quat<double> mirrored(const Quat<double>& q) {
  return {q.w(), -q.x(), q.y(), -q.z()};
}
Role mirrored(Role role) {
  const int r = static_cast<int>(role), first = static_cast<int>(Role::kClavicleL);
  return r < first ? role : static_cast<Role>(first + ((r - first) ^ 1));
}
bool is_middle(Role role) {
  return role != Role::kNone && mirrored(role) == role;
}

/// The search for partners: kOpen until a joint has one, kNone where it stays without.
class Pairing {
 public:
  explicit Pairing(const Skeleton& skeleton) : skeleton_(skeleton), partners_(count(), kOpen) {
    for (const Joint& joint : skeleton.joints) {
      names_.push_back(joint.name);
      rest_.push_back(joint.parent < 0 ? joint.rest : rest_[std::size_t(joint.parent)] * joint.rest);
    }
    Vec3<double> low = rest_[0].translation, high = low;
    for (const Transform<double>& r : rest_) {
      low = low.cwiseMin(r.translation);
      high = high.cwiseMax(r.translation);
    }
    allowed_ = kTolerance * (high - low).maxCoeff();
  }

  std::vector<int> find() {
    for (int i = 0; i < int(count()); ++i) by_name(i);
    for (int i = 0; i < int(count()); ++i) by_role(i);
    for (int i = 0; i < int(count()); ++i) by_place(i);
    while (part_what_hangs_apart()) {
    }
    return partners_;
  }
  const std::vector<Transform<double>>& rest() const { return rest_; }

  /// m, between a joint and the mirror image of another: about the plane through the root.
  double apart(int i, int j) const {
    Vec3<double> image = rest_[std::size_t(j)].translation;
    image.y() = 2 * rest_[0].translation.y() - image.y();
    return (rest_[std::size_t(i)].translation - image).norm();
  }
  bool near(int i, int j) const { return apart(i, j) <= allowed_; }

 private:
  std::size_t count() const { return skeleton_.joints.size(); }
  int parent(int i) const { return skeleton_.joints[std::size_t(i)].parent; }
  Role role(int i) const { return skeleton_.joints[std::size_t(i)].role; }
  int& partner(int i) { return partners_[std::size_t(i)]; }
  bool open(int i) const { return partners_[std::size_t(i)] == kOpen; }
  void pair(int i, int j) {
    partner(i) = j;
    partner(j) = i;
  }
  bool hang_together(int i, int j) const {
    const int above = parent(i);
    return above < 0 ? parent(j) < 0 : partners_[std::size_t(above)] == parent(j);
  }

  void by_name(int i) {
    const int j = find_mirrored(names_, i);
    if (j >= 0 && open(i) && open(j) && find_mirrored(names_, j) == i) pair(i, j);
  }
  void by_role(int i) {
    const Role own = role(i), other = mirrored(own);
    if (own == other || !open(i)) return;
    const auto only = [&](Role wanted) {
      int found = kNone;
      for (int j = 0; j < int(count()); ++j)
        if (role(j) == wanted) found = found == kNone ? j : kOpen;
      return found;
    };
    const int j = only(other);
    if (only(own) == i && j >= 0 && open(j)) pair(i, j);
  }
  /// In the middle, or the only one on the other side. Parents have theirs by now.
  void by_place(int i) {
    if (!open(i)) return;
    const bool sideless = mirrored_name(names_[std::size_t(i)]) == names_[std::size_t(i)];
    if (hang_together(i, i) && sideless && (near(i, i) || is_middle(role(i)))) return pair(i, i);
    int found = kNone;
    for (int j = i + 1; j < int(count()); ++j)
      if (open(j) && hang_together(i, j) && near(i, j)) found = found == kNone ? j : kOpen;
    if (found >= 0)
      pair(i, found);
    else
      partner(i) = kNone;
  }
  bool part_what_hangs_apart() {
    bool parted = false;
    for (int i = 0; i < int(count()); ++i) {
      const int j = partner(i);
      if (j < 0 || hang_together(i, j)) continue;
      partner(i) = partner(j) = kNone;
      parted = true;
    }
    return parted;
  }

  const Skeleton& skeleton_;
  std::vector<std::string> names_;
  std::vector<Transform<double>> rest_;  ///< joint → model
  std::vector<int> partners_;
  double allowed_ = 0;  ///< m
};

/// x y z w of a·μ(q)·b from those of q.
Eigen::Matrix4d mirrored_between(const Quat<double>& a, const Quat<double>& b) {
  Eigen::Matrix4d m;
  for (int k = 0; k < 4; ++k) {
    Quat<double> unit(0, 0, 0, 0);
    unit.coeffs()[k] = 1;
    m.col(k) = (a * mirrored(unit) * b).coeffs();
  }
  return m;
}

template <class T>
MirrorJoint<T> mirror_joint(const Quat<double>& before, const Quat<double>& after,
                            const Transform<double>& own_rest, const Transform<double>& partner_rest) {
  const Mat3<double> mirror = Vec3<double>(1, -1, 1).asDiagonal().toDenseMatrix();
  const Mat3<double> move = before.toRotationMatrix() * mirror;
  const Mat3<double> spin = -(after.conjugate().toRotationMatrix() * mirror);
  const Vec3<double> shift = own_rest.translation - move * partner_rest.translation;
  return {mirrored_between(before, after).cast<T>(), spin.cast<T>(), move.cast<T>(), shift.cast<T>()};
}

Status check(const Skeleton& skeleton) {
  if (skeleton.joints.empty() || skeleton.joints.size() >= kNoPartner)
    return Status::error(Code::kInvalidArgument, "no joints, or more than a map can hold");
  for (int i = 0; i < int(skeleton.joints.size()); ++i) {
    const Joint& joint = skeleton.joints[std::size_t(i)];
    if (joint.parent < -1 || joint.parent >= i)
      return Status::error(Code::kInvalidArgument, "parent does not come before its joint", i);
    if (!joint.rest.translation.allFinite() || !joint.rest.rotation.coeffs().allFinite())
      return Status::error(Code::kNotFinite, "rest is not finite", i);
  }
  return {};
}

template <class T>
JointJet<T> mirrored(const MirrorJoint<T>& map, const JointJet<T>& jet) {
  JointJet<T> out;
  out.rotation.coeffs() = map.turn * jet.rotation.coeffs();
  out.omega = map.spin * jet.omega;
  out.alpha = map.spin * jet.alpha;
  out.translation = map.move * jet.translation + map.shift;
  out.velocity = map.move * jet.velocity;
  out.acceleration = map.move * jet.acceleration;
  return out;
}

}  // namespace

template <class T>
Status build_mirror_map(const Skeleton& skeleton, MirrorMap<T>& out, std::vector<MirrorWarning>* warnings) {
  if (Status status = check(skeleton); !status) return status;
  Pairing pairing(skeleton);
  const std::vector<int> partners = pairing.find();
  const int count = int(partners.size());
  const auto axes = [&](int i) {  // C_i
    const int j = i < 0 ? kNone : partners[std::size_t(i)];
    if (j < 0) return Quat<double>(Quat<double>::Identity());
    return Quat<double>(mirrored(pairing.rest()[std::size_t(j)].rotation).conjugate() *
                        pairing.rest()[std::size_t(i)].rotation);
  };
  out.partners.assign(partners.size(), kNoPartner);
  out.joints.assign(partners.size(), {});
  for (int i = 0; i < count; ++i) {
    const int j = partners[std::size_t(i)];
    const Joint& joint = skeleton.joints[std::size_t(i)];
    if (j >= 0) {
      out.partners[std::size_t(i)] = static_cast<std::uint16_t>(j);
      out.joints[std::size_t(i)] = mirror_joint<T>(axes(joint.parent).conjugate(), axes(i), joint.rest,
                                                   skeleton.joints[std::size_t(j)].rest);
    }
    if (!warnings) continue;
    if (j < 0)
      warnings->push_back({i, "no partner on the other side: keeps its own motion"});
    else if (!pairing.near(i, j))
      warnings->push_back({i, "rest is not the mirror image of its partner's"});
  }
  return {};
}

template <class T>
Status MirrorJob<T>::Validate() const {
  if (!map) return Status::error(Code::kInvalidArgument, "no map");
  if (map->joints.size() != map->partners.size())
    return Status::error(Code::kInvalidArgument, "map is not one of build_mirror_map");
  if (jets.size() < map->partners.size() || out.size() > map->partners.size())
    return Status::error(Code::kInvalidArgument, "fewer joints than the map, or more in the output");
  return {};
}

template <class T>
Status MirrorJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t j = map->partners[i];
    if (j == kNoPartner) {
      out[i] = jets[i];
    } else if (j >= i) {  // both of a pair at once: `out` may be `jets`
      const JointJet<T> own = jets[i], partner = jets[j];
      out[i] = mirrored(map->joints[i], partner);
      if (j > i && j < out.size()) out[j] = mirrored(map->joints[j], own);
    }
  }
  return {};
}

SINEW_MIRROR_INSTANCES(, float)
SINEW_MIRROR_INSTANCES(, double)

}  // namespace sinew
