#include "sinew/effects/particles.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

template <class Element>
Status check_nodes(const Element& element, int used, int nodes, int index) {
  for (int i = 0; i < used; ++i)
    if (element.node[i] < 0 || element.node[i] >= nodes)
      return Status::error(Code::kInvalidArgument, "element of a node that is not there", index);
  return {};
}

}  // namespace

Status check(const ParticleBody& body) {
  const int count = static_cast<int>(body.nodes.size());
  bool moves = false;
  for (int i = 0; i < count; ++i) {
    const ParticleNode& node = body.nodes[i];
    if (!node.position.allFinite())
      return Status::error(Code::kNotFinite, "particle's position is not finite", i);
    if (!node.fixed && !(node.mass > 0 && std::isfinite(node.mass)))
      return Status::error(Code::kInvalidArgument, "free particle needs a mass", i);
    moves = moves || !node.fixed;
  }
  if (!moves) return Status::error(Code::kInvalidArgument, "no particle is free to move");
  for (const double x : {body.radius, body.friction, body.damping})
    if (!(x >= 0) || !std::isfinite(x))
      return Status::error(Code::kInvalidArgument, "radius, friction and damping must be ≥ 0");
  for (std::size_t n = 0; n < body.stencils.size(); ++n) {
    const Stencil<double>& e = body.stencils[n];
    const int index = static_cast<int>(n);
    if (e.count < 2 || e.count > 4 || !(e.stiffness >= 0) || !std::isfinite(e.stiffness) ||
        !(e.length >= 0) || !std::isfinite(e.length))
      return Status::error(Code::kInvalidArgument, "stencil without meaningful size or stiffness", index);
    double sum = 0, size = 0;
    for (int i = 0; i < e.count; ++i) {
      sum += e.weight[i];
      size += std::abs(e.weight[i]);
    }
    if (!(std::abs(sum) <= 1e-9 * size))
      return Status::error(Code::kInvalidArgument, "stencil's weights do not add up to 0", index);
    if (const Status status = check_nodes(e, e.count, count, index); !status) return status;
  }
  for (std::size_t n = 0; n < body.tetrahedra.size(); ++n) {
    const Tetrahedron<double>& e = body.tetrahedra[n];
    const int index = static_cast<int>(n);
    if (!(e.volume > 0) || !(e.mu > 0) || !(e.lame > 0) || !std::isfinite(e.volume * (e.mu + e.lame)))
      return Status::error(Code::kInvalidArgument, "tetrahedron without volume or material", index);
    if (const Status status = check_nodes(e, 4, count, index); !status) return status;
  }
  return {};
}

std::vector<int> bodies_of_nodes(const ParticleBody& body) {
  std::vector<int> bodies;
  int next = 1;
  for (const ParticleNode& node : body.nodes) bodies.push_back(node.fixed ? -1 : next++);
  return bodies;
}

Skeleton skeleton_of(const ParticleBody& body, const Transform<double>& frame) {
  Skeleton made;
  made.name = body.name;
  Joint& root = made.joints.emplace_back();
  root.name = body.name;
  root.rest.translation = frame.translation;  // near by, so that float keeps its digits
  for (const ParticleNode& node : body.nodes) {
    if (node.fixed) continue;
    Joint joint;
    joint.name = body.name + std::to_string(made.joints.size());
    joint.type = JointType::kTranslation;
    joint.parent = 0;
    joint.rest.translation = frame * node.position - frame.translation;
    joint.mass = node.mass;
    for (DofLimits& dof : joint.dofs) {
      dof.dry_friction = 0;
      dof.damping = body.damping;
    }
    made.joints.push_back(joint);
    if (body.radius <= 0) continue;
    Collider& ball = made.colliders.emplace_back();
    ball.joint = static_cast<int>(made.joints.size()) - 1;
    ball.size.setConstant(body.radius);
    ball.friction = body.friction;
  }
  made.body_count = static_cast<int>(made.joints.size());
  return made;
}

template <class T>
Coupling<T> make_elements(const ParticleBody& body, int state, const Place& place) {
  Coupling<T> made;
  const std::vector<int> bodies = bodies_of_nodes(body);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    CouplingNode<T>& node = made.nodes.emplace_back();
    node.state = bodies[i] < 0 ? place.state : state;
    node.body = bodies[i] < 0 ? place.body : bodies[i];
    if (bodies[i] >= 0) continue;
    node.place = place.frame * body.nodes[i].position;
    node.local = node.place.template cast<T>();
  }
  for (const Stencil<double>& e : body.stencils) {
    Stencil<T>& out = made.stencils.emplace_back();
    out.count = e.count;
    std::copy_n(e.node, 4, out.node);
    for (int i = 0; i < 4; ++i) out.weight[i] = T(e.weight[i]);
    out.stiffness = T(e.stiffness);
    out.length = T(e.length);
    out.only_pulls = e.only_pulls;
  }
  for (const Tetrahedron<double>& e : body.tetrahedra) {
    Tetrahedron<T>& out = made.tetrahedra.emplace_back();
    std::copy_n(e.node, 4, out.node);
    for (int i = 0; i < 4; ++i) out.slope[i] = e.slope[i].template cast<T>();
    out.volume = T(e.volume);
    out.mu = T(e.mu);
    out.lame = T(e.lame);
  }
  return made;
}

template Coupling<float> make_elements(const ParticleBody&, int, const Place&);
template Coupling<double> make_elements(const ParticleBody&, int, const Place&);

}  // namespace sinew
