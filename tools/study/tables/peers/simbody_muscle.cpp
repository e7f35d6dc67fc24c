#include "study/tables/peers/simbody_muscle.h"

#include <algorithm>
#include <cmath>

namespace sinew::study {
namespace {

using SimTK::MobilizedBody;
using SimTK::State;

Vec3<double> eigen(const SimTK::Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Rotation by a rotation vector, and back (angles up to π).
Quat<double> turned(const Vec3<double>& by) {
  const double angle = by.norm();
  return angle > 0 ? Quat<double>(Eigen::AngleAxisd(angle, by / angle)) : Quat<double>::Identity();
}
Vec3<double> turn_of(const Quat<double>& q) {
  const Eigen::AngleAxisd turn(q.w() < 0 ? Quat<double>(-q.coeffs()) : q);
  return turn.angle() * turn.axis();
}

/// q as a quaternion's four rates, of rotation rates in child axes: ½ q ⊗ (0, v).
Quat<double> rate(const Quat<double>& q, const Vec3<double>& v) {
  return Quat<double>(0.5 * (q * Quat<double>(0, v.x(), v.y(), v.z())).coeffs());
}

void write(const Quat<double>& turn, const Vec3<double>& move, SimTK::Real* to) {
  to[0] = turn.w(), to[1] = turn.x(), to[2] = turn.y(), to[3] = turn.z();
  for (int k = 0; k < 3; ++k) to[4 + k] = move[k];
}

}  // namespace

SimTK::Vec3 simtk(const Vec3<double>& v) {
  return {v.x(), v.y(), v.z()};
}
SimTK::Rotation simtk(const Quat<double>& q) {
  return SimTK::Rotation(SimTK::Quaternion(SimTK::Vec4(q.w(), q.x(), q.y(), q.z())));
}

SimbodyJet SimbodyTarget::when(int body, double time) const {
  SimbodyJet jet = jets[body];
  const double s = time - at;
  jet.place.rotation = jet.place.rotation * turned(s * jet.omega + 0.5 * s * s * jet.alpha);
  jet.place.translation += s * jet.velocity + 0.5 * s * s * jet.acceleration;
  jet.omega += s * jet.alpha;
  jet.velocity += s * jet.acceleration;
  return jet;
}

/// Accelerations of the way back, in Simbody's coordinates: of balls in parent axes. Roots move as told.
SimTK::Vector SimbodyMuscles::wanted(const State& state) const {
  const double per_time = 1 / driven_.scene->return_time;
  SimTK::Vector out(driven_.matter->getNumMobilities(), 0.0);
  for (std::size_t f = 0; f < driven_.bodies.size(); ++f) {
    const std::vector<SimbodyBody>& figure = driven_.scene->figures[f].bodies;
    for (std::size_t i = 0; driven_.scene->figures[f].driven && i < figure.size(); ++i) {
      const MobilizedBody& body = driven_.bodies[f][i];
      const SimbodyJet target = driven_.targets[f].when(static_cast<int>(i), state.getTime());
      const bool hinge = figure[i].type == JointType::kRevolute;
      if (i == 0) {
        const SimTK::Vec3 turning = simtk(target.place.rotation) * simtk(target.alpha);
        for (int k = 0; k < 3; ++k) {
          body.updOneFromUPartition(state, k, out) = turning[k];
          body.updOneFromUPartition(state, 3 + k, out) = target.acceleration[k];
        }
        continue;
      }
      if (figure[i].type == JointType::kFixed) continue;
      // Target axes → child axes as they are.
      const Quat<double> turn = figure[i].rest.rotation.conjugate() * target.place.rotation;
      const SimTK::Rotation& placed = body.getMobilizerTransform(state).R();
      const SimTK::Quaternion q = placed.convertRotationToQuaternion();
      const Quat<double> in_joint(q[0], q[1], q[2], q[3]);
      if (hinge) {
        const Vec3<double> axis = figure[i].axis;
        const double angle = 2 * std::atan2(turn.vec().dot(axis), turn.w());
        const double off = std::remainder(body.getOneQ(state, 0) - angle, 2 * SimTK::Pi),
                     speed = body.getOneU(state, 0) - target.omega.dot(axis);
        body.updOneFromUPartition(state, 0, out) =
            target.alpha.dot(axis) - per_time * (2 * speed + per_time * off);
        continue;
      }
      const Quat<double> off = turn.conjugate() * in_joint;
      const Vec3<double> speed =
          eigen(~placed * body.getMobilizerVelocity(state)[0]) - off.conjugate() * target.omega;
      const SimTK::Vec3 back = placed * simtk(Vec3<double>(off.conjugate() * target.alpha -
                                                           per_time * (2 * speed + per_time * turn_of(off))));
      for (int k = 0; k < 3; ++k) body.updOneFromUPartition(state, k, out) = back[k];
    }
  }
  return out;
}

/// All forces on bodies but the muscles', [mobilised body], at its origin.
SimTK::Vector_<SimTK::SpatialVec> SimbodyMuscles::outside(const State& state) const {
  SimTK::Vector_<SimTK::SpatialVec> out = driven_.gravity->getBodyForces(state) + driven_.pushes;
  const SimTK::ContactSnapshot& touching = driven_.tracker->getActiveContacts(state);
  for (int n = 0; n < driven_.contacts->getNumContactForces(state); ++n) {
    const SimTK::ContactForce& force = driven_.contacts->getContactForce(state, n);
    const SimTK::Contact& contact = touching.getContactById(force.getContactId());
    const auto apply = [&](SimTK::ContactSurfaceIndex surface, double sign) {
      const MobilizedBody& body = driven_.tracker->getMobilizedBody(surface);
      const SimTK::SpatialVec& on = force.getForceOnSurface2();
      const SimTK::Vec3 arm = force.getContactPoint() - body.getBodyOriginLocation(state);
      out[body.getMobilizedBodyIndex()] += sign * SimTK::SpatialVec(on[0] + arm % on[1], on[1]);
    };
    apply(contact.getSurface1(), -1);
    apply(contact.getSurface2(), 1);
  }
  return out;
}

SimbodyMuscles::Dofs SimbodyMuscles::dofs(const State& state) const {
  Dofs out;
  out.directions.setZero(driven_.matter->getNumMobilities(), driven_.matter->getNumMobilities());
  Eigen::Index count = 0;
  for (std::size_t f = 0; f < driven_.bodies.size(); ++f) {
    const std::vector<SimbodyBody>& figure = driven_.scene->figures[f].bodies;
    for (std::size_t i = 1; driven_.scene->figures[f].driven && i < figure.size(); ++i) {
      if (figure[i].type == JointType::kFixed) continue;
      const MobilizedBody& body = driven_.bodies[f][i];
      const int first = body.getFirstUIndex(state), size = body.getNumU(state);
      for (int k = 0; k < size; ++k, ++count) {
        if (size == 1)
          out.directions(first, count) = 1;
        else
          out.directions.block<3, 1>(first, count) = eigen(body.getMobilizerTransform(state).R().col(k));
        out.lower.push_back(-figure[i].torque_minus[k]);
        out.upper.push_back(figure[i].torque_plus[k]);
      }
    }
  }
  out.directions.conservativeResize(Eigen::NoChange, count);
  return out;
}

/// Either a joint goes as wanted or its muscle pulls as hard as it can and it lags: active sets, by pivoting.
Eigen::VectorXd SimbodyMuscles::limited(const State& state, const Dofs& dofs,
                                        const Eigen::VectorXd& torques) const {
  constexpr int kMostPasses = 50;
  constexpr double kSlack = 1e-9;  // N·m
  const Eigen::Index count = torques.size();
  std::vector<int> bound(count, 0);  // −1, 1: at its lower, upper limit
  Eigen::VectorXd out = torques, lag = Eigen::VectorXd::Zero(count);
  Eigen::MatrixXd inertia;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    std::vector<Eigen::Index> weak;
    bool changed = false;
    for (Eigen::Index n = 0; n < count; ++n) {
      const int before = bound[n];
      if (before == 0)
        bound[n] = (out[n] > dofs.upper[n] + kSlack) - (out[n] < dofs.lower[n] - kSlack);
      else if (before * lag[n] > 0)  // it would be ahead
        bound[n] = 0;
      changed |= bound[n] != before;
      if (bound[n] != 0) weak.push_back(n);
    }
    if (!changed) break;
    if (inertia.size() == 0) {
      SimTK::Matrix m;
      driven_.matter->calcM(state, m);
      Eigen::MatrixXd all(m.nrow(), m.ncol());
      for (int r = 0; r < m.nrow(); ++r)
        for (int c = 0; c < m.ncol(); ++c) all(r, c) = m(r, c);
      inertia = dofs.directions.transpose() * all * dofs.directions;
    }
    Eigen::VectorXd missing(weak.size());
    for (std::size_t n = 0; n < weak.size(); ++n)
      missing[n] = (bound[weak[n]] > 0 ? dofs.upper[weak[n]] : dofs.lower[weak[n]]) - torques[weak[n]];
    lag.setZero();
    const Eigen::VectorXd behind = Eigen::MatrixXd(inertia(weak, weak)).llt().solve(missing);
    for (std::size_t n = 0; n < weak.size(); ++n) lag[weak[n]] = behind[n];
    out = torques + inertia * lag;
  }
  for (Eigen::Index n = 0; n < count; ++n) out[n] = std::clamp(out[n], dofs.lower[n], dofs.upper[n]);
  return out;
}

void SimbodyMuscles::calcForce(const State& state, SimTK::Vector_<SimTK::SpatialVec>& on_bodies,
                               SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector& on_mobilities) const {
  on_bodies += driven_.pushes;
  if (std::none_of(driven_.scene->figures.begin(), driven_.scene->figures.end(),
                   [](const SimbodyFigure& f) { return f.driven; }))
    return;
  SimTK::Vector needed;
  driven_.matter->calcResidualForceIgnoringConstraints(state, SimTK::Vector(), outside(state), wanted(state),
                                                       needed);
  const Eigen::Map<const Eigen::VectorXd> all(&needed[0], needed.size());
  const Dofs muscles = dofs(state);
  const Eigen::VectorXd torques = limited(state, muscles, muscles.directions.transpose() * all);
  const Eigen::VectorXd pull = muscles.directions * torques;
  for (int u = 0; u < needed.size(); ++u) on_mobilities[u] += pull[u];
}

void SimbodyRoot::calcPrescribedPosition(const State& s, int, SimTK::Real* q) const {
  const SimbodyJet jet = now(s);
  write(jet.place.rotation, jet.place.translation, q);
}
void SimbodyRoot::calcPrescribedPositionDot(const State& s, int, SimTK::Real* qdot) const {
  const SimbodyJet jet = now(s);
  write(rate(jet.place.rotation, jet.omega), jet.velocity, qdot);
}
void SimbodyRoot::calcPrescribedPositionDotDot(const State& s, int, SimTK::Real* qdotdot) const {
  const SimbodyJet jet = now(s);
  const Quat<double> turned_twice(rate(rate(jet.place.rotation, jet.omega), jet.omega).coeffs() +
                                  rate(jet.place.rotation, jet.alpha).coeffs());
  write(turned_twice, jet.acceleration, qdotdot);
}

}  // namespace sinew::study
