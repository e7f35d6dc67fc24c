// The JSON Schema files of graphs and of dumps say what the compiler reads and what a replay prints.
#include <fstream>
#include <iterator>
#include <regex>

#include "fixtures/paths.h"
#include "graph/dump.h"
#include "graph/located_json.h"
#include "graph_fixture.h"
#include "sinew/graph/graph_recorder.h"

namespace sinew {
namespace {

using graph_tools::Json;

/// As much of JSON Schema (draft 7) as the two files use; what it does not know fails the test.
class Schema {
 public:
  explicit Schema(const std::string& file)
      : all_(Json::parse(text_of(source_dir() + "/tools/graph/" + file))) {}

  static std::string text_of(const std::string& path) {
    std::ifstream file(path);
    EXPECT_TRUE(file.good()) << path;
    return {std::istreambuf_iterator<char>(file), {}};
  }
  bool allows(const Json& value) const { return allows(value, all_); }

 private:
  static bool is(const Json& value, const std::string& type) {
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    return type == value.type_name();
  }
  bool allows_type(const Json& value, const Json& type) const {
    if (type.is_string()) return is(value, type);
    return std::any_of(type.begin(), type.end(), [&](const Json& one) { return is(value, one); });
  }
  bool allows_object(const Json& value, const Json& schema) const {
    for (const auto& [key, member] : value.items()) {
      const bool named = schema.contains("properties") && schema["properties"].contains(key);
      if (named && !allows(member, schema["properties"][key])) return false;
      if (schema.contains("propertyNames") && !allows(Json(key), schema["propertyNames"])) return false;
      if (!named && schema.contains("additionalProperties") &&
          !allows(member, schema["additionalProperties"]))
        return false;
    }
    return true;
  }
  bool allows_array(const Json& value, const Json& schema) const {
    if (!schema.contains("items")) return true;
    const Json& items = schema["items"];
    for (std::size_t k = 0; k < value.size(); ++k) {
      if (items.is_object() && !allows(value[k], items)) return false;
      if (items.is_array() && k < items.size() && !allows(value[k], items[k])) return false;
      if (items.is_array() && k >= items.size() && schema.contains("additionalItems") &&
          !allows(value[k], schema["additionalItems"]))
        return false;
    }
    return true;
  }
  bool allows_word(const Json& value, const Json& schema, const std::string& word) const {
    const Json& of = schema[word];
    if (word == "$ref") return allows(value, all_.at(Json::json_pointer(of.get<std::string>().substr(1))));
    if (word == "type") return allows_type(value, of);
    if (word == "enum") return std::find(of.begin(), of.end(), value) != of.end();
    if (word == "anyOf")
      return std::any_of(of.begin(), of.end(), [&](const Json& one) { return allows(value, one); });
    if (word == "required")
      return !value.is_object() ||
             std::all_of(of.begin(), of.end(), [&](const Json& key) { return value.contains(key); });
    if (word == "minimum") return !value.is_number() || value >= of;
    if (word == "maximum") return !value.is_number() || value <= of;
    if (word == "minItems" || word == "minProperties") return !value.is_structured() || value.size() >= of;
    if (word == "maxItems") return !value.is_array() || value.size() <= of;
    if (word == "minLength") return !value.is_string() || value.get<std::string>().size() >= of;
    if (word == "pattern")
      return !value.is_string() ||
             std::regex_search(value.get<std::string>(), std::regex(of.get<std::string>()));
    if (word == "properties" || word == "propertyNames" || word == "additionalProperties")
      return !value.is_object() || allows_object(value, schema);
    if (word == "items" || word == "additionalItems") return !value.is_array() || allows_array(value, schema);
    EXPECT_TRUE(word == "$schema" || word == "title" || word == "definitions") << word;
    return true;
  }
  bool allows(const Json& value, const Json& schema) const {
    if (schema.is_boolean()) return schema;
    for (const auto& [word, of] : schema.items())
      if (!allows_word(value, schema, word)) return false;
    return true;
  }

