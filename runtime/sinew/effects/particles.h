// Bodies of particles: what strands, cloth and soft tissue have in common.
//
// Every free node is a body of mass without extent on a translation joint, an unknown of the same optimizer
// as the characters' joints. Nodes that are fixed are material points of the body whose frame the whole thing
// was made in, so it is held exactly and pulls back on that body. See particles.md.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sinew/effects/coupling.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// One particle at rest.
struct ParticleNode {
  Vec3<double> position = Vec3<double>::Zero();  ///< m, at rest, in the frame's axes
  double mass = 0.001;                           ///< kg, of a free node
  bool fixed = false;                            ///< rides on the frame
};

/// Plain data, made by make_strand, make_cloth, make_soft_tissue, or by hand.
struct ParticleBody {
  std::string name = "particles";   ///< of the skeleton that carries it
  Anchor frame;                     ///< of a character, a prop or the world
  std::vector<ParticleNode> nodes;  ///< at least one is free
  /// Nodes by index, weights that add up to 0, length in m; further members are the step's.
  std::vector<Stencil<double>> stencils;
  std::vector<Tetrahedron<double>> tetrahedra;  ///< nodes by index; each has a volume and a material
  double radius = 0.005;      ///< m, of every node as others meet it; 0: passes through everything
  double friction = 0.5;      ///< ≥ 0, Coulomb's coefficient
  double damping = 0;         ///< N·s/m of every node against the air
  bool meets_frame = false;   ///< may touch the body whose frame it was made in
  bool meets_itself = false;  ///< its nodes may touch each other
};

/// Without nodes: what the settings of all kinds have in common.
template <class Settings>
ParticleBody particle_body(const char* name, const Settings& s) {
  ParticleBody body;
  body.name = name;
  body.frame = s.frame;
  body.radius = s.radius;
  body.friction = s.friction;
  body.damping = s.damping;
  return body;
}

/// Whether all of these are nodes of so many.
bool nodes_exist(std::span<const int> nodes, std::size_t count);

/// What is wrong with it: masses, indices, finiteness. `Status::index` is the node or element at fault.
Status check(const ParticleBody& body);

/// The tree that carries it, from where its frame is now (world): a fixed root, then one joint per free node.
Skeleton skeleton_of(const ParticleBody& body, const Transform<double>& frame);

/// Body of that tree that a free node is; −1: fixed.
std::vector<int> bodies_of_nodes(const ParticleBody& body);

/// Its elements. `state`: number of its own tree in the world; `place`: where its frame is fixed.
template <class T>
Coupling<T> make_elements(const ParticleBody& body, int state, const Place& place);

/// @cond
extern template Coupling<float> make_elements(const ParticleBody&, int, const Place&);
extern template Coupling<double> make_elements(const ParticleBody&, int, const Place&);
/// @endcond

}  // namespace sinew
