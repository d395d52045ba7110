#pragma once

#include <string>

namespace carousel::scene {

/// A source of numbers of a COLLADA file: `params` are its columns, of `type`.
inline std::string collada_source(const std::string& id, const std::string& params, int count,
                                  const std::string& values, const std::string& type = "float") {
  int stride = 0;
  std::string columns;
  for (const char param : params) {
    ++stride;
    columns +=
        "<param name=\"" + std::string(param == '-' ? "JOINT" : std::string(1, param)) + "\" type=\"" + type + "\"/>";
  }
  const bool matrix = type == "float4x4", names = type == "name";
  const int width = matrix ? 16 : stride;
  const std::string array = names ? "Name_array" : "float_array";
  return "<source id=\"" + id + "\"><" + array + " id=\"" + id + "-a\" count=\"" + std::to_string(count * width) +
         "\">" + values + "</" + array + "><technique_common><accessor source=\"#" + id + "-a\" count=\"" +
         std::to_string(count) + "\" stride=\"" + std::to_string(width) + "\">" + columns +
         "</accessor></technique_common></source>";
}

/// An animation of one value by straight lines between `times`.
inline std::string collada_animation(const std::string& id, const std::string& target, const std::string& columns,
                                     int count, const std::string& times, const std::string& values) {
  std::string straight;
  for (int i = 0; i < count; ++i) straight += "LINEAR ";
  return "<animation id=\"" + id + "\" name=\"" + id + "\">" + collada_source(id + "-t", "T", count, times) +
         collada_source(id + "-v", columns, count, values) + collada_source(id + "-i", "I", count, straight, "name") +
         "<sampler id=\"" + id + "-s\"><input semantic=\"INPUT\" source=\"#" + id +
         "-t\"/><input semantic=\"OUTPUT\" source=\"#" + id + "-v\"/><input semantic=\"INTERPOLATION\" source=\"#" +
         id + "-i\"/></sampler><channel source=\"#" + id + "-s\" target=\"" + target + "\"/></animation>";
}

inline std::string collada_geometry(int vertices, const std::string& positions, int triangles,
                                    const std::string& corners) {
  return "<library_geometries><geometry id=\"g\"><mesh>" + collada_source("p", "XYZ", vertices, positions) +
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"" +
         std::to_string(triangles) + "\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" + corners +
         "</p></triangles></mesh></geometry></library_geometries>";
}

inline std::string collada_file(const std::string& libraries, const std::string& nodes) {
  return "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">"
         "<asset><unit name=\"meter\" meter=\"1\"/><up_axis>Y_UP</up_axis></asset>\n" +
         libraries + "\n<library_visual_scenes><visual_scene id=\"s\">" + nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

/// A triangle (0, 0), (1, 0), (0, 1) that goes from x = 0 to x = 4 in two seconds, and turns to the left by 90 degrees
/// in the first of them.
inline std::string moving_collada() {
  return collada_file(
      collada_geometry(3, "0 0 0 1 0 0 0 1 0", 1, "0 1 2") + "<library_animations>" +
          collada_animation("go", "n/move", "XYZ", 2, "0 2", "0 0 0 4 0 0") +
          collada_animation("turn", "n/turn.ANGLE", "A", 2, "0 1", "0 90") + "</library_animations>",
      "<node id=\"n\" name=\"Vane\"><translate sid=\"move\">0 0 0</translate><rotate sid=\"turn\">0 0 1 0</rotate>"
      "<instance_geometry url=\"#g\"/></node>");
}

/// The arm of two bones that glTF's tests have (tests/scene/gltf/pose/moving_models.h), which bends in a second.
inline std::string arm_collada() {
  const std::string controller =
      "<library_controllers><controller id=\"k\"><skin source=\"#g\"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
      "</bind_shape_matrix>" +
      collada_source("j", "-", 2, "Upper Fore", "name") +
      collada_source("b", "M", 2, "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 0 1 0 -1 0 0 1 0 0 0 0 1", "float4x4") +
      collada_source("w", "W", 2, "1 0.5") +
      "<joints><input semantic=\"JOINT\" source=\"#j\"/><input semantic=\"INV_BIND_MATRIX\" source=\"#b\"/></joints>"
      "<vertex_weights count=\"6\"><input semantic=\"JOINT\" source=\"#j\" offset=\"0\"/><input semantic=\"WEIGHT\" "
      "source=\"#w\" offset=\"1\"/><vcount>1 1 2 2 1 1</vcount><v>0 0 0 0 0 1 1 1 0 1 1 1 1 0 1 0</v></vertex_weights>"
      "</skin></controller></library_controllers>";
  return collada_file(
      collada_geometry(6, "-0.2 0 0 0.2 0 0 -0.2 1 0 0.2 1 0 -0.2 2 0 0.2 2 0", 4, "0 1 2 2 1 3 2 3 4 4 3 5") +
          controller + "<library_animations>" + collada_animation("bend", "Fore/turn.ANGLE", "A", 2, "0 1", "0 90") +
          "</library_animations>",
      "<node id=\"Upper\" sid=\"Upper\" type=\"JOINT\"><node id=\"Fore\" sid=\"Fore\" type=\"JOINT\"><translate>0 1 0"
      "</translate><rotate sid=\"turn\">0 0 1 0</rotate></node></node><node id=\"Arm\"><translate>0 0 7</translate>"
      "<instance_controller url=\"#k\"><skeleton>#Upper</skeleton></instance_controller></node>");
}

/// A triangle that goes from x = 0 to x = 8 in a second.
inline const char* const kMovingFbx = R"(; FBX 7.4.0 project file
FBXHeaderExtension: { FBXHeaderVersion: 1003
 FBXVersion: 7400 }
GlobalSettings: { Version: 1000 }
Objects: {
 Geometry: 10, "Geometry::Flag", "Mesh" {
  Vertices: *9 { a: 0,0,0,1,0,0,0,1,0 }
  PolygonVertexIndex: *3 { a: 0,1,-3 }
  GeometryVersion: 124
 }
 Model: 20, "Model::Flag", "Mesh" { Version: 232 }
 AnimationStack: 40, "AnimStack::wave", "" {
  Properties70: {
   P: "LocalStop", "KTime", "Time", "",46186158000
  }
 }
 AnimationLayer: 41, "AnimLayer::Base", "" {
 }
 AnimationCurveNode: 42, "AnimCurveNode::T", "" {
  Properties70: {
   P: "d|X", "Number", "", "A",0
   P: "d|Y", "Number", "", "A",0
   P: "d|Z", "Number", "", "A",0
  }
 }
 AnimationCurve: 43, "AnimCurve::", "" {
  Default: 0
  KeyVer: 4008
  KeyTime: *2 { a: 0,46186158000 }
  KeyValueFloat: *2 { a: 0,8 }
  KeyAttrFlags: *1 { a: 24840 }
  KeyAttrDataFloat: *4 { a: 0,0,0,0 }
  KeyAttrRefCount: *1 { a: 2 }
 }
}
Connections: {
 C: "OO",20,0
 C: "OO",10,20
 C: "OO",41,40
 C: "OO",42,41
 C: "OP",42,20, "Lcl Translation"
 C: "OP",43,42, "d|X"
}
)";

}  // namespace carousel::scene
