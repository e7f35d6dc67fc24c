// Loads an asset and samples its first clip.
#include <sinew/animation/sampling_job.h>
#include <sinew/io/asset.h>

#include <vector>

int main(int argc, char** argv) {
  sinew::Asset asset;
  if (argc < 2 || !sinew::load_asset(argv[1], asset)) return 1;
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  return sinew::SamplingJob<float>{&asset.clips[0], 0, jets}.Run() ? 0 : 2;
}
