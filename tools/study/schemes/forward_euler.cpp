#include "study/schemes/forward_euler.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>

#include "sinew/muscle/joint_coordinates.h"
#include "study/schemes/evaluate.h"

namespace sinew::study {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Forces that depend on speeds are those of a step so much shorter than the real one that nothing else
/// changes in it; float resolves no shorter one.
template <class T>
constexpr T kInstant = sizeof(T) == 4 ? T(1) / 256 : T(1e-6);

/// A tree at one pose in numbers of double precision: six rows per body, its momentum by the rates of all
/// degrees of freedom.
template <class T>
struct Momenta {
  Matrix jacobian, momentum;  ///< [6 body, dof] velocity and spin of the centre of mass; m v and I ω

  explicit Momenta(const TreeProblem<T>& p) {
    const Tree<T>& tree = *p.tree;
    jacobian = momentum = Matrix::Zero(6 * tree.bodies, tree.dofs);
    for (int i = 0; i < tree.bodies; ++i) {
      const Mat3<double> r = p.kinematics.rotation[i].template cast<double>();
      const Mat3<double> inertia = r * tree.inertia[i].template cast<double>() * r.transpose();
      const Vec3<double> center = p.kinematics.center[i].template cast<double>();
      for (int joint = i; joint >= 0; joint = tree.parent[joint])
        for (int dof = tree.first_dof[joint]; dof < tree.first_dof[joint + 1]; ++dof) {
          const Vec3<double> w = p.kinematics.w[dof].template cast<double>();
          const Vec3<double> v = p.kinematics.v[dof].template cast<double>() + w.cross(center);
          jacobian.block<3, 1>(6 * i, dof) = v;
          jacobian.block<3, 1>(6 * i + 3, dof) = w;
          momentum.block<3, 1>(6 * i, dof) = double(tree.mass[i]) * v;
          momentum.block<3, 1>(6 * i + 3, dof) = inertia * w;
        }
    }
  }
  Matrix mass() const { return jacobian.transpose() * momentum; }
};

/// What the prediction of implicit Euler knows of how the bodies move when the step begins; the kinematics
/// are those of that pose.
template <class T>
Vector momenta_at_start(const TreeProblem<T>& p, T h) {
  Vector out(6 * p.tree->bodies);
  for (int i = 0; i < p.tree->bodies; ++i) {
    const Vec3<T> velocity = (p.prediction.center[i] - p.kinematics.center[i]) / h;
    out.segment<3>(6 * i) = (p.tree->mass[i] * velocity).template cast<double>();
    out.segment<3>(6 * i + 3) = p.prediction.momentum[i].template cast<double>();
  }
  return out;
}

template <class T>
std::array<T, 6> moved(const Tree<T>& tree, int body, const Vector& rates, T time) {
  std::array<T, 6> d{};
  for (int k = 0; k < tree.dof_count(body); ++k) d[k] = time * T(rates[tree.first_dof[body] + k]);
  return d;
}

template <class T>
void put(TreeProblem<T>& p, const Vector& rates, T time) {
  for (int i = 0; i < p.tree->bodies; ++i)
    p.local[i] = displaced<T>(*p.tree, i, p.start[i], moved(*p.tree, i, rates, time).data());
}

/// One tree on its way through a step.
template <class T>
struct TreeStep {
  TreeProblem<T>* p;
  Matrix mass, back;  ///< at the start; transposed Jacobian
  Vector before;      ///< [6 body] momenta by the rates
  Vector rates;       ///< [dof]
  T weight;

  TreeStep(TreeProblem<T>& of, T h) : p(&of), weight(of.prediction.weight) {
    forward_kinematics<T>(*p->tree, p->start, p->common_origin, p->kinematics);
    const Momenta<T> start(*p);
    mass = start.mass();
    back = start.jacobian.transpose();
    rates = mass.ldlt().solve(back * momenta_at_start(*p, h));
    before = start.momentum * rates;
    put(*p, rates, h * kInstant<T>);
    p->prediction.weight = T(0);  // forces alone
  }

  /// Of those that are driven, by where they are driven.
  Vector led_accelerations(T h) const {
    Vector a = Vector::Zero(p->tree->dofs);
    for (int i = 0; i < p->tree->bodies; ++i) {
      const std::array<T, 6> way = joint_offset_value<T>(*p->tree, i, p->start[i], p->target[i]);
      for (int k = 0; k < p->tree->dof_count(i); ++k)
        if (const int dof = p->tree->first_dof[i] + k; !p->free[dof])
          a[dof] = (double(way[k]) / double(h) - rates[dof]) / double(h);
    }
    return a;
  }

