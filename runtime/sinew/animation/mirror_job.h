// Left and right exchanged: one clip for both sides.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// A joint without a partner, in MirrorMap::partners.
constexpr std::uint16_t kNoPartner = 0xffff;

/// How one joint follows from its partner: linear maps of the numbers of its jet.
template <class T>
struct MirrorJoint {
  Eigen::Matrix<T, 4, 4> turn;  ///< x y z w of the partner's rotation → of the joint's
  Mat3<T> spin;                 ///< of ω and α, which are axial: a mirror keeps their part across its plane
  Mat3<T> move;                 ///< of translation, velocity, acceleration
  Vec3<T> shift;                ///< m, added to the translation
};

/// Which joint takes whose place, and how. Shared by all characters of a skeleton.
template <class T>
struct MirrorMap {
  std::vector<std::uint16_t> partners;  ///< [joint]; itself in the middle; kNoPartner: keeps its local motion
  std::vector<MirrorJoint<T>> joints;   ///< [joint]
};

/// What a mirrored motion of this skeleton will lack.
struct MirrorWarning {
  int joint = -1;           ///< of the skeleton
  const char* reason = "";  ///< a string literal
};

/// Finds partners by name (see `mirrored_name`), by role, or, where neither says anything, by place: within
/// 1 % of the skeleton's size of the mirrored one. Both of a pair have to hang on partners. A joint without a
/// side that lies in the middle is its own partner.
///
/// The plane is y = 0 of the root's parent. A mirrored motion is the same motion away from rest: joint i of
/// rest rotations G (model space) turns as G_i' = μ(G_m(i))·C_i with C_i = μ(Ḡ_m(i))⁻¹·Ḡ_i, where
/// μ(w, x, y, z) = (w, −x, y, −z) and a bar means rest. So both rests may differ, in the directions of their
/// axes or as a whole: rest stays rest.
///
/// `warnings`: joints without a partner (a sword in one hand), and pairs whose rests are not each other's
/// mirror image to 1 % of the size. Refuses skeletons of 65535 joints or more and rests that are not finite;
/// `Status::index`: joint.
template <class T>
Status build_mirror_map(const Skeleton& skeleton, MirrorMap<T>& out,
                        std::vector<MirrorWarning>* warnings = nullptr);

/// Mirrors a motion, or anything that blends give. Twice is the motion again. Exact derivatives: all maps
/// are constant. Allocates nothing.
///
/// To turn mirroring on and off while playing, begin a transition (`begin_inertial`) from one to the other.
/// Events of a mirrored clip: `EventMirror`. Contact windows: of `partners[joint]`. Phases: half a cycle on.
template <class T>
struct MirrorJob {
  const MirrorMap<T>* map = nullptr;  ///< of build_mirror_map()
  std::span<const JointJet<T>> jets;  ///< of all joints of the map
  std::span<JointJet<T>> out;         ///< may be `jets`; shorter means fewer joints

  Status Validate() const;  ///< what Run() refuses: no map, fewer jets than it has, more in the output
  Status Run() const;       ///< on an error `out` is left as it was
};

#define SINEW_MIRROR_INSTANCES(prefix, T)                                                                  \
  prefix template Status build_mirror_map<T>(const Skeleton&, MirrorMap<T>&, std::vector<MirrorWarning>*); \
  prefix template struct MirrorJob<T>;
SINEW_MIRROR_INSTANCES(extern, float)
SINEW_MIRROR_INSTANCES(extern, double)

}  // namespace sinew
