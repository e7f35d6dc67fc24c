#include "convert/fit/chain_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew::convert {

ChainError::ChainError(const std::vector<std::vector<Transform<double>>>& reference, std::vector<int> parents,
                       double distance)
    : frames_(static_cast<int>(reference.size())), distance_(distance), parents_(std::move(parents)) {
  const std::size_t joints = reference.front().size();
  parents_.resize(joints, -1);
  truth_.assign(joints, JointMotion(reference.size()));
  for (std::size_t j = 0; j < joints; ++j)
    for (std::size_t f = 0; f < reference.size(); ++f) truth_[j][f] = reference[f][j];
  truth_model_ = local_ = truth_;
  for (std::size_t j = 0; j < joints; ++j)
    for (std::size_t f = 0; f < reference.size() && parents_[j] >= 0; ++f)
      truth_model_[j][f] = truth_model_[std::size_t(parents_[j])][f] * truth_[j][f];
  model_ = truth_model_;
  error_.assign(joints, std::vector<double>(reference.size(), 0));
}

void ChainError::set(int joint, JointMotion local) {
  local_[joint] = std::move(local);
}

void ChainError::compare(int joint) {
  const int parent = parents_[joint];
  for (int f = 0; f < frames_; ++f) {
    Transform<double>& now = model_[joint][f];
    now = parent < 0 ? local_[joint][f] : model_[parent][f] * local_[joint][f];
    const Transform<double>& truth = truth_model_[joint][f];
    const Eigen::Matrix3d turned =
        distance_ * (now.rotation.toRotationMatrix() - truth.rotation.toRotationMatrix());
    const Vec3<double> shifted = now.translation - truth.translation;
    double square = 0;
    for (int a = 0; a < 3; ++a) square = std::max(square, (shifted + turned.col(a)).squaredNorm());
    error_[joint][f] = std::sqrt(square);
  }
}

void ChainError::update(int joint) {
  for (int j = joint; j < joints(); ++j)
    if (is_above(joint, j)) compare(j);
}

void ChainError::update() {
  for (int j = 0; j < joints(); ++j) compare(j);
}

int ChainError::worst_frame(int joint) const {
  const std::vector<double>& of = error_[joint];
  return static_cast<int>(std::max_element(of.begin(), of.end()) - of.begin());
}

bool ChainError::is_above(int joint, int other) const {
  while (other > joint) other = parents_[other];
  return other == joint;
}

double ChainError::largest() const {
  double most = 0;
  for (int j = 0; j < joints(); ++j) most = std::max(most, error_[j][worst_frame(j)]);
  return most;
}

double ChainError::rms(int joint) const {
  double sum = 0;
  for (const double e : error_[joint]) sum += e * e;
  return std::sqrt(sum / frames_);
}

double ChainError::rms() const {
  double sum = 0;
  for (int j = 0; j < joints(); ++j) sum += rms(j) * rms(j);
  return std::sqrt(sum / joints());
}

}  // namespace sinew::convert
