#include "study/impulse_work.h"

#include <Eigen/Cholesky>

namespace sinew::study {
namespace {

bool hangs_on(const Tree<double>& tree, int body, int joint) {
  while (body > joint) body = tree.parent[body];
  return body == joint;
}

}  // namespace

double work_of_impulses(const Tree<double>& tree, std::span<const Transform<double>> local, bool root_is_led,
                        std::span<const PointImpulse> impulses) {
  Kinematics<double> k(tree);
  forward_kinematics<double>(tree, local, Vec3<double>::Zero(), k);
  const int first = root_is_led && tree.type[0] == JointType::kFree ? tree.dof_count(0) : 0;
  const int count = tree.dofs - first;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd given = Eigen::VectorXd::Zero(count);
  double work = 0;
  // How a unit of each joint's rate moves a point of a body, and turns it.
  const auto moves = [&](int body, const Vec3<double>& point, Eigen::Matrix3Xd& slides,
                         Eigen::Matrix3Xd& turns) {
    slides.setZero(3, count);
    turns.setZero(3, count);
    for (int dof = first; dof < tree.dofs; ++dof) {
      if (!hangs_on(tree, body, tree.dof_body[dof])) continue;
      turns.col(dof - first) = k.w[dof];
      slides.col(dof - first) = k.v[dof] + k.w[dof].cross(point);
    }
  };
  Eigen::Matrix3Xd slides, turns;
  for (int b = 0; b < tree.bodies; ++b) {
    moves(b, k.center[b], slides, turns);
    const Mat3<double> inertia = k.rotation[b] * tree.inertia[b] * k.rotation[b].transpose();
    mass += tree.mass[b] * slides.transpose() * slides + turns.transpose() * inertia * turns;
  }
  for (const PointImpulse& p : impulses) {
    moves(p.body, p.point, slides, turns);
    given += slides.transpose() * p.impulse;
    work += p.impulse.dot(p.speed);
  }
  return count > 0 ? work + 0.5 * given.dot(mass.ldlt().solve(given)) : work;
}

}  // namespace sinew::study
