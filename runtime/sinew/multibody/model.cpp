#include "sinew/multibody/model.h"

#include <algorithm>

namespace sinew::multibody {
namespace {

Skeleton skeleton_of(const Mechanism& m) {
  std::vector<int> joint_of(m.bodies.size());
  for (std::size_t i = 0; i < m.joints.size(); ++i) joint_of[m.joints[i].child] = static_cast<int>(i);
  Skeleton s;
  s.name = m.name;
  s.body_count = static_cast<int>(m.joints.size());
  for (const HingeOrSlider& from : m.joints) {
    const Body& body = m.bodies[from.child];
    Joint j;
    j.name = body.name;
    j.source_joint = from.name;
    j.type = from.type;
    j.parent = from.parent == kGround ? -1 : joint_of[from.parent];
    const Vec3<double> above = j.parent < 0 ? Vec3<double>(Vec3<double>::Zero()) : m.joints[j.parent].anchor;
    j.rest.translation = from.anchor - above;
    j.axis = from.axis.normalized();
    j.mass = body.mass;
    j.center_of_mass = body.center_of_mass - from.anchor;
    j.inertia = body.inertia;
    s.joints.push_back(j);
  }
  return s;
}

}  // namespace

Model::Model(const Mechanism& mechanism) : tree(skeleton_of(mechanism)), mechanism_(mechanism) {
  body_of_file.resize(mechanism.bodies.size());
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i) {
    body_of_file[mechanism.joints[i].child] = static_cast<int>(i);
    joint_force.push_back(mechanism.joints[i].force);
    note_profile(mechanism.joints[i].force.rest_profile);
  }
  for (const Loop& l : mechanism.loops) {
    LoopModel& loop = loops.emplace_back();
    loop.type = l.type;
    loop.first_row = loop_rows;
    loop.a = attach(l.body_a, l.point_a);
    loop.b = attach(l.body_b, l.point_b);
    loop.axis_b = l.axis.normalized();
    loop.normal_a[0] = loop.axis_b.unitOrthogonal();
    loop.normal_a[1] = loop.axis_b.cross(loop.normal_a[0]);
    loop.length = (l.point_b - l.point_a).norm();
    loop.path = path_between(loop.a.body, loop.b.body);
    loop_rows += equation_count(l.type);
  }
  for (const Force& f : mechanism.forces) {
    ForceModel& force = forces.emplace_back();
    force.law = f;
    force.a = attach(f.body_a, f.point_a);
    const bool two_bodies = f.type == ForceType::kSpringDamper || f.type == ForceType::kContactPlane;
    force.b = attach(two_bodies ? f.body_b : kGround, f.point_b);
    force.direction = f.direction;
    force.path = path_between(force.a.body, force.b.body);
    note_profile(f.road);
  }
  for (const OutputPoint& p : mechanism.points) points.push_back(attach(p.body, p.point));
}

BodyPoint Model::attach(int body, const Vec3<double>& point) const {
  if (body == kGround) return {kGround, point};
  const int i = body_of_file[body];
  return {i, point - mechanism_.joints[i].anchor};
}

Path Model::path_between(int a, int b) const {
  Path path;
  while (a != b) {  // parents have smaller numbers: the larger of the two cannot be a common ancestor
    if (a > b) {
      path.of_a.push_back(a);
      a = tree.parent[a];
    } else {
      path.of_b.push_back(b);
      b = tree.parent[b];
    }
  }
  return path;
}

void Model::note_profile(const std::vector<Pulse>& pulses) {
  for (const Pulse& p : pulses)
    if (p.width < mechanism_.t_end && (shortest_profile == 0 || p.width < shortest_profile))
      shortest_profile = p.width;
}

}  // namespace sinew::multibody
