// SIMD kernels of the sampler and the blender: one source, compiled once for every machine and once for AVX2.
//
// Arguments are plain numbers and pointers: types whose alignment depends on the instruction set (Eigen's)
// must not cross into a translation unit that is compiled for another one. Both builds give the same bits:
// AVX2 is used without fused multiply-add, whose rounding a machine without it could not repeat. A third
// build with 16 lanes of AVX-512 was measured 12–15 % faster for 67 joints: not worth its weight.
#pragma once

namespace sinew::kernels {

/// Jets and poses as the kernels see them; the jobs assert that JointJet<T> and Transform<T> look like this.
template <class T>
struct JetLayout {
  T rotation[4], omega[3], alpha[3], translation[3], velocity[3], acceleration[3], padding;
};
template <class T>
struct PoseLayout {
  T rotation[4], translation[3], padding;
};

/// The control points that one group of tracks needs at an instant, and their weights.
template <class T>
struct SplineSpan {
  int terms = 0;                    ///< degree + 1: 4 or 6
  const float* rows[6] = {};        ///< [term] controls of all tracks, [track][component]
  T value[6], first[6], second[6];  ///< [term] weights of p, p' (1/s), p'' (1/s²)
  const int* joints = nullptr;      ///< [track]
  int tracks = 0;
  int joint_end = 0;  ///< joints from here on are left out
};

/// Layers of a blend, see BlendingJob.
template <class T>
struct BlendLayerData {
  enum Mode { kMix, kOverride, kAdditive };
  const JetLayout<T>* jets = nullptr;
  const T* mask = nullptr;  ///< [joint], or null for 1
  T weight[3] = {1, 0, 0};  ///< value, 1/s, 1/s²
  Mode mode = kMix;
  const PoseLayout<T>* reference = nullptr;  ///< what an additive one differs from; null: it is a difference
};
template <class T>
struct BlendData {
  const BlendLayerData<T>* layers = nullptr;
  int layer_count = 0;
  const PoseLayout<T>* rest = nullptr;  ///< or null for the identity
};

constexpr int kOffsetBlock = 16;  ///< joints whose offsets stand side by side

/// Offsets of all joints, [block][value, rate, acceleration][x y z][kOffsetBlock]: of rotations as modified
/// Rodrigues parameters, of translations in metres.
template <class T>
struct OffsetNumbers {
  T *rotations = nullptr, *translations = nullptr;
  int translated = 0;  ///< joints with an offset of their translation, the first ones
};
template <class T>
struct OffsetFade {
  OffsetNumbers<T> offsets;
  T elapsed = 0, duration = 0;  ///< s
  const T* profile = nullptr;   ///< [joint] part of the duration, or null for 1
};
/// What a unit of rate and of acceleration at the start have become: displacement, rate, acceleration.
template <class T>
struct Extrapolation {
  T of_rate[3], of_acceleration[3];
};

/// `constants`: what joints without a track keep. `rotations`, `translations`: the joints of one group.
#define SINEW_KERNELS_OF(T, Out)                                           \
  void constants(const PoseLayout<float>* poses, int joints, Out<T>* out); \
  void rotations(const SplineSpan<T>& span, Out<T>* out);                  \
  void translations(const SplineSpan<T>& span, Out<T>* out);
/// `start_offsets`: how far a motion is from another. `add_offsets`: what is left of it, added to the other.
/// `extrapolate`: a motion that goes on from an instant, more and more slowly.
#define SINEW_OFFSET_KERNELS_OF(T)                                                                    \
  void start_offsets(const JetLayout<T>* from, const JetLayout<T>* to, int joints,                    \
                     const OffsetNumbers<T>& out);                                                    \
  void add_offsets(const JetLayout<T>* to, const OffsetFade<T>& fade, int joints, JetLayout<T>* out); \
  void extrapolate(const JetLayout<T>* from, const Extrapolation<T>& data, int joints, JetLayout<T>* out);
#define SINEW_ALL_KERNELS                                                        \
  SINEW_KERNELS_OF(float, JetLayout)                                             \
  SINEW_KERNELS_OF(float, PoseLayout)                                            \
  SINEW_KERNELS_OF(double, JetLayout)                                            \
  SINEW_KERNELS_OF(double, PoseLayout)                                           \
  void blend(const BlendData<float>& data, int joints, JetLayout<float>* out);   \
  void blend(const BlendData<double>& data, int joints, JetLayout<double>* out); \
  SINEW_OFFSET_KERNELS_OF(float)                                                 \
  SINEW_OFFSET_KERNELS_OF(double)
namespace baseline {
SINEW_ALL_KERNELS
}
namespace avx2 {
SINEW_ALL_KERNELS
}

/// Whether this processor runs the avx2 kernels (a load and a test; no set-up, no lock).
inline bool has_avx2() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

}  // namespace sinew::kernels
