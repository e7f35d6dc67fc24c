// Calls one animation job so many times, for callgrind to count: the difference between two runs is the
// calls' own. 67 joints, float.
//
//     animation_count sample|blend|inertialize|begin CALLS
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "fixtures/clips.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/sampling_job.h"

int main(int argc, char** argv) {
  using namespace sinew;
  const std::string job = argc == 3 ? argv[1] : "";
  const int calls = argc == 3 ? std::atoi(argv[2]) : 0;
  const Clip clip = fixtures::random_clip({});
  constexpr int kJoints = 67, kShifting = 1;
  std::vector<JointJet<float>> a(kJoints), b(kJoints), out(kJoints);
  (void)SamplingJob<float>{&clip, 1, a}.Run();
  (void)SamplingJob<float>{&clip, 3, b}.Run();
  std::vector<float> numbers(inertial_numbers(kJoints, kShifting));
  InertialState<float> state{numbers, kJoints, kShifting};
  (void)begin_inertial<float>(a, b, 1, state);
  state.elapsed = 0.3f;
  const BlendLayer<float> layers[] = {{a, {0.7f, 0, 0}}, {b, {0.3f, 0.1f, 2}}};
  bool ok = calls > 0;
  for (int i = 0; i < calls && ok; ++i) {
    if (job == "sample")
      ok = SamplingJob<float>{&clip, 0.01 * i, out}.Run().ok();
    else if (job == "blend")
      ok = BlendingJob<float>{layers, {}, out}.Run().ok();
    else if (job == "inertialize")
      ok = InertializeJob<float>{b, &state, {}, out}.Run().ok();
    else if (job == "begin")
      ok = begin_inertial<float>(a, b, 1, state).ok();
    else
      ok = false;
  }
  if (ok) return 0;
  std::fputs("usage: animation_count sample|blend|inertialize|begin CALLS\n", stderr);
  return 2;
}
