#include "sinew/animation/model_motion_job.h"

namespace sinew {

template <class T>
Status ModelMotionJob<T>::Validate() const {
  if (jets.size() < model.size() || parents.size() < model.size())
    return Status::error(Code::kInvalidArgument, "fewer joints or parents than the output");
  for (int i = 0; i < static_cast<int>(model.size()); ++i)
    if (parents[i] < -1 || parents[i] >= i)
      return Status::error(Code::kInvalidArgument, "parent does not come before its joint", i);
  return {};
}

template <class T>
Status ModelMotionJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  for (std::size_t i = 0; i < model.size(); ++i)
    model[i] = (parents[i] < 0 ? root : model[std::size_t(parents[i])]) * moving_transform(jets[i]);
  return {};
}

template struct ModelMotionJob<float>;
template struct ModelMotionJob<double>;

}  // namespace sinew
