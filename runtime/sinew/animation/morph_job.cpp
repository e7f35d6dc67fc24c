#include "sinew/animation/morph_job.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr float kSmallest = 1e-4f;     ///< weight that still does something
constexpr float kLeastTilt = 1e-3f;    ///< of a normal
constexpr std::uint32_t kBridged = 3;  ///< vertices: a run costs about as much
constexpr float kLargestUnit = 32767;

bool active(float weight) {
  return std::abs(weight) >= kSmallest;
}

float largest_of(std::span<const float> numbers) {
  float largest = 0;
  for (const float x : numbers) largest = std::max(largest, std::abs(x));
  return largest;
}

/// Units of the numbers of all vertices in the runs.
void quantize(std::span<const float> numbers, std::span<const MorphRun> runs, float& scale,
              std::vector<std::int16_t>& out) {
  scale = largest_of(numbers) / kLargestUnit;
  out.clear();
  const float inverse = scale > 0 ? 1 / scale : 0;
  for (const MorphRun& run : runs)
    for (std::size_t i = 3 * std::size_t(run.first); i < 3 * std::size_t(run.first + run.count); ++i)
      out.push_back(static_cast<std::int16_t>(std::lround(numbers[i] * inverse)));
}

/// Calls work(first number of the vertices, first number of the deltas, numbers) for each run within `size`.
template <class Work>
void for_each_run(const MorphTarget& target, std::size_t size, const Work& work) {
  std::size_t delta = 0;
  for (const MorphRun& run : target.runs) {
    const std::size_t first = 3 * std::size_t(run.first), count = 3 * std::size_t(run.count);
    if (first >= size) return;
    work(first, delta, std::min(count, size - first));
    delta += count;
  }
}

void add(const MorphTarget& target, std::span<const std::int16_t> deltas, float factor,
         std::span<float> out) {
  for_each_run(target, out.size(), [&](std::size_t first, std::size_t delta, std::size_t count) {
    float* const to = out.data() + first;
    const std::int16_t* const from = deltas.data() + delta;
    for (std::size_t i = 0; i < count; ++i) to[i] += factor * static_cast<float>(from[i]);
  });
}

void normalize_touched(const MorphTarget& target, std::span<float> normals) {
  for_each_run(target, normals.size(), [&](std::size_t first, std::size_t, std::size_t count) {
    for (std::size_t i = first; i < first + count; i += 3) {
      float* const n = normals.data() + i;
      const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
      const float inverse = square > 0 ? 1 / std::sqrt(square) : 0;
      for (int k = 0; k < 3; ++k) n[k] *= inverse;
    }
  });
}

Status check(const MorphTarget& target, std::size_t vertices, int index) {
  std::size_t next = 0, touched = 0;
  for (const MorphRun& run : target.runs) {
    if (run.first < next || run.count > vertices || run.first > vertices - run.count)
      return Status::error(Code::kInvalidArgument, "runs are not in order, or beyond the mesh", index);
    next = std::size_t(run.first) + run.count;
    touched += run.count;
  }
  if (target.moves.size() != 3 * touched || (!target.tilts.empty() && target.tilts.size() != 3 * touched))
    return Status::error(Code::kInvalidArgument, "as many deltas as vertices in the runs are wanted", index);
  if (!std::isfinite(target.scale) || !std::isfinite(target.tilt_scale))
    return Status::error(Code::kNotFinite, "scale is not finite", index);
  return {};
}

}  // namespace

Status build_morph_target(std::span<const float> moves, std::span<const float> tilts, float least,
                          MorphTarget& out) {
  if (moves.size() % 3 != 0 || (!tilts.empty() && tilts.size() != moves.size()))
    return Status::error(Code::kInvalidArgument, "not three numbers a vertex, or not as many tilts");
  for (const std::span<const float>& numbers : {moves, tilts})
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (!std::isfinite(numbers[i]))
        return Status::error(Code::kNotFinite, "delta is not finite", static_cast<int>(i / 3));
  MorphTarget target;
  for (std::uint32_t v = 0; v < moves.size() / 3; ++v) {
    const auto size = [&](std::span<const float> numbers) {
      return numbers.empty() ? 0.f : std::hypot(numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]);
    };
    if (size(moves) < least && size(tilts) < kLeastTilt) continue;
    if (!target.runs.empty() && v <= target.runs.back().first + target.runs.back().count + kBridged)
      target.runs.back().count = v + 1 - target.runs.back().first;
    else
      target.runs.push_back({v, 1});
  }
  quantize(moves, target.runs, target.scale, target.moves);
  if (!tilts.empty()) quantize(tilts, target.runs, target.tilt_scale, target.tilts);
  out = std::move(target);
  return {};
}

Status MorphJob::Validate() const {
  if (out_positions.size() % 3 != 0 || out_normals.size() % 3 != 0)
    return Status::error(Code::kInvalidArgument, "output is not whole vertices");
  if (positions.size() < out_positions.size() || normals.size() < out_normals.size())
    return Status::error(Code::kInvalidArgument, "mesh has fewer vertices than the output");
  if (weights.size() < targets.size())
    return Status::error(Code::kInvalidArgument, "fewer weights than targets");
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const int index = static_cast<int>(k);
    if (!std::isfinite(weights[k])) return Status::error(Code::kNotFinite, "weight is not finite", index);
    if (Status status = check(targets[k], positions.size() / 3, index); !status) return status;
  }
  return {};
}

Status MorphJob::Run() const {
  if (Status status = Validate(); !status) return status;
  if (out_positions.data() != positions.data())
    std::copy_n(positions.begin(), out_positions.size(), out_positions.begin());
  if (out_normals.data() != normals.data())
    std::copy_n(normals.begin(), out_normals.size(), out_normals.begin());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (!active(weights[k])) continue;
    add(targets[k], targets[k].moves, weights[k] * targets[k].scale, out_positions);
    if (!targets[k].tilts.empty())
      add(targets[k], targets[k].tilts, weights[k] * targets[k].tilt_scale, out_normals);
  }
  for (std::size_t k = 0; k < targets.size(); ++k)
    if (active(weights[k]) && !targets[k].tilts.empty()) normalize_touched(targets[k], out_normals);
  return {};
}

}  // namespace sinew
