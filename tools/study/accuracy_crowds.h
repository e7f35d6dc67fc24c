// What whole scenes cost in steps of 1/60 s, beside single characters: many who fall on each other, who are
// hit at once, who walk and are checked.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "study/accuracy_trip.h"

namespace sinew::study {

struct CrowdCost {
  std::string name, title;  ///< the situation's file; what happens in it
  int characters = 0;
  double solved = 0;  ///< of these, in the mean over frames: not played alone
  FrameCosts us;      ///< processor time of all characters together per 1/60 s, on one thread
};

/// A situation of assets/scenes/situations as its file says, but for the length. `runs`: repetitions, see
/// frame_costs().
convert::Error measure_situation(const std::string& name, double seconds, int runs, CrowdCost& out);

/// Mannequins that walk; so many of each hundred are pushed in every second, with 60 N·s at the chest over
/// 0.1 s, from any side. Checked in batches, and solved where muscles give way. The first half second is not
/// counted.
convert::Error measure_walkers(int count, double percent_hit, double seconds, int runs, CrowdCost& out);

/// 1000 walkers, without and with 5 % hit per second; the pile, the twenty who are hit at once, the corner.
/// What cannot be measured is left out.
std::vector<CrowdCost> measure_crowds(bool quick, const std::function<void(int, int)>& progress);

}  // namespace sinew::study
