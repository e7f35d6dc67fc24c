// How far something slides over the ground while it touches it, from where it is in two frames.
#pragma once

#include <optional>

#include "study/audit/solid.h"

namespace sinew::study {

/// Of the points that touch in two frames the one that moved least counts: what rolls or turns about a point
/// does not slide.
class Slip {
 public:
  /// A solid as it was a frame ago and as it is now; `ground` m.
  void look(const audit::Solid& before, const audit::Solid& now, double ground);
  void end_frame();
  double furthest() const { return furthest_; }  ///< m, since it touched

 private:
  std::optional<Eigen::Vector2d> least_;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
  double furthest_ = 0;
};

}  // namespace sinew::study
