// The clips by which a body gets up, and which of them, from where on, is nearest to how it lies. Internal to
// behaviours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sinew/animation/mirror_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/behaviour/pose_distance.h"

namespace sinew {

/// A clip, or its mirror image.
struct GetUpVariant {
  const Clip* clip = nullptr;  ///< one of those that prepare() was given
  bool mirrored = false;       ///< left and right exchanged (MirrorJob)
  bool rolls = false;          ///< ends lying, so that another clip can get up from there
  double end_height = 0;       ///< m, of the root where the clip ends
};

/// A pose at which a variant may be entered: one in which the body rests on what touches the ground.
struct GetUpEntry {
  int variant = 0;  ///< of GetUpClips::variants()
  double time = 0;  ///< s, of the clip
};

/// An entry, and how far a body is from it.
struct GetUpChoice {
  int entry = -1;  ///< −1: there is none
  Fit fit;         ///< of the entry's pose to the body
};

/// The get-up clips of one skeleton, and the poses of each at which a body may come in.
template <class T>
class GetUpClips {
 public:
  static constexpr std::size_t kMostVariants = 32;  ///< the bits of `tried`; further ones are left out

  /// Set-up, from all clips of an asset: takes those named get_up… and roll…, which must outlive this, each
  /// also mirrored where the skeleton has two sides. `unit`: the figure's size, of a human's.
  void prepare(const Skeleton& skeleton, std::span<const Clip> clips, double unit);
  /// Whether prepare() found nothing.
  bool empty() const { return entries_.empty(); }
  /// In the order of the clips, each followed by its mirror image.
  std::span<const GetUpVariant> variants() const { return variants_; }
  /// Poses to choose from.
  int entries() const { return static_cast<int>(entries_.size()); }
  /// As choose() names it; must exist.
  const GetUpEntry& entry(int index) const { return entries_[static_cast<std::size_t>(index)]; }
  /// By which poses are compared.
  const PosePoints<T>& points() const { return points_; }

  /// The entry nearest to a body, of variants that are not in `tried` (a bit each). Rolls only where no
  /// other is within reach; or, `turns` set, where one is about as near as any other: who lies on a slope
  /// gets up by his hands, and not from a seat. O(entries · points).
  GetUpChoice choose(std::span<const Vec3<double>> is, std::uint32_t tried, bool turns = false) const;
  /// How far a body is from one entry.
  Fit fit(int entry, std::span<const Vec3<double>> is) const;
  /// What a variant does. O(joints).
  void sample(int variant, const ClipTime& time, std::span<JointJet<T>> jets) const;
  /// The points of a pose in its own frame, m. `model` is room for the joints.
  void place(std::span<const JointJet<T>> jets, std::span<Transform<T>> model,
             std::span<Vec3<double>> out) const;

 private:
  void add(const Skeleton& skeleton, const GetUpVariant& variant, std::span<JointJet<T>> jets,
           std::span<Transform<T>> model);
  std::span<const Vec3<double>> pose(int entry) const;

  PosePoints<T> points_;
  std::vector<int> parents_;
  MirrorMap<T> mirror_;
  double unit_ = 1;
  std::vector<GetUpVariant> variants_;
  std::vector<GetUpEntry> entries_;
  std::vector<Vec3<double>> poses_;  ///< [entry][point] m
};

extern template class GetUpClips<float>;
extern template class GetUpClips<double>;

}  // namespace sinew
