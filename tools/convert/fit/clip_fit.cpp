#include "convert/fit/clip_fit.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include "sinew/animation/bspline.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::convert {
namespace {

constexpr double kVirtualVertex = 0.1;  ///< m from the joint: what an angle error is worth in millimetres
constexpr double kSmoothing = 1e-9;     ///< settles the controls that no sample determines

/// Basis matrix of one knot spacing, factorised once for all joints.
class KnotGrid {
 public:
  KnotGrid(int frames, int stride, int degree, bool loops) {
    const int intervals = std::max(1, frames - 1);
    spans_ = std::max(1, (intervals + stride - 1) / stride);
    if (loops) spans_ = std::max(spans_, degree + 1);
    controls_ = loops ? spans_ : spans_ + degree;
    const int rows = loops ? intervals : frames;  // the last frame of a loop is its first
    std::vector<Eigen::Triplet<double>> entries;
    for (int f = 0; f < rows; ++f) {
      const double knots = double(f) / intervals * spans_;
      const int span = std::min(static_cast<int>(knots), spans_ - 1);
      const auto w = BsplineBasis<double>::at(degree, knots - span).value;
      for (int j = 0; j <= degree; ++j) entries.emplace_back(f, (span + j) % controls_, w[j]);
    }
    basis_.resize(rows, controls_);
    basis_.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseMatrix<double> normal = basis_.transpose() * basis_;
    std::vector<Eigen::Triplet<double>> third;
    const int differences = loops ? controls_ : controls_ - 3;
    for (int i = 0; i < differences; ++i) {
      constexpr double stencil[4] = {-1, 3, -3, 1};
      for (int a = 0; a < 4; ++a) third.emplace_back(i, (i + a) % controls_, stencil[a]);
    }
    Eigen::SparseMatrix<double> roughness(differences, controls_);
    roughness.setFromTriplets(third.begin(), third.end());
    normal += kSmoothing * Eigen::SparseMatrix<double>(roughness.transpose() * roughness);
    solver_.compute(normal);
  }

  Eigen::MatrixXd fit(const Eigen::MatrixXd& samples) const {
    return solver_.solve(basis_.transpose() * samples.topRows(basis_.rows()));
  }
  Eigen::MatrixXd evaluate(const Eigen::MatrixXd& controls) const { return basis_ * controls; }
  int controls() const { return controls_; }
  int spans() const { return spans_; }

