// Which knots and which rounding each track of a clip needs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "convert/fit/chain_error.h"
#include "convert/fit/fitted_track.h"
#include "convert/fit/knot_grid.h"

namespace sinew::convert {

/// What curves may differ by from the motion.
struct CurveBudget {
  double error = 1e-3;         ///< m, of a skin point, along the chain
  double skin_distance = 0.1;  ///< m of that point from its joint
  /// What coarse knots and what rounding may each change accelerations by, root mean square, against the
  /// least-squares curve of fifteen knots a second: rad/s² of rotations, m/s² of translations; or the share
  /// of the curve's own, where that is more.
  double angular = 0.5, linear = 0.1, share = 0.02;
  int degree = 5;
};

/// Curves for all joints, refined where the chain's error comes from until it is within the budget, then
/// coarsened one by one where the budget allows it. Few tracks on knots of their own join the next finer.
class CurveSearch {
 public:
  /// One curve on its way.
  struct Channel {
    FittedTrack track;
    int level;            ///< of knots, 0 coarsest
    int coarsest;         ///< level that keeps the accelerations
    int step;             ///< of rounding, see packing_step(); finer where accelerations ask for it
    double acceleration;  ///< of the curve, root mean square, rad/s² or m/s²
  };

  /// `samples`: [frame][joint]; after the last of a loop comes the first again. `instants`: [frame] when, as
  /// shares of the duration. `finest`: spans of the closest knots. `parents`, `rest`: see FitInput.
  /// `duration`: s.
  CurveSearch(const std::vector<std::vector<Transform<double>>>& samples, std::vector<double> instants,
              int finest, const std::vector<int>& parents, const std::vector<Transform<float>>& rest,
              double duration, bool loops, const CurveBudget& budget);

  void run();

  const std::vector<Channel>& channels() const { return channels_; }
  /// The grid of a channel, or that of the least-squares curve whose accelerations are to be kept, if finer.
  const KnotGrid& reference_grid(const Channel& channel) {
    return grid(std::max(channel.level, reference_level()));
  }
  /// [joint] what joints keep that have no channel.
  const std::vector<Transform<float>>& constants() const { return constants_; }

 private:
  enum class Move : std::uint8_t { kNone, kMoreKnots, kFinerStep };

  double reach(int joint) const;
  void add_channels(int joint, const JointMotion& motion, const Transform<float>* rest);
  void add_channel(int joint, bool rotation, double lever, const JointMotion& motion);
  const KnotGrid& grid(int level);
  double interval(int level) const { return duration_ / spans_[level]; }
  double acceleration_budget(bool rotation, double own) const;
  int reference_level() const;
  int coarsest_level(const FittedTrack& track);
  int step_of(const Channel& channel) const;
  void fit(Channel& channel);
  void play(const Channel& channel);
  double gain(const Channel& channel, int joint, int frame, Move& move) const;
  bool refine(int joint, std::vector<std::uint8_t>& touched);
  void refine_all();
  void coarsen(bool knots);
  int turning(int level) const;
  int next_level(int level) const;
  void merge_small_levels();
  bool try_change(Channel& channel, int level, int step);

  CurveBudget budget_;
  double duration_ = 0;
  bool loops_ = false;
  ChainError chain_;
  std::vector<double> instants_;       ///< [frame]
  std::vector<int> spans_;             ///< [level]
  std::vector<std::uint8_t> allowed_;  ///< [level] whether tracks may have it
  std::map<int, std::unique_ptr<KnotGrid>> grids_;
  std::vector<Channel> channels_;
  std::vector<std::vector<int>> channels_of_;  ///< [joint]
  std::vector<Transform<float>> constants_;
  std::vector<JointMotion> local_;  ///< [joint] as played
};

}  // namespace sinew::convert
