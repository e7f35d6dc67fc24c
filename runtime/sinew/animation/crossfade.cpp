#include "sinew/animation/crossfade.h"

namespace sinew {

template <class T>
void crossfade(std::span<const JointJet<T>> a, std::span<const JointJet<T>> b, const EaseWeight<T>& w,
               std::span<JointJet<T>> out, std::span<const Transform<T>> rest) {
  const BlendLayer<T> layers[] = {{a}, {b, w, {}, BlendMode::kOverride}};
  (void)BlendingJob<T>{layers, rest, out}.Run();
}

template void crossfade<float>(std::span<const JointJet<float>>, std::span<const JointJet<float>>,
                               const EaseWeight<float>&, std::span<JointJet<float>>,
                               std::span<const Transform<float>>);
template void crossfade<double>(std::span<const JointJet<double>>, std::span<const JointJet<double>>,
                                const EaseWeight<double>&, std::span<JointJet<double>>,
                                std::span<const Transform<double>>);

}  // namespace sinew