 private:
  int spans_ = 0, controls_ = 0;
  Eigen::SparseMatrix<double> basis_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

/// Sign-aligned quaternions of one joint, [frame][x y z w].
Eigen::MatrixXd rotation_samples(const FitInput& input, int joint) {
  Eigen::MatrixXd samples(input.samples.size(), 4);
  for (std::size_t f = 0; f < input.samples.size(); ++f) {
    Eigen::Vector4d q = input.samples[f][joint].rotation.coeffs();
    if (f > 0 && q.dot(samples.row(f - 1).transpose()) < 0) q = -q;
    samples.row(f) = q.transpose();
  }
  return samples;
}

double angle_between(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  const double cosine = std::min(1.0, std::abs(a.normalized().dot(b.normalized())));
  return 2 * std::acos(cosine);
}

struct Fitted {
  bool moves = false;
  int stride = 1;
  Eigen::MatrixXd controls;
  double max_mm = 0, sum_mm2 = 0;
  int count = 0;
};

}  // namespace

Clip fit_clip(const FitInput& input, const FitOptions& options, FitReport& report) {
  const int frames = static_cast<int>(input.samples.size());
  const int joints = static_cast<int>(input.samples.front().size());
  Clip clip;
  clip.name = input.name;
  clip.joint_count = joints;
  clip.duration = static_cast<float>((frames - 1) / input.sample_rate);
  clip.loops = input.loops && frames > 6;
  for (int j = 0; j < joints; ++j) clip.constants.push_back(input.samples[0][j].cast<float>());
  report = {};
  report.joints.resize(joints);
  if (frames < 2) return clip;

  Vec3<double> step = Vec3<double>::Zero();
  if (clip.loops) step = input.samples.back()[0].translation - input.samples.front()[0].translation;
  clip.root_step = step.cast<float>();

  std::map<int, std::unique_ptr<KnotGrid>> grids;
  const auto grid = [&](int stride) -> const KnotGrid& {
    auto& made = grids[stride];
    if (!made) made = std::make_unique<KnotGrid>(frames, stride, options.degree, clip.loops);
    return *made;
  };
  const auto fit = [&](const Eigen::MatrixXd& samples, auto error_mm) {
    Fitted best;
    for (int stride = options.coarsest; stride >= 1; --stride) {
      const KnotGrid& knots = grid(stride);
      best = {true, stride, knots.fit(samples)};
      const Eigen::MatrixXd fitted = knots.evaluate(best.controls);
      for (int f = 0; f < fitted.rows(); ++f) {
        const double mm = error_mm(fitted.row(f), samples.row(f));
        best.max_mm = std::max(best.max_mm, mm);
        best.sum_mm2 += mm * mm;
        ++best.count;
      }
      if (best.max_mm <= options.max_error_mm) break;
    }
    return best;
  };

  struct Key {
    bool rotation;
    int stride;
    bool operator<(const Key& o) const { return std::tie(rotation, stride) < std::tie(o.rotation, o.stride); }
  };
  std::map<Key, std::vector<std::pair<int, Eigen::MatrixXd>>> groups;
  double sum = 0;
  int count = 0;
  for (int j = 0; j < joints; ++j) {
    const Eigen::MatrixXd turned = rotation_samples(input, j);
    Eigen::MatrixXd shifted(frames, 3);
    for (int f = 0; f < frames; ++f) {
      shifted.row(f) = input.samples[f][j].translation.transpose();
      if (j == 0) shifted.row(f) -= (double(f) / (frames - 1) * step).transpose();
    }
    double turns = 0, shifts = 0;
    for (int f = 1; f < frames; ++f) {
      turns = std::max(turns, angle_between(turned.row(f).transpose(), turned.row(0).transpose()));
      shifts = std::max(shifts, (shifted.row(f) - shifted.row(0)).norm());
    }
    FitReport::Joint& r = report.joints[j];
    const auto add = [&](bool rotation, const Fitted& fitted) {
      groups[{rotation, fitted.stride}].push_back({j, fitted.controls});
      r.max_mm = std::max(r.max_mm, fitted.max_mm);
      r.rms_mm = std::max(r.rms_mm, std::sqrt(fitted.sum_mm2 / std::max(1, fitted.count)));
      sum += fitted.sum_mm2;
      count += fitted.count;
    };
    if (turns > 1e-6)
      add(true, fit(turned, [](const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
            return 1000 * kVirtualVertex * angle_between(a.transpose(), b.transpose());
          }));
    if (1000 * shifts > options.still_mm || (j == 0 && shifts > 1e-6))
      add(false, fit(shifted, [](const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
            return 1000 * (a - b).norm();
          }));
    report.max_mm = std::max(report.max_mm, r.max_mm);
  }
  report.rms_mm = count > 0 ? std::sqrt(sum / count) : 0;

  for (const auto& [key, tracks] : groups) {
    const KnotGrid& knots = grid(key.stride);
    Clip::Group group;
    group.rotation = key.rotation;
    group.degree = options.degree;
    group.knot_interval = clip.duration / static_cast<float>(knots.spans());
    group.control_count = knots.controls();
    for (const auto& [joint, controls] : tracks) group.tracks.push_back({joint});
    for (int c = 0; c < knots.controls(); ++c)
      for (const auto& [joint, controls] : tracks)
        for (int a = 0; a < controls.cols(); ++a)
          group.controls.push_back(static_cast<float>(controls(c, a)));
    clip.groups.push_back(std::move(group));
  }
  return clip;
}

}  // namespace sinew::convert
