#include "convert/fit/fitted_track.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "sinew/animation/clip_packing.h"

namespace sinew::convert {
namespace {

/// Farthest from its reference that a rotation is stored with three numbers, which are tan(angle / 2) there
/// and grow without bound at half a turn.
constexpr double kWidest = 2.0;  // rad

/// Finest numbers of a rotation: 3e-5 rad where one component spans a radian.
constexpr int kRotationBits = 16, kTranslationBits = 24;

/// The rotation in the middle of a motion: the principal axis of its quaternions, which does not care about
/// their signs. Markley et al., "Averaging quaternions", 2007.
Quat<double> middle(const JointMotion& motion) {
  Eigen::Matrix4d spread = Eigen::Matrix4d::Zero();
  for (const Transform<double>& x : motion) spread += x.rotation.coeffs() * x.rotation.coeffs().transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(spread);
  return Quat<double>(Eigen::Vector4d(solver.eigenvectors().col(3)));
}

double angle_between(const Quat<double>& a, const Quat<double>& b) {
  return 2 * std::acos(std::min(1.0, std::abs(a.coeffs().dot(b.coeffs()))));
}

/// Finest step at which numbers up to `largest` stay within so many bits.
int finest_step_of(double largest, int bits) {
  int step = 0;
  while (step + 1 < kPackingSteps && largest / packing_step(step + 1) < double(1 << (bits - 1)) - 2) ++step;
  return step;
}

}  // namespace

double largest_turn(const JointMotion& motion) {
  double most = 0;
  for (const Transform<double>& x : motion)
    most = std::max(most, angle_between(x.rotation, motion.front().rotation));
  return most;
}
double largest_shift(const JointMotion& motion) {
  double most = 0;
  for (const Transform<double>& x : motion)
    most = std::max(most, (x.translation - motion.front().translation).norm());
  return most;
}

FittedTrack::FittedTrack(int joint, bool rotation, const JointMotion& motion)
    : joint_(joint), rotation_(rotation) {
  const auto frames = static_cast<Eigen::Index>(motion.size());
  if (!rotation) {
    samples_.resize(frames, 3);
    for (Eigen::Index f = 0; f < frames; ++f)
      samples_.row(f) = motion[std::size_t(f)].translation.transpose();
    finest_step_ = finest_step_of(samples_.cwiseAbs().maxCoeff(), kTranslationBits);
    return;
  }
  const Quat<double> mean = middle(motion);
  double widest = 0;
  for (const Transform<double>& x : motion) widest = std::max(widest, angle_between(mean, x.rotation));
  packing_.components = widest < kWidest ? 3 : 4;
  for (int c = 0; c < 4; ++c)
    packing_.reference[c] = static_cast<std::int8_t>(std::lround(127 * mean.coeffs()[c]));
  if (packing_.components == 3)
    for (int c = 0; c < 4; ++c) reference_.coeffs()[c] = packing_.reference[c] / 127.0;
  samples_.resize(frames, packing_.components);
  Eigen::Vector4d before = Eigen::Vector4d::Zero();
  for (Eigen::Index f = 0; f < frames; ++f) {
    Eigen::Vector4d q = motion[std::size_t(f)].rotation.coeffs();
    if (packing_.components == 3) {
      q = (reference_.conjugate() * Quat<double>(q)).coeffs();
      samples_.row(f) = (q.head<3>() / q[3]).transpose();
    } else {
      if (q.dot(before) < 0) q = -q;
      before = q;
      samples_.row(f) = q.transpose();
    }
  }
  finest_step_ = finest_step_of(std::max(1.0, samples_.cwiseAbs().maxCoeff()), kRotationBits);
}

void FittedTrack::fit(const KnotGrid& grid) {
  controls_ = grid.fit(samples_);
  smooth_ = grid.evaluate(controls_);
}

Eigen::MatrixXd FittedTrack::accelerations(const KnotGrid& grid, double interval) const {
  const double scale = (rotation_ ? 2 : 1) / (interval * interval);
  return scale * grid.evaluate_second(grid.fit(samples_));
}

void FittedTrack::round(const KnotGrid& grid, int step) {
  packing_.step = static_cast<std::uint8_t>(std::min(step, finest_step_));
  const double unit = packing_step(packing_.step);
  const Eigen::MatrixXd whole = (controls_ / unit).array().round();
  numbers_ = whole.cast<int>();
  rounded_ = grid.evaluate(unit * whole);
  moves_ = false;
  std::size_t bits = 0;
  for (Eigen::Index c = 0; c < numbers_.cols(); ++c) {
    moves_ |= (numbers_.col(c).array() != numbers_(0, c)).any();
    bits += packed_bits({numbers_.col(c).data(), std::size_t(numbers_.rows())});
  }
  bits_ = double(bits);
}

void FittedTrack::append_control(int index, std::vector<float>& out) const {
  std::int32_t numbers[4] = {};
  for (Eigen::Index c = 0; c < numbers_.cols(); ++c) numbers[c] = numbers_(index, c);
  float control[4] = {};
  unpack_control(packing_, rotation_, numbers, control);
  out.insert(out.end(), control, control + (rotation_ ? 4 : 3));
}

std::vector<Eigen::Vector4f> FittedTrack::smooth_controls(const KnotGrid& grid) const {
  const Eigen::MatrixXd fitted = grid.fit(samples_);
  std::vector<Eigen::Vector4f> out;
  for (Eigen::Index i = 0; i < fitted.rows(); ++i) {
    Eigen::Vector4d control(fitted(i, 0), fitted(i, 1), fitted(i, 2), 1);
    if (packing_.components == 4) control[3] = fitted(i, 3);
    if (rotation_) control = (reference_ * Quat<double>(control)).coeffs();
    out.emplace_back(control.cast<float>());
  }
  return out;
}

void FittedTrack::value(const Eigen::MatrixXd& curve, int frame, Transform<double>& out) const {
  if (!rotation_)
    out.translation = curve.row(frame).transpose();
  else if (packing_.components == 4)
    out.rotation = Quat<double>(Eigen::Vector4d(curve.row(frame).transpose())).normalized();
  else
    out.rotation =
        (reference_ * Quat<double>(1, curve(frame, 0), curve(frame, 1), curve(frame, 2))).normalized();
}

}  // namespace sinew::convert
