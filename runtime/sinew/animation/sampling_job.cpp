#include "sinew/animation/sampling_job.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/bspline.h"

namespace sinew {
namespace {

/// Time within the clip and how many whole loops came before it.
struct Place {
  double time = 0, loops = 0;
};

Place wrapped(const Clip& clip, double time) {
  if (clip.duration <= 0) return {};
  if (!clip.loops) return {std::clamp(time, 0.0, double(clip.duration)), 0};
  const double loops = std::floor(time / clip.duration);
  return {std::clamp(time - loops * clip.duration, 0.0, double(clip.duration)), loops};
}

/// Weighted sums of one group's control points: p, p', p'' of every track, `Components` floats each.
template <int Components, class T, class Use>
void sample_group(const Clip& clip, const Clip::Group& group, double time, double rate, std::size_t joints,
                  Use use) {
  using Controls = Eigen::Map<const Eigen::Matrix<float, Components, 1>>;
  using Sum = Eigen::Matrix<T, Components, 1>;
  const double knots = time / group.knot_interval;
  const int spans = clip.loops ? group.control_count : group.control_count - group.degree;
  const int span = std::clamp(static_cast<int>(knots), 0, spans - 1);
  BsplineBasis<T> w = BsplineBasis<T>::at(group.degree, T(std::clamp(knots - span, 0.0, 1.0)));
  const T scale = T(rate / group.knot_interval);
  for (int j = 0; j <= group.degree; ++j) {
    w.first[j] *= scale;
    w.second[j] *= scale * scale;
  }
  const std::size_t stride = Components * group.tracks.size();
  const float* rows[6] = {};
  for (int j = 0; j <= group.degree; ++j)
    rows[j] = group.controls.data() + stride * ((span + j) % group.control_count);
  for (std::size_t k = 0; k < group.tracks.size(); ++k) {
    const std::size_t joint = group.tracks[k].joint;
    if (joint >= joints) continue;
    Sum p = Sum::Zero(), dp = Sum::Zero(), ddp = Sum::Zero();
    for (int j = 0; j <= group.degree; ++j) {
      const Sum c = Controls(rows[j] + Components * k).template cast<T>();
      p += w.value[j] * c;
      dp += w.first[j] * c;
      ddp += w.second[j] * c;
    }
    use(joint, p, dp, ddp);
  }
}

}  // namespace

template <class T>
Status SamplingJob<T>::Validate() const {
  if (!clip) return Status::error(Code::kInvalidArgument, "no clip");
  if (!std::isfinite(time) || !std::isfinite(rate))
    return Status::error(Code::kNotFinite, "time or rate is not finite");
  if (std::abs(time) > 1e9 || std::abs(rate) > 1e4)
    return Status::error(Code::kOutOfRange, "time or rate is absurd");
  return {};
}

template <class T>
Status SamplingJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  const std::size_t count = std::min(jets.size(), std::size_t(clip->joint_count));
  for (std::size_t i = 0; i < count; ++i) {
    jets[i] = {};
    jets[i].rotation = clip->constants[i].rotation.template cast<T>().normalized();
    jets[i].translation = clip->constants[i].translation.template cast<T>();
  }
  const Place place = wrapped(*clip, time);
  const bool held = !clip->loops && (time < 0 || time > clip->duration);  // a clamped pose stands still
  const double speed = held ? 0.0 : rate;
  for (const Clip::Group& group : clip->groups) {
    if (group.rotation) {
      using Vec4 = Eigen::Matrix<T, 4, 1>;
      sample_group<4, T>(*clip, group, place.time, speed, count,
                         [&](std::size_t joint, const Vec4& p, const Vec4& dp, const Vec4& ddp) {
                           // 2·Im(p̄ p')/n; any common scale of the controls cancels.
                           const T inverse = T(1) / p.squaredNorm();
                           const auto twice_imaginary = [&](const Vec4& d) {
                             const Vec3<T> a = p.template head<3>(), b = d.template head<3>();
                             return Vec3<T>((T(2) * inverse) * (p[3] * b - d[3] * a - a.cross(b)));
                           };
                           JointJet<T>& jet = jets[joint];
                           jet.rotation.coeffs() = p * std::sqrt(inverse);
                           jet.omega = twice_imaginary(dp);
                           jet.alpha = twice_imaginary(ddp) - jet.omega * (T(2) * inverse * p.dot(dp));
                         });
    } else {
      sample_group<3, T>(*clip, group, place.time, speed, count,
                         [&](std::size_t joint, const Vec3<T>& p, const Vec3<T>& dp, const Vec3<T>& ddp) {
                           jets[joint].translation = p;
                           jets[joint].velocity = dp;
                           jets[joint].acceleration = ddp;
                         });
    }
  }
  if (count > 0 && clip->loops && clip->duration > 0) {
    const Vec3<double> step = clip->root_step.template cast<double>();
    jets[0].translation += (step * (place.loops + place.time / clip->duration)).template cast<T>();
    jets[0].velocity += (step * (speed / clip->duration)).template cast<T>();
  }
  return {};
}

template struct SamplingJob<float>;
template struct SamplingJob<double>;

}  // namespace sinew
