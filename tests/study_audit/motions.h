// Motions whose energies and momenta are known in closed form, or to far more digits than is asked for.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "study/audit/books.h"

namespace sinew::audit {

constexpr double kPi = 3.14159265358979323846;

/// Pose of a body at a time, s.
using Path = std::function<Transform<double>(double)>;

inline Eigen::Quaterniond turn(const Eigen::Vector3d& by) {
  const double angle = by.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, by / angle))
                   : Eigen::Quaterniond::Identity();
}

inline Member one_body(double mass, const Eigen::Vector3d& moments) {
  Body body;
  body.mass = mass;
  body.inertia = moments.asDiagonal();
  Member member;
  member.bodies.push_back(body);
  member.dofs = 6;
  return member;
}

/// Books of a single body along a path, `steps` of h seconds; `work` is asked for what was put in between two
/// times.
inline Books books_of(const Member& member, const Path& path, double h, int steps,
                      const Eigen::Vector3d& gravity = Eigen::Vector3d::Zero(),
                      const std::function<double(double, double)>& work = {}) {
  constexpr double kSpan = 1e-5;
  Books books(gravity, 1e-16);
  const std::vector<Transform<double>> before{path(-kSpan)}, now{path(0)}, after{path(kSpan)};
  books.add(member, before, now, after, kSpan);
  for (int n = 0; n < steps; ++n) {
    const double from = n * h, to = (n + 1) * h;
    books.record(h, {path(to)}, work ? work(from, to) : 0);
  }
  return books;
}

/// Torque-free rotation of a body with two equal moments (a, a, c) from ω in its own axes: it turns about its
/// momentum at L/a and about its own third axis the rest.
inline Path symmetric_top(double a, double c, const Eigen::Vector3d& omega) {
  const Eigen::Vector3d momentum(a * omega.x(), a * omega.y(), c * omega.z());
  const Eigen::Vector3d own(0, 0, omega.z() * (1 - c / a));
  return [=](double t) {
    return Transform<double>{turn(momentum * (t / a)) * turn(own * t), Eigen::Vector3d::Zero()};
  };
}

/// Torque-free rotation of any body, by Runge and Kutta's method in steps of 10 µs, at every h seconds.
inline std::vector<Transform<double>> euler_top(const Eigen::Vector3d& moments, Eigen::Vector3d omega,
                                                double h, int steps) {
  constexpr double kFine = 1e-5;
  const auto rate = [&](const Eigen::Vector3d& w) -> Eigen::Vector3d {
    return moments.cwiseProduct(w).cross(w).cwiseQuotient(moments);
  };
  std::vector<Transform<double>> poses(1);
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  const auto spin = [](const Eigen::Quaterniond& at, const Eigen::Vector3d& w) {
    Eigen::Quaterniond d = at * Eigen::Quaterniond(0, w.x(), w.y(), w.z());
    d.coeffs() *= 0.5;
    return d;
  };
  const auto moved = [](Eigen::Quaterniond at, const Eigen::Quaterniond& d, double t) {
    at.coeffs() += t * d.coeffs();
    return at;
  };
  const int parts = static_cast<int>(std::lround(h / kFine));
  for (int n = 0; n < steps; ++n) {
    for (int k = 0; k < parts; ++k) {
      const Eigen::Vector3d w1 = rate(omega), w2 = rate(omega + kFine / 2 * w1),
                            w3 = rate(omega + kFine / 2 * w2), w4 = rate(omega + kFine * w3);
      const Eigen::Quaterniond q1 = spin(q, omega),
                               q2 = spin(moved(q, q1, kFine / 2), omega + kFine / 2 * w1),
                               q3 = spin(moved(q, q2, kFine / 2), omega + kFine / 2 * w2),
                               q4 = spin(moved(q, q3, kFine), omega + kFine * w3);
      q.coeffs() += kFine / 6 * (q1.coeffs() + 2 * q2.coeffs() + 2 * q3.coeffs() + q4.coeffs());
      q.normalize();
      omega += kFine / 6 * (w1 + 2 * w2 + 2 * w3 + w4);
    }
    poses.push_back({q, Eigen::Vector3d::Zero()});
  }
  return poses;
}

/// Angle of a pendulum of length l (m) from rest at `start` rad, by Runge and Kutta's method in steps of 10
/// µs.
inline std::vector<double> pendulum(double l, double start, double h, int steps) {
  constexpr double kFine = 1e-5, kG = 9.81;
  const auto pull = [&](double a) { return -kG / l * std::sin(a); };
  double a = start, w = 0;
  std::vector<double> angles{a};
  const int parts = static_cast<int>(std::lround(h / kFine));
  for (int n = 0; n < steps; ++n) {
    for (int k = 0; k < parts; ++k) {
      const double a1 = w, w1 = pull(a), a2 = w + kFine / 2 * w1, w2 = pull(a + kFine / 2 * a1),
                   a3 = w + kFine / 2 * w2, w3 = pull(a + kFine / 2 * a2), a4 = w + kFine * w3,
                   w4 = pull(a + kFine * a3);
      a += kFine / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      w += kFine / 6 * (w1 + 2 * w2 + 2 * w3 + w4);
    }
    angles.push_back(a);
  }
  return angles;
}

/// Height of a ball that falls from `height` and comes back with the given share of its speed, bounce after
/// bounce (the last share for all that follow). At most 20 bounces.
inline Path bouncing(double height, const std::vector<double>& restitution) {
  return [=](double t) {
    constexpr double kG = 9.81;
    double speed = std::sqrt(2 * kG * height), z = height - kG * t * t / 2, at = speed / kG;
    for (std::size_t n = 0; t > at && n < 20; ++n) {
      speed *= restitution[std::min(n, restitution.size() - 1)];
      z = speed * (t - at) - kG * (t - at) * (t - at) / 2;
      at += 2 * speed / kG;
    }
    return Transform<double>{Eigen::Quaterniond::Identity(), {0, 0, z}};
  };
}

}  // namespace sinew::audit
