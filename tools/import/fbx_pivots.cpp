#include "import/fbx_pivots.h"

#include <algorithm>
#include <set>

#include "import/keys.h"

namespace sinew::import {
namespace {

bool is_pivot(const SourceNode& n) {
  return n.original_name.find("_$AssimpFbx$_") != std::string::npos;
}

/// Of a node that stays: its pivots from the top, then itself. Empty for the pivots.
using Chain = std::vector<int>;

SourceChannel merged_channel(const SourceScene& scene, const Chain& chain,
                             const std::vector<const SourceChannel*>& of_node) {
  std::set<double> times;
  for (const int n : chain)
    if (const SourceChannel* c = of_node[n])
      for (const auto* t : {&c->position_times, &c->rotation_times, &c->scale_times})
        times.insert(t->begin(), t->end());
  SourceChannel merged;
  merged.node = chain.back();
  merged.position_times.assign(times.begin(), times.end());
  merged.rotation_times = merged.scale_times = merged.position_times;
  for (const double t : times) {
    Eigen::Matrix4d local = Eigen::Matrix4d::Identity();
    for (const int n : chain) local *= local_at(scene.nodes[n], of_node[n], t);
    const Parts parts(local);
    merged.positions.push_back(parts.position);
    merged.rotations.push_back(parts.rotation);
    merged.scales.push_back(parts.scale);
  }
  return merged;
}

void fold_clip(const SourceScene& scene, const std::vector<Chain>& chains, SourceClip& clip) {
  std::vector<const SourceChannel*> of_node(scene.nodes.size(), nullptr);
  for (const SourceChannel& c : clip.channels) of_node[c.node] = &c;
  std::vector<SourceChannel> folded;
  for (const Chain& chain : chains) {
    if (chain.empty()) continue;
    if (const SourceChannel* whole = of_node[chain.back()]) {
      // assimp animates the helpers, or, where rotations before and after the joint's own are the only ones,
      // the joint: its keys then hold the whole chain, which stands in the scene all the same.
      folded.push_back(*whole);
    } else if (std::any_of(chain.begin(), chain.end(), [&](int n) { return of_node[n] != nullptr; })) {
      folded.push_back(merged_channel(scene, chain, of_node));
    }
  }
  clip.channels = std::move(folded);
}

}  // namespace

void fold_fbx_pivots(SourceScene& scene) {
  const int count = static_cast<int>(scene.nodes.size());
  std::vector<Chain> chains(count);
  int pivots = 0;
  for (int i = 0; i < count; ++i) {
    if (is_pivot(scene.nodes[i])) {
      ++pivots;
      continue;
    }
    Chain& chain = chains[i];
    for (int n = i; n == i || (n >= 0 && is_pivot(scene.nodes[n])); n = scene.nodes[n].parent)
      chain.push_back(n);
    std::reverse(chain.begin(), chain.end());
  }
  if (pivots == 0) return;
  for (SourceClip& clip : scene.clips) fold_clip(scene, chains, clip);

  std::vector<int> renumbered(count, -1);
  std::vector<SourceNode> kept;
  for (int i = 0; i < count; ++i) {
    if (chains[i].empty()) continue;
    SourceNode node = scene.nodes[i];
    node.local.setIdentity();
    for (const int n : chains[i]) node.local *= scene.nodes[n].local;
    const int parent = scene.nodes[chains[i].front()].parent;
    node.parent = parent < 0 ? -1 : renumbered[parent];
    renumbered[i] = static_cast<int>(kept.size());
    kept.push_back(std::move(node));
  }
  scene.nodes = std::move(kept);
  const auto renumber = [&](int& node) { node = node < 0 ? node : renumbered[node]; };
  for (SourceMesh& m : scene.meshes) {
    renumber(m.node);
    for (SourceMesh::Bone& b : m.bones) renumber(b.node);
  }
  for (SourceClip& clip : scene.clips)
    for (SourceChannel& c : clip.channels) renumber(c.node);
  scene.notes.push_back(std::to_string(pivots) + " FBX pivot nodes folded into their joints");
}

}  // namespace sinew::import
