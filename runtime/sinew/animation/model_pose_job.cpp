#include "sinew/animation/model_pose_job.h"

namespace sinew {

template <class T>
Status ModelPoseJob<T>::Validate() const {
  if (jets.empty() == poses.empty())
    return Status::error(Code::kInvalidArgument, "needs either jets or poses");
  if (std::max(jets.size(), poses.size()) < model.size() || parents.size() < model.size())
    return Status::error(Code::kInvalidArgument, "fewer joints or parents than the output");
  for (int i = 0; i < static_cast<int>(model.size()); ++i)
    if (parents[i] < -1 || parents[i] >= i)
      return Status::error(Code::kInvalidArgument, "parent does not come before its joint", i);
  return {};
}

template <class T>
Status ModelPoseJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  for (std::size_t i = 0; i < model.size(); ++i) {
    const Transform<T> local = jets.empty() ? poses[i] : Transform<T>{jets[i].rotation, jets[i].translation};
    model[i] = (parents[i] < 0 ? root : model[parents[i]]) * local;
  }
  return {};
}

template struct ModelPoseJob<float>;
template struct ModelPoseJob<double>;

}  // namespace sinew
