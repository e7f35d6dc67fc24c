#include "retarget/body_map.h"

#include <algorithm>

#include "convert/roles.h"

namespace sinew::retarget {

const std::array<Role, 20> kParts = {Role::kPelvis,    Role::kSpine,     Role::kNeck,     Role::kHead,
                                     Role::kClavicleL, Role::kUpperArmL, Role::kForearmL, Role::kHandL,
                                     Role::kClavicleR, Role::kUpperArmR, Role::kForearmR, Role::kHandR,
                                     Role::kThighL,    Role::kShinL,     Role::kFootL,    Role::kToesL,
                                     Role::kThighR,    Role::kShinR,     Role::kFootR,    Role::kToesR};

namespace {

int common_ancestor(const Skeleton& skeleton, int a, int b) {
  while (a != b) {
    int& later = a > b ? a : b;  // parents come first: the later one cannot be above the other
    later = skeleton.joints[later].parent;
    if (later < 0) return -1;
  }
  return a;
}

/// From `first` down to `end`, without it; `first` alone where there is no end below it.
Chain chain_between(const Skeleton& skeleton, int first, int end) {
  if (first < 0) return {};
  if (end < 0 || end == first || !is_below(skeleton, end, first)) return {{first}, -1};
  Chain chain{{}, end};
  for (int j = end; j != first;) {
    j = skeleton.joints[j].parent;
    chain.joints.push_back(j);
  }
  std::reverse(chain.joints.begin(), chain.joints.end());
  return chain;
}

struct Limb {
  Role upper, middle, end, tip;
};
constexpr Limb kLegs[] = {{Role::kThighL, Role::kShinL, Role::kFootL, Role::kToesL},
                          {Role::kThighR, Role::kShinR, Role::kFootR, Role::kToesR}};

Error check_legs(const Skeleton& skeleton) {
  const auto any = std::any_of(skeleton.joints.begin(), skeleton.joints.end(),
                               [](const Joint& joint) { return joint.role != Role::kNone; });
  if (!any)
    return {"none of its " + std::to_string(skeleton.joints.size()) +
            " joints has a name that says which part of a body it is (name them: --map)"};
  for (const Limb& leg : kLegs) {
    for (const Role role : {leg.upper, leg.middle, leg.end})
      if (skeleton.find(role) < 0)
        return {"no joint is known as its " + convert::role_name(role) +
                ": it has no legs, or name it (--map)"};
    for (const auto& [above, below] : {std::pair(leg.upper, leg.middle), std::pair(leg.middle, leg.end)})
      if (!is_below(skeleton, skeleton.find(below), skeleton.find(above)))
        return {"joint '" + skeleton.joints[skeleton.find(below)].name + "' (" + convert::role_name(below) +
                ") is not below '" + skeleton.joints[skeleton.find(above)].name + "' (" +
                convert::role_name(above) + ")"};
  }
  return {};
}

void find_arm(const Skeleton& skeleton, Role clavicle, Role upper, Role forearm, Role hand, BodyMap& map) {
  const int arm = skeleton.find(upper), elbow = skeleton.find(forearm), wrist = skeleton.find(hand);
  if (arm < 0) return;
  if (const int collar = skeleton.find(clavicle); collar >= 0 && is_below(skeleton, arm, collar))
    map[clavicle] = chain_between(skeleton, collar, arm);
  map[upper] = chain_between(skeleton, arm, elbow);
  if (map[upper].end < 0) return;
  map[forearm] = chain_between(skeleton, elbow, wrist);
  if (map[forearm].end >= 0) map[hand] = {{wrist}, -1};
}

void find_trunk(const Skeleton& skeleton, int top, BodyMap& map) {
  const int head = skeleton.find(Role::kHead), neck = skeleton.find(Role::kNeck);
  const int pelvis = map.pelvis();
  Chain trunk = chain_between(skeleton, pelvis, top);
  if (trunk.end < 0) return;
  trunk.joints.erase(trunk.joints.begin());
  if (!trunk.joints.empty()) map[Role::kSpine] = trunk;
  if (neck >= 0 && top == neck) map[Role::kNeck] = chain_between(skeleton, neck, head);
  if (head >= 0) map[Role::kHead] = {{head}, -1};
}

}  // namespace

bool is_below(const Skeleton& skeleton, int joint, int ancestor) {
  while (joint > ancestor) joint = skeleton.joints[joint].parent;
  return joint == ancestor;
}

Error name_roles(const std::map<std::string, std::string>& joint_of_role, Skeleton& skeleton) {
  for (const auto& [name, joint] : joint_of_role) {
    const Role role = convert::role_from_name(name);
    if (role == Role::kNone) return {"there is no role '" + name + "'"};
    const int found = skeleton.find(joint.c_str());
    if (found < 0) return {"it has no joint '" + joint + "'"};
    for (Joint& other : skeleton.joints)
      if (other.role == role) other.role = Role::kNone;
    skeleton.joints[found].role = role;
  }
  return {};
}

void infer_roles(Skeleton& skeleton) {
  constexpr std::array<std::array<Role, 4>, 4> kAbove = {
      {{Role::kShinL, Role::kFootL, Role::kShinR, Role::kFootR},
       {Role::kThighL, Role::kShinL, Role::kThighR, Role::kShinR},
       {Role::kForearmL, Role::kHandL, Role::kForearmR, Role::kHandR},
       {Role::kUpperArmL, Role::kForearmL, Role::kUpperArmR, Role::kForearmR}}};
  for (const auto& [above_l, below_l, above_r, below_r] : kAbove) {
    const int left = skeleton.find(below_l), right = skeleton.find(below_r);
    if (left < 0 || right < 0) continue;
    const int common = common_ancestor(skeleton, left, right);
    for (const auto& [role, below] : {std::pair(above_l, left), std::pair(above_r, right)})
      if (const int parent = skeleton.joints[below].parent; skeleton.find(role) < 0 && parent > common)
        skeleton.joints[parent].role = role;
  }
}

Error find_chains(const Skeleton& skeleton, BodyMap& out) {
  if (Error error = check_legs(skeleton)) return error;
  BodyMap map;
  int pelvis = common_ancestor(skeleton, skeleton.find(Role::kThighL), skeleton.find(Role::kThighR));
  int top = skeleton.find(Role::kNeck);
  if (top < 0) top = skeleton.find(Role::kHead);
  if (top < 0 && skeleton.find(Role::kUpperArmL) >= 0 && skeleton.find(Role::kUpperArmR) >= 0)
    top = common_ancestor(skeleton, skeleton.find(Role::kUpperArmL), skeleton.find(Role::kUpperArmR));
  if (pelvis >= 0 && top >= 0) pelvis = common_ancestor(skeleton, pelvis, top);
  if (pelvis < 0 || pelvis == skeleton.find(Role::kThighL) || pelvis == skeleton.find(Role::kThighR))
    return {"its legs and trunk do not meet in a joint that could be the pelvis"};
  map[Role::kPelvis] = {{pelvis}, -1};
  if (top > pelvis) find_trunk(skeleton, top, map);
  find_arm(skeleton, Role::kClavicleL, Role::kUpperArmL, Role::kForearmL, Role::kHandL, map);
  find_arm(skeleton, Role::kClavicleR, Role::kUpperArmR, Role::kForearmR, Role::kHandR, map);
  for (const Limb& leg : kLegs) {
    map[leg.upper] = chain_between(skeleton, skeleton.find(leg.upper), skeleton.find(leg.middle));
    map[leg.middle] = chain_between(skeleton, skeleton.find(leg.middle), skeleton.find(leg.end));
    map[leg.end] = chain_between(skeleton, skeleton.find(leg.end), skeleton.find(leg.tip));
    if (map[leg.end].end >= 0) map[leg.tip] = {{skeleton.find(leg.tip)}, -1};
  }
  out = std::move(map);
  return {};
}

std::vector<Transform<double>> model_rest(const Skeleton& skeleton) {
  std::vector<Transform<double>> model(skeleton.joints.size());
  for (std::size_t j = 0; j < model.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    model[j] = parent < 0 ? skeleton.joints[j].rest : model[parent] * skeleton.joints[j].rest;
  }
  return model;
}

}  // namespace sinew::retarget
