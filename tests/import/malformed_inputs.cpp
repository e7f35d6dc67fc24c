#include "malformed_inputs.h"

#include <functional>
#include <limits>

#include "reading.h"

namespace sinew::import::test {
namespace {

using Json = nlohmann::json;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string gltf(const std::function<void(Json&)>& damage) {
  Json document = kicking_leg();
  damage(document);
  return document.dump();
}

/// Nodes 0 → 1 → 2 …, no animation.
std::string gltf_chain(int length) {
  std::string nodes;
  for (int i = 0; i + 1 < length; ++i) nodes += "{\"children\":[" + std::to_string(i + 1) + "]},";
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes + "{}]}";
}

std::string bvh_chain(int length) {
  std::string text = "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 0\n";
  for (int i = 1; i < length; ++i) text += "JOINT j" + std::to_string(i) + "\n{\nOFFSET 0 1 0\nCHANNELS 0\n";
  return text + repeated("}\n", length) + "MOTION\nFrames: 1\nFrame Time: 0.1\n\n";
}

std::string bvh_fan(int children) {
  std::string text = "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 0\n";
  for (int i = 1; i < children; ++i)
    text += "JOINT j" + std::to_string(i) + "\n{\nOFFSET 0 1 0\nCHANNELS 0\n}\n";
  return text + "}\nMOTION\nFrames: 1\nFrame Time: 0.1\n\n";
}

std::string collada(const std::string& nodes) {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset><unit meter=\"1\"/><up_axis>Y_UP</up_axis></asset><library_visual_scenes>"
         "<visual_scene id=\"s\">" +
         nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
         "url=\"#s\"/></scene></COLLADA>";
}

void add_gltf(std::vector<Malformed>& all) {
  const auto add = [&](const char* name, const std::string& content, const char* cause) {
    all.push_back({std::string("Gltf") + name, "a.gltf", content, cause});
  };
  add("Chain20000", gltf_chain(20000), "nested too deeply");
  add("Chain200000", gltf_chain(200000), "too many nodes");
  add("Brackets200000", R"({"asset":)" + repeated("[", 200000), "nested too deeply");
  add("NanRotation", gltf([](Json& g) {  // trap 26
        set_buffer(g, {0, 0.5f, 1, 0, 0, 0, 1, kNan, kNan, kNan, kNan, 0, 0, 0, 1});
      }),
      "clip 'kick' node 'leg': a rotation key");
  add("NanTime", gltf([](Json& g) {
        set_buffer(g, {0, kNan, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
      }),
      "clip 'kick', node 'leg': a key time is not finite");
  add("ZeroRotation", gltf([](Json& g) {
        set_buffer(g, {0, 0.5f, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
      }),
      "a rotation key is not a rotation");
  add("CountsDiffer", gltf([](Json& g) { g["accessors"][1]["count"] = 2; }), "differ in number");
  add("SamplerNowhere", gltf([](Json& g) { g["animations"][0]["channels"][0]["sampler"] = 7; }),
      "animation 0: 'sampler' points nowhere");
  add("AccessorNowhere", gltf([](Json& g) { g["animations"][0]["samplers"][0]["output"] = 9; }),
      "'output' points nowhere");
  add("TargetNowhere", gltf([](Json& g) { g["animations"][0]["channels"][0]["target"]["node"] = 5; }),
      "'node' points nowhere");
  add("SelfChild", gltf([](Json& g) { g["nodes"][1]["children"] = {1}; }), "two parents|loop");
  add("Loop", gltf([](Json& g) {
        g["nodes"].push_back({{"children", {3}}});
        g["nodes"].push_back({{"children", {2}}});
      }),
      "nodes form a loop");
  add("TwoParents", gltf([](Json& g) {
        g["nodes"].push_back({{"children", {1}}});
      }),
      "node 1 has two parents");
  add("ChildNowhere", gltf([](Json& g) { g["nodes"][1]["children"] = {12}; }), "a child points nowhere");
  add("ChildNegative", gltf([](Json& g) { g["nodes"][1]["children"] = {-1}; }), "a child points nowhere");
  add("ViewBeyondBuffer", gltf([](Json& g) { g["bufferViews"][1]["byteOffset"] = 4000; }), "assimp: ");
  add("NodesAreText", gltf([](Json& g) { g["nodes"] = "none"; }), "glTF structure is wrong");
  add("NameIsNumber", gltf([](Json& g) { g["nodes"][0]["name"] = 3; }), "glTF structure is wrong");
  add("MissingBin", gltf([](Json& g) { g["buffers"][0]["uri"] = "missing.bin"; }), "assimp: .*missing.bin");
  add("BinAbsolute", gltf([](Json& g) { g["buffers"][0]["uri"] = "/etc/passwd"; }), "assimp: ");
  add("BinAbove", gltf([](Json& g) { g["buffers"][0]["uri"] = "../../etc/passwd"; }), "assimp: ");
  add("CutOff", kicking_leg().dump().substr(0, 300), "JSON is damaged at byte 30[01]");
  add("NumberTooLarge", R"({"asset":{"version":"2.0"},"scene":0,"nodes":[{"scale":[1e999,1,1]}]})",
      "glTF structure is wrong|JSON is damaged");
  add("VersionOne", gltf([](Json& g) { g["asset"]["version"] = "1.0"; }),
      "glTF version .1.0.; only 2 can be read");
  add("NeedsDraco", gltf([](Json& g) { g["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
      "needs the extension KHR_draco_mesh_compression");
  add("TimesFall", gltf([](Json& g) {
        set_buffer(g, {0, 0.5f, 0.25f, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
      }),
      "assimp: .*mRotationKeys");
  add("HugeBuffer", gltf([](Json& g) { g["buffers"][0]["byteLength"] = 1000000000000; }), "assimp: ");
  add("NoScene", R"({"asset":{"version":"2.0"}})", "assimp: ");

  const auto add_glb = [&](const char* name, const std::string& content, const char* cause) {
    all.push_back({std::string("Glb") + name, "a.glb", content, cause});
  };
  const std::string whole = as_glb(kicking_leg(), kick_keys());
  add_glb("EndsInHeader", whole.substr(0, 15), "ends within its header");
  add_glb("CutOff", whole.substr(0, whole.size() / 2), "cut off");
  add_glb("ChunkTooLong", whole.substr(0, 12) + "\xff\xff\xff\x7f" + whole.substr(16), "whole JSON chunk");
  add_glb("VersionOne", whole.substr(0, 4) + std::string("\1\0\0\0", 4) + whole.substr(8), "version 1");
  add_glb("Brackets200000",
          "glTF" + std::string("\2\0\0\0", 4) + std::string("\x54\x0d\x03\0", 4) +
              std::string("\x40\x0d\x03\0", 4) + "JSON" + repeated("[", 200000),
          "nested too deeply");
  add_glb("Junk78", "glTF" + repeated("\x7f", 74), "GLB version");
  // What another importer of assimp would claim, and then crash on (ecosystem, section 3.2).
  add_glb("OtherFormat", "Metric (key = \"distance\") {float {1}}\nGeometryNode $n {}\nBoneNode $b {{}}",
          "not a glTF, FBX, BVH, COLLADA or URDF file");
}

void add_bvh(std::vector<Malformed>& all) {
  const auto add = [&](const char* name, const std::string& content, const char* cause) {
    all.push_back({std::string("Bvh") + name, "a.bvh", content, cause});
  };
  const std::string frame = "0 90 0 0 0 0 0 0 0\n";
  add("Chain20000", bvh_chain(20000), "joints are nested");
  add("Chain200000", bvh_chain(200000), "joints are nested");
  add("Fan30000", bvh_fan(30000), "too many joints");
  add("FramesTwoBillion", short_bvh("Frames: 2000000000\nFrame Time: 0.02\n" + frame), "number of frames");
  add("FramesNegative", short_bvh("Frames: -5\nFrame Time: 0.02\n" + frame), "number of frames");
  add("FrameTimeZero", short_bvh("Frames: 1\nFrame Time: 0\n" + frame), "frame time");
  add("FrameTimeNegative", short_bvh("Frames: 1\nFrame Time: -0.1\n" + frame), "frame time");
  add("FrameTimeNan", short_bvh("Frames: 1\nFrame Time: nan\n" + frame), "frame time");
  add("NanFrame", short_bvh("Frames: 1\nFrame Time: 0.02\n0 nan 0 0 0 0 0 0 0\n"), "clip .* node 'hip'");
  add("InfiniteFrame", short_bvh("Frames: 1\nFrame Time: 0.02\n0 90 0 0 0 0 inf 0 0\n"),
      "clip .* node 'leg'");
  add("ShortData", short_bvh("Frames: 3\nFrame Time: 0.02\n" + frame), "assimp: ");
  add("NoMotion", "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\n", "no MOTION");
  add("Unclosed", "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nMOTION\nFrames: 1\nFrame Time: 0.1\n", "assimp: ");
  add("TwoJointsOfOneName",
      "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nJOINT k\n{\nOFFSET 0 1 0\nCHANNELS 1 "
      "Xrotation\n"
      "}\nJOINT k\n{\nOFFSET 1 1 0\nCHANNELS 1 Xrotation\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n",
      "assimp: .*k");
  add("HugeChannelCount",
      "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\nCHANNELS 2000000000 Xrotation\n}\nMOTION\nFrames: 1\nFrame Time: "
      "0.1\n0\n",
      "assimp: ");
}

void add_xml_and_fbx(std::vector<Malformed>& all) {
  const auto add = [&](const char* name, const char* file, const std::string& content, const char* cause) {
    all.push_back({name, file, content, cause});
  };
  add("ColladaNested200000", "a.dae", collada(repeated("<node>", 200000)), "XML is nested too deeply");
  add("ColladaNested1500", "a.dae", collada(repeated("<node>", 1500) + repeated("</node>", 1500)),
      "nodes are nested too deeply");
  add("ColladaCutOff", "a.dae", collada("<node id=\"n\"/>").substr(0, 200), "assimp: ");
  add("ColladaEmpty", "a.dae", "<?xml version=\"1.0\"?><COLLADA version=\"1.4.1\"></COLLADA>", "assimp: ");
  add("ColladaNanMatrix", "a.dae",
      collada("<node id=\"n\" name=\"n\"><matrix>nan 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix></node>"),
      "node 'n' has a transform that is not finite|assimp: ");
  for (const auto& [name, list] : {std::pair("ColladaIndexIsText", "<p>0 1 x</p>"),
                                   std::pair("ColladaIndexIsSigned", "<p\n>0 1 -2</p>")})
    add(name, "a.dae", collada("<node id=\"n\"/>") + list, "holds something that is no number");
  add("ColladaUtf16", "a.dae", std::string("\xFF\xFE<\0C\0O\0", 8), "UTF-16 text; save it as UTF-8");
  add("FbxOld", "a.fbx",  // trap 36
      "; FBX 6.1.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 6100\n}\n",
      "assimp: .*(version|FBX)");
  add("FbxOnlyMagic", "a.fbx", std::string("Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0", 27), "assimp: ");
  add("FbxTextNested", "a.fbx", "; FBX 7.4.0 project file\n" + repeated("A: {\n", 200000),
      "assimp: |nested too deeply");
  add("FbxTextCutOff", "a.fbx", "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXVersion: 7400\n",
      "assimp: ");
  add("NoFormat", "a.fbx", "Once upon a time there was a file.",
      "not a glTF, FBX, BVH, COLLADA or URDF file");
  add("OnlyNulls", "a.glb", std::string(4096, '\0'), "not a glTF, FBX, BVH, COLLADA or URDF file");
  add("Empty", "a.bvh", "", "file is empty");
}

void add_urdf(std::vector<Malformed>& all) {
  const auto add = [&](const char* name, const std::string& content, const char* cause) {
    all.push_back({std::string("Urdf") + name, "a.urdf", content, cause});
  };
  const std::string limit = kGoodLimit;
  add("SelfChild",
      "<robot name=\"r\"><link name=\"root\"/><link name=\"a\"/><joint name=\"j\" type=\"fixed\"><parent "
      "link=\"a\"/><child link=\"a\"/></joint></robot>",
      "loop|ancestor|[Tt]wo root");
  add("Loop",
      "<robot name=\"r\"><link name=\"root\"/><link name=\"a\"/><link name=\"b\"/>"
      "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"
      "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint></robot>",
      "loop");
  add("TwoParents",
      "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>"
      "<joint name=\"i\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"
      "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"c\"/></joint>"
      "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/></joint></robot>",
      "link 'c' is its own ancestor, or has two parents");
  add("Nested200000", "<robot name=\"r\">" + repeated("<link name=\"a\">", 200000),
      "XML is nested too deeply");
  // Trap 48.
  add("Spherical", short_urdf(knee(limit, "spherical")), "knee.*spherical");
  add("ZeroAxis", short_urdf(knee("<axis xyz=\"0 0 0\"/>" + limit)),
      "joint 'knee' has an axis of length zero");
  add("NanAxis", short_urdf(knee("<axis xyz=\"nan 0 0\"/>" + limit)), "knee");
  add("NanOrigin", short_urdf(knee("<origin xyz=\"0 nan 0\"/>" + limit)), "knee");
  add("NegativeMass",
      short_urdf(knee(limit),
                 "<inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
                 "iyz=\"0\" izz=\"1\"/></inertial>"),
      "link 'a' has a negative mass");
  for (const auto& [name, mass] : {std::pair("MassWithComma", "1,5"), std::pair("NanMass", "nan")})
    add(name,
        short_urdf(knee(limit), std::string("<inertial><mass value=\"") + mass +
                                    "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
                                    "izz=\"1\"/></inertial>"),
        "mass.*[Ll]ink .?a");
  add("InvertedLimits", short_urdf(knee("<limit lower=\"1\" upper=\"-1\" effort=\"10\" velocity=\"5\"/>")),
      "joint 'knee' has its lower limit above its upper");
  add("NoLimits", short_urdf(knee()), "knee.*limit");
  add("MimicOfItself", short_urdf(knee(limit + "<mimic joint=\"knee\"/>")), "joint 'knee' mimics itself");
  add("MimicOfNobody", short_urdf(knee(limit + "<mimic joint=\"elbow\"/>")),
      "joint 'knee' mimics 'elbow', which does not exist");
  add("Xacro",
      "<robot name=\"r\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:include filename=\"x\"/><link "
      "name=\"a\"/></robot>",
      "xacro");
  add("MissingParent", "<robot name=\"r\"><link name=\"b\"/>" + knee(limit) + "</robot>",
      "knee|link \\[a\\]|'a'");
  add("TwoLinksOfOneName", "<robot name=\"r\"><link name=\"a\"/><link name=\"a\"/></robot>", "a.*unique");
  add("TwoRoots", "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/></robot>", "[Tt]wo root");
  add("NoLinks", "<robot name=\"r\"></robot>", "link");
  add("CutOff", short_urdf(knee(limit)).substr(0, 120), ".");
  add("EntitiesInEntities",
      "<?xml version=\"1.0\"?><!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b "
      "\"&a;&a;&a;&a;&a;&a;&a;&a;\">]>"
      "<robot name=\"&b;\"><link name=\"&b;\"/><link name=\"a\"/></robot>",
      ".");
  add("NegativeBox",
      short_urdf(knee(limit), "<collision><geometry><box size=\"-1 1 1\"/></geometry></collision>"),
      "link 'a' has a shape without a proper size");
}

}  // namespace

const std::vector<Malformed>& malformed_inputs() {
  static const std::vector<Malformed> all = [] {
    std::vector<Malformed> made;
    add_gltf(made);
    add_bvh(made);
    add_xml_and_fbx(made);
    add_urdf(made);
    return made;
  }();
  return all;
}

}  // namespace sinew::import::test