  /// Under the forces of the instant that has been evaluated. Leaves in `gradient` what driven joints ask
  /// for.
  void accelerate(T h) {
    const double instant = double(h * kInstant<T>);
    Vector asked = back * (Momenta<T>(*p).momentum * rates - before) / instant;
    for (int dof = 0; dof < p->tree->dofs; ++dof) asked[dof] += double(p->gradient[dof]);
    Vector a = led_accelerations(h);
    std::vector<int> free;
    for (int dof = 0; dof < p->tree->dofs; ++dof)
      if (p->free[dof]) free.push_back(dof);
    const Vector missing = -(asked + mass * a);
    if (!free.empty()) a(free) = mass(free, free).ldlt().solve(missing(free)).eval();
    asked += mass * a;
    put(*p, rates, h);
    for (int i = 0; i < p->tree->bodies; ++i)
      if (p->tree->dof_count(i) == 0 || !p->free[p->tree->first_dof[i]]) p->local[i] = p->target[i];
    for (int dof = 0; dof < p->tree->dofs; ++dof) p->gradient[dof] = T(asked[dof]);
    forward_kinematics<T>(*p->tree, p->local, p->common_origin, p->kinematics);
    leave(Momenta<T>(*p).jacobian * (rates + double(h) * a));
  }

  /// For advance(), where nobody asks for it any more: velocity and spin.
  void leave(const Vector& motion) {
    for (int i = 0; i < p->tree->bodies; ++i) {
      p->prediction.rotation[i].col(0) = motion.segment<3>(6 * i).cast<T>();
      p->prediction.rotation[i].col(1) = motion.segment<3>(6 * i + 3).cast<T>();
    }
    p->prediction.weight = weight;
  }
};

/// Damping of contacts as of the shorter step.
template <class T>
void shorten(std::span<Contact<T>> contacts, T share) {
  for (Contact<T>& c : contacts) {
    c.stretch = 1 + (c.stretch - 1) / share;
    c.lag /= share;
  }
}

}  // namespace

template <class T>
void ForwardEuler<T>::declare(StepPlan<T>& plan) {
  static const ForwardEuler scheme;
  plan.scheme = &scheme;
}

template <class T>
void ForwardEuler<T>::predict(const Tree<T>& tree, const History<T>& history, T h,
                              const Vec3<double>& common_origin, Prediction<T>& out) const {
  predict_euler<T>(tree, history, h, common_origin, out);
  out.other = this;
}

template <class T>
void ForwardEuler<T>::solve(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
                            std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings) const {
  const T share = kInstant<T>;
  StepSettings<T> instant = settings;
  instant.h *= share;
  instant.stick *= share;
  const std::unique_ptr<ContactModel<T>> contact_model =
      settings.plan->contact_rows ? settings.plan->contact_rows() : std::make_unique<ContactModel<T>>();
  std::vector<TreeStep<T>> steps;
  for (TreeProblem<T>* p : trees) steps.emplace_back(*p, settings.h);
  shorten(contacts, share);
  const auto evaluate = [&] { evaluate_all<T>(instant, trees, contacts, couplings, *contact_model); };
  evaluate();
  for (TreeStep<T>& s : steps) s.accelerate(settings.h);
  bool released = false;
  for (TreeProblem<T>* p : trees) released = release_overloaded(*p) || released;
  if (released) {
    for (TreeStep<T>& s : steps) {
      put(*s.p, s.rates, instant.h);
      s.p->prediction.weight = T(0);
    }
    evaluate();
    for (TreeStep<T>& s : steps) s.accelerate(settings.h);
  }
  shorten(contacts, 1 / share);
}

template <class T>
void ForwardEuler<T>::advance(const Tree<T>& tree, const Kinematics<T>& kinematics,
                              const Prediction<T>& prediction, std::span<const Vec3<T>> /*torque*/, T h,
                              const Vec3<double>& common_origin, History<T>& history) const {
  follow_root(kinematics, common_origin, history);
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = kinematics.rotation[i];
    const Vec3<T> spin = prediction.rotation[i].col(1);
    history.velocity[i] = prediction.rotation[i].col(0);
    history.center[i] = kinematics.center[i] - kinematics.origin[0];
    history.rotation[i] = r;
    for (int a = 0; a < 3; ++a) history.rotation_rate[i].col(a) = spin.cross(r.col(a));
    history.momentum[i] = r * (tree.inertia[i] * (r.transpose() * spin));
  }
  history.step_before = h;
  history.accelerates = false;
}

template class ForwardEuler<float>;
template class ForwardEuler<double>;

}  // namespace sinew::study
