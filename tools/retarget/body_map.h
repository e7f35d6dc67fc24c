// Which joints of a skeleton make up its trunk and limbs, from the roles of a few of them.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::retarget {

using convert::Error;

/// Joints from the first of a body part up to, but not including, the first of the next: an upper arm and the
/// twist bones in line with it.
struct Chain {
  std::vector<int> joints;  ///< parents first; empty where the skeleton has no such part
  int end = -1;             ///< joint at which the chain ends; -1: its last joint ends the limb
};

/// Body parts by their role; kSpine is the whole trunk, kNeck the whole neck, kChest is not used.
struct BodyMap {
  std::array<Chain, 22> chains;
  const Chain& operator[](Role role) const { return chains[static_cast<std::size_t>(role)]; }
  Chain& operator[](Role role) { return chains[static_cast<std::size_t>(role)]; }
  int pelvis() const { return (*this)[Role::kPelvis].joints.front(); }
};

/// All parts, the pelvis first, parents before children.
extern const std::array<Role, 20> kParts;

/// Gives joints the roles that a user names: role → joint. An error names an unknown role or joint.
Error name_roles(const std::map<std::string, std::string>& joint_of_role, Skeleton& skeleton);

/// Gives a role that no name says to the joint above the one whose role is known, where that belongs to one
/// side alone: the thigh above a knee, the upper arm above an elbow.
void infer_roles(Skeleton& skeleton);

/// Finds the chains. The pelvis is where the legs and the trunk meet. Legs are needed, all else may be
/// missing. An error says which part has no joint.
Error find_chains(const Skeleton& skeleton, BodyMap& out);

/// Joint → model at rest.
std::vector<Transform<double>> model_rest(const Skeleton& skeleton);

bool is_below(const Skeleton& skeleton, int joint, int ancestor);

}  // namespace sinew::retarget
