// Where in its cycle a clip is: what lets a walk and a run step together.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"

namespace sinew {

/// Clip time as a function of the phase φ of a cycle (left foot down at whole numbers, right foot at halves,
/// or whatever its markers mean): τ(φ) = φ·duration/cycles + lag(φ), the lag a uniform periodic cubic
/// B-spline. C² everywhere, so that a clip that plays by phase keeps exact accelerations; straight lines
/// between markers would change its rate in steps.
struct PhaseMap {
  static constexpr int kControls = 16;    ///< over all cycles
  std::array<float, kControls> lag = {};  ///< s, over the whole clip
  float duration = 0;                     ///< s, of the clip
  int cycles = 1;                         ///< that the clip holds

  /// τ, and its first two derivatives by the phase. τ(φ + cycles) = τ(φ) + duration.
  TimeJet<double> by_phase(double phase) const;
  /// The same by time, for a phase that moves: τ' = τ_φ·φ', τ'' = τ_φφ·φ'² + τ_φ·φ''.
  ClipTime at(const TimeJet<double>& phase) const;
};

/// The smoothest map through up to eight markers. Refuses what would make time stand still or run backwards:
/// a rate below a tenth of the mean. `Status::index`: marker.
Status fit_phase_map(std::span<const PhaseMarker> markers, double duration, int cycles, PhaseMap& out);

/// Markers of a looping clip from its contact windows: `left` comes down at whole phases, `right` at halves.
/// `cycles`: how often. Refuses a clip in which the two do not take turns.
Status phase_markers(const Clip& clip, int left, int right, std::vector<PhaseMarker>& markers, int& cycles);

/// One clip of a group that steps together.
struct PhaseMember {
  const PhaseMap* map = nullptr;  ///< of fit_phase_map()
  TimeJet<double> weight{1.0};    ///< ≥ 0, at the end of the step: the one that it is blended with
  double speed = 1;               ///< of this clip when it is alone, in (0.01, 100)
};

/// Moves a group's common phase on and gives every member's time. There is no leader: the phase passes as
/// fast as the weighted mean of the members' own times asks, φ' = Σw / Σ(w·τ_φ/speed), so that one that is
/// alone keeps its own timing exactly, and φ'' = −φ'²·d/dt(Σ(w·τ_φ/speed)/Σw). Weights that are C² (see
/// SmoothInput) make all members' times C².
///
/// One step is exact to h⁵; steps of more than 1/60 s: filters and this job together, in parts.
struct PhaseJob {
  std::span<const PhaseMember> members;  ///< whose weights are not all 0
  double h = 0;                      ///< s since the last call, ≤ 1; 0 for the first, which sets the rates
  TimeJet<double>* phase = nullptr;  ///< state; the caller chooses where it begins
  std::span<ClipTime> times;         ///< [member]

  Status Validate() const;  ///< what Run() refuses; `Status::index`: member at fault
  Status Run() const;       ///< on an error `phase` and `times` are left as they were
};

}  // namespace sinew
