// Clips of one character for another one, whatever its proportions, its joints' names and its rest pose.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "retarget/pose_map.h"
#include "sinew/io/asset.h"

namespace sinew::retarget {

struct Options {
  std::vector<std::string> clips;                           ///< names; empty: all
  std::map<std::string, std::string> from_roles, to_roles;  ///< role → joint, where names do not say it
  JointPairs joints;                                        ///< target → source: joints beside the chains
  bool froude = false;      ///< slower for larger bodies, by the square root of leg lengths; else as it is
  bool plant = true;        ///< soles are put on the floor where they rest
  bool keep_clips = false;  ///< the target's own clips stay; else they make room

  /// { "from": { ROLE: JOINT }, "to": { ROLE: JOINT }, "joints": { TARGET JOINT: SOURCE JOINT } }
  Error read_map(const nlohmann::json& map);
};

/// Puts clips of `source` into a copy of `target`, fitted to its body: `out`. Contacts, events, curves and
/// markers come along. The target's muscles stay as they are: `report` says what the clips ask of them, which
/// chains were mapped, which joints were not, and how soles and knees do.
/// An error names the skeleton, joint or clip at fault. Cost: the curves' fit, seconds per minute of clip.
Error retarget_clips(const Asset& source, const Asset& target, const Options& options, Asset& out,
                     nlohmann::json& report);

/// What convert::convert_files asks for files of other skeletons: fits their clips to a character, which
/// gains them, and notes it in the conversion's report.
Error add_retargeted(const std::string& input, const convert::Options& conversion, Asset& character,
                     nlohmann::json& report);

/// The report as text for a person.
std::string report_text(const nlohmann::json& report);

}  // namespace sinew::retarget
