// Jets and poses as the kernels see them.
#pragma once

#include <cstddef>

#include "sinew/animation/clip.h"
#include "sinew/animation/kernels/kernels.h"

namespace sinew::kernels {

template <class T>
constexpr bool kLayoutsAgree = sizeof(JointJet<T>) == sizeof(JetLayout<T>) &&
                               sizeof(Transform<T>) == sizeof(PoseLayout<T>) &&
                               offsetof(JointJet<T>, omega) == offsetof(JetLayout<T>, omega) &&
                               offsetof(JointJet<T>, alpha) == offsetof(JetLayout<T>, alpha) &&
                               offsetof(JointJet<T>, translation) == offsetof(JetLayout<T>, translation) &&
                               offsetof(JointJet<T>, velocity) == offsetof(JetLayout<T>, velocity) &&
                               offsetof(JointJet<T>, acceleration) == offsetof(JetLayout<T>, acceleration) &&
                               offsetof(Transform<T>, translation) == offsetof(PoseLayout<T>, translation);
static_assert(kLayoutsAgree<float> && kLayoutsAgree<double>);

template <class T>
JetLayout<T>* layout(JointJet<T>* jets) {
  return reinterpret_cast<JetLayout<T>*>(jets);
}
template <class T>
const JetLayout<T>* layout(const JointJet<T>* jets) {
  return reinterpret_cast<const JetLayout<T>*>(jets);
}
template <class T>
PoseLayout<T>* layout(Transform<T>* poses) {
  return reinterpret_cast<PoseLayout<T>*>(poses);
}
template <class T>
const PoseLayout<T>* layout(const Transform<T>* poses) {
  return reinterpret_cast<const PoseLayout<T>*>(poses);
}

/// The kernel of this processor.
#if defined(__x86_64__) && !defined(SINEW_BASELINE_ONLY)
#define SINEW_DISPATCH(call) (kernels::has_avx2() ? kernels::avx2::call : kernels::baseline::call)
#else
#define SINEW_DISPATCH(call) kernels::baseline::call
#endif

}  // namespace sinew::kernels
