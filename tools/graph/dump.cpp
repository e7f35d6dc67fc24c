#include "graph/dump.h"

#include <cstring>

#include "graph/describe.h"
#include "sinew/graph/graph_recorder.h"

namespace sinew::graph_tools {
namespace {

Json row(const Vec3<float>& v) {
  return {v.x(), v.y(), v.z()};
}

Json rays_of(std::span<const GraphReplay<float>::Ray> all) {
  Json rays = Json::array();
  for (const auto& [hit, met] : all)
    if (met)
      rays.push_back({{"point", row(hit.point)}, {"normal", row(hit.normal)}, {"body", hit.ground}});
    else
      rays.push_back(nullptr);
  return rays;
}

/// Plays one frame.
Json frame_of(const Graph& graph, GraphReplay<float>& replay, int k, GraphScratch<float>& scratch,
              std::span<std::byte> state) {
  const GraphFrame<float> info = replay.info(k);
  std::vector<JointJet<float>> jets(std::size_t(graph.joint_count()));
  Json out = {{"frame", info.number}, {"h", info.h}, {"joints", info.joints}, {"bytes", info.bytes}};
  (void)replay.before(k, scratch, state, jets);  // frame() says what is wrong
  out["before"] = describe_state(graph, state);
  std::vector<EventHit> hits(256);
  EventSink events{hits};
  bool same = false;
  const Status status = replay.frame(k, scratch, state, jets, same, &events);
  if (!status) out["error"] = status.reason;
  out["same"] = same;
  out["rays"] = rays_of(replay.rays());
  out["after"] = describe_state(graph, state);
  out["events"] = Json::array();
  for (int e = 0; e < events.count; ++e)
    out["events"].push_back({{"name", hits[std::size_t(e)].event->name},
                             {"seconds_ago", hits[std::size_t(e)].seconds_ago},
                             {"weight", hits[std::size_t(e)].weight}});
  return out;
}

}  // namespace

std::string recording_file(std::span<const std::byte> recording) {
  const std::uint64_t digest = digest_of(recording);
  std::string file(reinterpret_cast<const char*>(&digest), sizeof digest);
  return file.append(reinterpret_cast<const char*>(recording.data()), recording.size());
}

std::string dump_recording(const Graph& graph, const std::string& file, Json& frames) {
  std::uint64_t digest = 0;
  if (file.size() < sizeof digest || file.size() % 8 != 0) return "is no recording of a graph, or is cut off";
  std::memcpy(&digest, file.data(), sizeof digest);
  GraphMemory ring(file.size() - sizeof digest);
  std::memcpy(ring.data(), file.data() + sizeof digest, ring.size());
  if (digest_of(ring) != digest) return "is damaged";
  GraphReplay<float> replay(graph, ring);
  if (const Status status = replay.Validate(); !status) return status.reason;
  GraphScratch<float> scratch(graph);
  GraphMemory state(graph.state_bytes<float>());
  frames = Json::array();
  for (int k = 0; k < replay.count(); ++k) frames.push_back(frame_of(graph, replay, k, scratch, state));
  return {};
}

}  // namespace sinew::graph_tools
