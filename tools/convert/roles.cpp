#include "convert/roles.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace sinew::convert {
namespace {

enum class Side { kNone, kLeft, kRight };

/// Lower case words of a name: "mixamorig:LeftForeArm" → {mixamorig, left, fore, arm}; prefixes up to ':' and
/// '|' go.
std::vector<std::string> words(const std::string& full) {
  const auto cut = full.find_last_of(":|");
  const std::string name = cut == std::string::npos ? full : full.substr(cut + 1);
  std::vector<std::string> out;
  std::string word;
  const auto flush = [&] {
    if (!word.empty()) out.push_back(word);
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    if (std::isalpha(c)) {
      if (std::isupper(c) && i > 0 && std::islower(static_cast<unsigned char>(name[i - 1]))) flush();
      word += static_cast<char>(std::tolower(c));
    } else {
      flush();
    }
  }
  flush();
  return out;
}

bool has(const std::vector<std::string>& list, const char* word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

Side side_of(const std::vector<std::string>& w, const std::string& joined) {
  if (has(w, "left") || has(w, "l") || joined.rfind("left", 0) == 0) return Side::kLeft;
  if (has(w, "right") || has(w, "r") || joined.rfind("right", 0) == 0) return Side::kRight;
  return Side::kNone;
}

bool contains(const std::string& text, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const char* p) { return text.find(p) != std::string::npos; });
}

constexpr std::array<std::pair<Role, const char*>, 21> kNames{{{Role::kPelvis, "pelvis"},
                                                               {Role::kSpine, "spine"},
                                                               {Role::kChest, "chest"},
                                                               {Role::kNeck, "neck"},
                                                               {Role::kHead, "head"},
                                                               {Role::kClavicleL, "clavicle_l"},
                                                               {Role::kClavicleR, "clavicle_r"},
                                                               {Role::kUpperArmL, "upperarm_l"},
                                                               {Role::kUpperArmR, "upperarm_r"},
                                                               {Role::kForearmL, "forearm_l"},
                                                               {Role::kForearmR, "forearm_r"},
                                                               {Role::kHandL, "hand_l"},
                                                               {Role::kHandR, "hand_r"},
                                                               {Role::kThighL, "thigh_l"},
                                                               {Role::kThighR, "thigh_r"},
                                                               {Role::kShinL, "shin_l"},
                                                               {Role::kShinR, "shin_r"},
                                                               {Role::kFootL, "foot_l"},
                                                               {Role::kFootR, "foot_r"},
                                                               {Role::kToesL, "toes_l"},
                                                               {Role::kToesR, "toes_r"}}};

}  // namespace

Role role_of_name(const std::string& name) {
  if (is_control_name(name)) return Role::kNone;
  const std::vector<std::string> w = words(name);
  std::string joined;
  for (const std::string& word : w) joined += word;
  const Side side = side_of(w, joined);
  const auto sided = [&](Role left, Role right) {
    return side == Side::kLeft ? left : (side == Side::kRight ? right : Role::kNone);
  };
  if (contains(joined, {"thumb", "index", "middle", "ring", "pinky", "finger", "twist", "end", "nub", "eye",
                        "jaw", "hair"}))
    return Role::kNone;
  if (contains(joined, {"toe", "ball"})) return sided(Role::kToesL, Role::kToesR);
  if (contains(joined, {"foot", "ankle"})) return sided(Role::kFootL, Role::kFootR);
  if (contains(joined, {"upleg", "thigh", "upperleg", "hipjoint"}) && !contains(joined, {"hipjoint"}))
    return sided(Role::kThighL, Role::kThighR);
  if (contains(joined, {"lowerleg", "calf", "shin", "knee", "loleg"}))
    return sided(Role::kShinL, Role::kShinR);
  if (side != Side::kNone && contains(joined, {"leg"}))
    return sided(Role::kShinL, Role::kShinR);  // Mixamo, CMU: LeftLeg
  if (contains(joined, {"forearm", "lowerarm", "elbow", "loarm"}))
    return sided(Role::kForearmL, Role::kForearmR);
  if (contains(joined, {"hand", "wrist"})) return sided(Role::kHandL, Role::kHandR);
  if (contains(joined, {"clavicle", "collar", "shoulder"})) return sided(Role::kClavicleL, Role::kClavicleR);
  if (side != Side::kNone && contains(joined, {"arm"})) return sided(Role::kUpperArmL, Role::kUpperArmR);
  if (contains(joined, {"head"})) return Role::kHead;
  if (contains(joined, {"neck"})) return Role::kNeck;
  if (contains(joined, {"chest", "thorax"})) return Role::kChest;
  if (contains(joined, {"spine", "torso", "abdomen", "lowerback", "back"})) return Role::kSpine;
  if (side == Side::kNone && contains(joined, {"pelvis", "hips", "hip"})) return Role::kPelvis;
  return Role::kNone;
}

bool is_control_name(const std::string& name) {
  const std::vector<std::string> w = words(name);
  std::string joined;
  for (const std::string& word : w) joined += word;
  return has(w, "ik") || has(w, "ctrl") || has(w, "pole") ||
         contains(joined, {"target", "control", "handslot", "slot", "heelik", "kneeik", "elbowik", "handik",
                           "footik"});
}

std::string role_name(Role role) {
  for (const auto& [r, n] : kNames)
    if (r == role) return n;
  return {};
}

Role role_from_name(const std::string& role) {
  for (const auto& [r, n] : kNames)
    if (role == n) return r;
  return Role::kNone;
}

}  // namespace sinew::convert