  Json all_;
};

TEST(GraphSchema, AllowsTheProjectsGraphs) {
  const Schema schema("graph.schema.json");
  for (const char* name : {"mannequin", "stick"}) {
    const std::string text =
        Schema::text_of(source_dir() + "/assets/character/" + name + std::string(".graph.json"));
    EXPECT_TRUE(schema.allows(graph_tools::parse_located(text).value)) << name;
  }
  EXPECT_TRUE(schema.allows(Json::parse(fixtures::kSmoothGraph)));
}

TEST(GraphSchema, RefusesWhatTheCompilerRefusesForItsForm) {
  const Schema schema("graph.schema.json");
  const char* wrong[] = {
      R"({})",
      R"([])",
      R"({"graph": 3})",
      R"({"graph": "a", "grahp": 1})",
      R"({"graph": {"clop": "walk"}})",
      R"({"graph": {"clip": "walk", "speed": 1e9}})",
      R"({"parameters": {"a b": 1}, "graph": "walk"})",
      R"({"parameters": {"x": {"type": "floot"}}, "graph": "walk"})",
      R"({"parameters": {"x": "floot"}, "graph": "a"})",
      R"({"parameters": {"s": 0}, "graph": {"blend": "s", "points": [[0, "a"], [1]]}})",
      R"({"parameters": {"s": 0}, "graph": {"blend": "s", "points": []}})",
      R"({"graph": {"layers": ["a", {"node": "b", "mode": "overide"}]}})",
      R"({"graph": {"layers": ["a", {"node": "b", "weight": 2}]}})",
      R"({"graph": {"layers": ["a", "b"]}})",
      R"({"parameters": {"x": 0}, "graph": {"look": "a", "at": ["x", "x"]}})",
      R"({"graph": {"states": {}}})",
      R"({"graph": {"states": {"a": "x"}, "transitions": [{"to": "a"}]}})",
      R"({"graph": {"states": {"a": "x", "b": "x"}, "transitions": [{"from": "a", "to": "b", "kind": "jump"}]}})",
      R"({"graph": {"physical": false}})"};
  for (const char* json : wrong) {
    EXPECT_FALSE(schema.allows(Json::parse(json))) << json;
    EXPECT_NE(graph_tools::compile_graph(json, "test").error, "") << json;
  }
}

/// The compiler says in its fault which keys a thing has: those that the schema has.
TEST(GraphSchema, HasTheKeysThatTheCompilerKnows) {
  const Json schema = Json::parse(Schema::text_of(source_dir() + "/tools/graph/graph.schema.json"));
  struct Thing {
    const char* definition;
    const char* json;
  };
  const Thing things[] = {
      {"parameter/anyOf/3", R"({"parameters": {"x": {"?": 0}}, "graph": "a"})"},
      {"clip", R"({"graph": {"clip": "a", "?": 0}})"},
      {"blend", R"({"graph": {"blend": "x", "?": 0}})"},
      {"layers", R"({"graph": {"layers": ["a"], "?": 0}})"},
      {"layer", R"({"graph": {"layers": ["a", {"node": "b", "?": 0}]}})"},
      {"machine", R"({"graph": {"states": {"a": "b"}, "?": 0}})"},
      {"conduit", R"({"graph": {"states": {"a": {"conduit": true, "?": 0}}}})"},
      {"transition",
       R"({"graph": {"states": {"a": "b"}, "transitions": [{"from": "a", "to": "a", "?": 0}]}})"},
      {"mirror", R"({"graph": {"mirror": "a", "?": 0}})"},
      {"travel", R"({"graph": {"travel": "a", "?": 0}})"},
      {"physical", R"({"graph": {"physical": true, "?": 0}})"},
      {"feet", R"({"graph": {"feet": "a", "?": 0}})"},
      {"look", R"({"graph": {"look": "a", "?": 0}})"}};
  for (const Thing& thing : things) {
    const Json& known =
        schema.at(Json::json_pointer(std::string("/definitions/") + thing.definition + "/properties"));
    const std::string error = graph_tools::compile_graph(thing.json, "test").error;
    const std::string before = "known are: ";
    ASSERT_NE(error.find(before), std::string::npos) << thing.definition << ": " << error;
    std::string list = error.substr(error.find(before) + before.size()) + ", ";
    std::size_t count = 0;
    for (std::size_t end; (end = list.find(", ")) != std::string::npos; list = list.substr(end + 2), ++count)
      EXPECT_TRUE(known.contains(list.substr(0, end))) << thing.definition << ": " << list.substr(0, end);
    EXPECT_EQ(count, known.size()) << thing.definition << ": " << error;
  }
}

TEST(GraphSchema, AllowsWhatAReplayPrints) {
  Asset asset;
  ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset).ok());
  Graph graph;
  fixtures::bind_graph(R"({
  "parameters": {"speed": {"filter": 0.2}, "go": "trigger", "armed": true},
  "graph": {"feet": {"layers": [{"states": {
     "move": {"blend": "speed", "sync": "feet", "points": [[0, {"clip": "stand", "sync": null}], [1.3, "walk"]]},
     "rise": "get_up_supine"},
    "transitions": [{"from": "move", "to": "rise", "if": "go"},
                    {"from": "rise", "to": "move", "if": "go", "kind": "crossfade"}]},
    {"node": {"states": {"none": null, "up": "stand"}, "transitions": [{"from": "none", "to": "up", "if": "armed"}]}}]}}})",
                       asset, graph);
  GraphMemory ring(GraphRecorder<float>::bytes_for(graph, 100));
  GraphRecorder<float> recorder(graph, ring);
  fixtures::GraphPlayer<float> player(graph);
  for (int k = 0; k < 100; ++k) {
    player.set("speed", k % 2);
    if (k % 40 == 10) player.trigger("go");
    GraphStepJob<float> job{&graph, player.state, 1 / 60.f, &player.scratch, player.jets};
    job.ground.below = [](const void*, const Vec3<float>& point, GroundHit<float>& hit) {
      hit.point = {point.x(), point.y(), 0};
      return point.x() < 1;
    };
    ASSERT_TRUE(recorder.step(job).ok());
  }
  Json frames;
  ASSERT_EQ(graph_tools::dump_recording(graph, graph_tools::recording_file(ring), frames), "");
  const Schema schema("dump.schema.json");
  EXPECT_TRUE(schema.allows(frames));
  for (const char* key : {"before", "rays", "same"}) {
    Json without = frames;
    without[0].erase(key);
    EXPECT_FALSE(schema.allows(without)) << key;
  }
  frames[0]["after"]["plays"]["colour"] = "red";
  EXPECT_FALSE(schema.allows(frames));
}

}  // namespace
}  // namespace sinew
