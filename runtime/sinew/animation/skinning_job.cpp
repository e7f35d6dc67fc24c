#include "sinew/animation/skinning_job.h"

#include <algorithm>

namespace sinew {

void skinning_palette(std::span<const Transform<float>> model, std::span<const Transform<float>> bind,
                      std::span<SkinMatrix> palette) {
  for (std::size_t i = 0; i < palette.size(); ++i) {
    const Transform<float> moved = model[i] * bind[i].inverse();
    const Mat3<float> rotation = moved.rotation.toRotationMatrix();
    for (int c = 0; c < 3; ++c) palette[i].axes[c] << rotation.col(c), 0;
    palette[i].origin << moved.translation, 0;
  }
}

Status SkinningJob::Validate() const {
  if (influences < 1) return Status::error(Code::kInvalidArgument, "no influences per vertex");
  if (out_positions.size() % 3 != 0 || out_normals.size() % 3 != 0)
    return Status::error(Code::kInvalidArgument, "output is not whole vertices");
  const std::size_t vertices = std::max(out_positions.size(), out_normals.size()) / 3;
  const std::size_t pairs = vertices * influences;
  if (joints.size() < pairs || weights.size() < pairs || positions.size() < out_positions.size() ||
      normals.size() < out_normals.size())
    return Status::error(Code::kInvalidArgument, "mesh has fewer vertices than the output");
  std::uint16_t last = 0;
  for (std::size_t i = 0; i < pairs; ++i) last = std::max(last, joints[i]);
  if (pairs == 0 || last < palette.size()) return {};
  const auto at =
      std::find_if(joints.begin(), joints.end(), [&](int joint) { return joint >= int(palette.size()); });
  return Status::error(Code::kOutOfRange, "vertex hangs on a joint beyond the palette",
                       int(at - joints.begin()) / influences);
}

Status SkinningJob::Run() const {
  if (Status status = Validate(); !status) return status;
  const std::size_t placed = out_positions.size() / 3, turned = out_normals.size() / 3;
  for (std::size_t i = 0; i < std::max(placed, turned); ++i) {
    const std::uint16_t* joint = joints.data() + i * influences;
    const float* weight = weights.data() + i * influences;
    SkinMatrix blend = palette[joint[0]];
    for (Eigen::Vector4f& axis : blend.axes) axis *= weight[0];
    blend.origin *= weight[0];
    for (int k = 1; k < influences; ++k) {
      const SkinMatrix& bone = palette[joint[k]];
      for (int c = 0; c < 3; ++c) blend.axes[c] += weight[k] * bone.axes[c];
      blend.origin += weight[k] * bone.origin;
    }
    const auto rotated = [&](const float* x) -> Eigen::Vector4f {
      return blend.axes[0] * x[0] + blend.axes[1] * x[1] + blend.axes[2] * x[2];
    };
    if (i < placed) {
      const Eigen::Vector4f position = rotated(positions.data() + 3 * i) + blend.origin;
      std::copy_n(position.data(), 3, out_positions.data() + 3 * i);
    }
    if (i < turned) {
      const Eigen::Vector4f normal = rotated(normals.data() + 3 * i).normalized();
      std::copy_n(normal.data(), 3, out_normals.data() + 3 * i);
    }
  }
  return {};
}

}  // namespace sinew
