#include <limits>

#include "tests/scene/gltf/gltf_damage.h"

namespace carousel::scene {

namespace {

using Verdict = std::optional<Damage::Verdict>;
using Plant = std::function<Verdict(ModelFiles&)>;

/// The indexed primitive with the most vertices, the first of several: damage must not depend on small
/// numbers.
struct Victim {
  explicit Victim(ModelFiles& model) {
    Json& meshes = model.json["meshes"];
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      for (std::size_t p = 0; p < meshes[m]["primitives"].size(); ++p) {
        Json& primitive = meshes[m]["primitives"][p];
        const std::size_t accessor = primitive["attributes"]["POSITION"];
        const std::size_t count = model.json["accessors"][accessor]["count"];
        if (count <= vertices || !primitive.contains("indices")) continue;
        vertices = count;
        positions = accessor;
        indices = primitive["indices"];
        path = "/meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p);
      }
    }
    position_path = path + "/attributes/POSITION";
    index_path = path + "/indices";
  }

  std::string path, position_path, index_path;
  std::size_t positions = 0, indices = 0, vertices = 0;
};

Json& entry(ModelFiles& m, const char* array, std::size_t index) {
  return m.json[array][index];
}
std::string path_of(const char* array, std::size_t index) {
  return std::string("/") + array + "/" + std::to_string(index);
}

/// Changes the accessor of the positions; the fault is there.
Plant on_positions(const std::string& where, const std::string& message, const std::function<void(Json&)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    const Victim victim(m);
    change(entry(m, "accessors", victim.positions));
    return {{path_of("accessors", victim.positions) + where, message}};
  };
}

/// Changes the files of a victim; the fault is where a primitive uses the positions.
Plant on_position_use(const std::string& message, const std::function<void(ModelFiles&, const Victim&)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    const Victim victim(m);
    change(m, victim);
    return {{victim.position_path, message}};
  };
}

Plant on_index_use(const std::string& message, const std::function<void(ModelFiles&, const Victim&)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    const Victim victim(m);
    change(m, victim);
    return {{victim.index_path, message}};
  };
}

Plant on_sparse(const std::string& where, const std::string& message,
                const std::function<void(ModelFiles&, Json& sparse)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    Json& accessors = m.json["accessors"];
    for (std::size_t i = 0; i < accessors.size(); ++i) {
      if (!accessors[i].contains("sparse")) continue;
      change(m, accessors[i]["sparse"]);
      return {{path_of("accessors", i) + "/sparse" + where, message}};
    }
    return std::nullopt;
  };
}

char* sparse_indices(ModelFiles& m, const Json& sparse) {
  const Json& view = m.json["bufferViews"][sparse["indices"]["bufferView"].get<std::size_t>()];
  const std::string uri = m.json["buffers"][view["buffer"].get<std::size_t>()]["uri"];
  return m.files.at(uri).data() + view.value("byteOffset", std::size_t{0});
}

void put_position(ModelFiles& m, const Victim& victim, float value) {
  put(m.element(victim.positions, victim.vertices / 2) + 4, value);
}

std::vector<Damage> accessor_damages() {
  return {
      {"NaN among the positions",
       on_position_use("is NaN", [](ModelFiles& m,
                                    const Victim& v) { put_position(m, v, std::numeric_limits<float>::quiet_NaN()); })},
      {"infinite position", on_position_use("is infinite",
                                            [](ModelFiles& m, const Victim& v) {
                                              put_position(m, v, -std::numeric_limits<float>::infinity());
                                            })},
      {"index beyond the positions",
       on_index_use("index 65535 at position 4 is beyond",
                    [](ModelFiles& m, const Victim& v) { put(m.element(v.indices, 4), std::uint16_t{65535}); })},
      {"half a triangle", on_index_use("a multiple of 3 vertices",
                                       [](ModelFiles& m, const Victim& v) {
                                         Json& count = entry(m, "accessors", v.indices)["count"];
                                         count = count.get<int>() - 1;
                                       })},
      {"indices as floats", on_index_use("the component type is not allowed here",
                                         [](ModelFiles& m, const Victim& v) {
                                           entry(m, "accessors", v.indices)["componentType"] = 5126;
                                           entry(m, "accessors", v.indices)["count"] = 3;
                                         })},
      {"indices without data",
       on_index_use("has no data",
                    [](ModelFiles& m, const Victim& v) { entry(m, "accessors", v.indices).erase("bufferView"); })},
      {"positions in a plane",
       on_position_use("expected VEC3 elements",
                       [](ModelFiles& m, const Victim& v) { entry(m, "accessors", v.positions)["type"] = "VEC2"; })},
      {"positions as whole numbers", on_position_use("the component type is not allowed here",
                                                     [](ModelFiles& m, const Victim& v) {
                                                       entry(m, "accessors", v.positions)["componentType"] = 5125;
                                                     })},
      {"zeros by the billion", on_position_use("asks for 4000000000 elements and stores 0",
                                               [](ModelFiles& m, const Victim& v) {
                                                 Json& accessor = entry(m, "accessors", v.positions);
                                                 accessor.erase("bufferView");
                                                 accessor["count"] = 4000000000u;
                                               })},
      {"unknown component type",
       on_positions("/componentType", "expected one of", [](Json& a) { a["componentType"] = 5124; })},
      {"unknown element type", on_positions("/type", "expected one of", [](Json& a) { a["type"] = "VEC5"; })},
      {"no component type", on_positions("/componentType", "missing", [](Json& a) { a.erase("componentType"); })},
      {"no elements", on_positions("/count", "expected an integer of at least 1", [](Json& a) { a["count"] = 0; })},
      {"one element too many",
       on_positions("", "reach outside buffer view", [](Json& a) { a["count"] = a["count"].get<int>() + 1; })},
      {"elements by the billion", on_positions("", "reach outside buffer view", [](Json& a) { a["count"] = 4e9; })},
      {"elements up to 2^53",
       on_positions("", "reach outside buffer view", [](Json& a) { a["count"] = 9007199254740992.0; })},
      {"elements beyond 2^53", on_positions("/count", "expected an integer", [](Json& a) { a["count"] = 1e18; })},
      {"start beyond the view",
       on_positions("", "reach outside buffer view", [](Json& a) { a["byteOffset"] = 1 << 30; })},
      {"sparse index beyond the count",
       on_sparse("/indices", "is beyond the accessor's",
                 [](ModelFiles& m, Json& s) { put(sparse_indices(m, s) + 1, '\x7f'); })},
      {"sparse index twice",
       on_sparse("/indices", "must increase",
                 [](ModelFiles& m, Json& s) { put(sparse_indices(m, s) + 1, *sparse_indices(m, s)); })},
      {"more sparse than all",
       on_sparse("/count", "expected at most", [](ModelFiles&, Json& s) { s["count"] = 1000000; })},
      {"sparse values beyond their view",
       on_sparse("/values", "reach outside buffer view", [](ModelFiles&, Json& s) { s["values"]["byteOffset"] = 8; })},
      {"sparse indices as floats", on_sparse("/indices/componentType", "expected one of",
                                             [](ModelFiles&, Json& s) { s["indices"]["componentType"] = 5126; })},
  };
}

/// Changes the view of the positions.
Plant on_view(const std::string& where, const std::string& message, const std::function<void(Json&)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    const std::size_t view = entry(m, "accessors", Victim(m).positions)["bufferView"];
    change(entry(m, "bufferViews", view));
    return {{path_of("bufferViews", view) + where, message}};
  };
}

/// Changes the first buffer or image that has a file.
Plant on_file(const char* array, const std::string& where, const std::string& message,
              const std::function<void(ModelFiles&, Json& entry, const std::string& uri)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    for (std::size_t i = 0; i < m.json[array].size(); ++i) {
      if (!entry(m, array, i).contains("uri")) continue;
      const std::string uri = entry(m, array, i)["uri"];
      change(m, entry(m, array, i), uri);
      return {{path_of(array, i) + where, message}};
    }
    return std::nullopt;
  };
}

Plant buffer_address(const std::string& uri, const std::string& message) {
  return on_file("buffers", "/uri", message,
                 [=](ModelFiles&, Json& buffer, const std::string&) { buffer["uri"] = uri; });
}

std::vector<Damage> buffer_damages() {
  return {
      {"view outside its buffer", on_view("", "lie outside buffer", [](Json& v) { v["byteOffset"] = 1 << 30; })},
      {"view of 2^54 bytes",
       on_view("", "lie outside buffer", [](Json& v) { v["byteOffset"] = v["byteLength"] = 9007199254740991.0; })},
      {"stride of 14", on_view("/byteStride", "expected a multiple of 4", [](Json& v) { v["byteStride"] = 14; })},
      {"stride of 1000",
       on_view("/byteStride", "expected an integer from 4 to 252", [](Json& v) { v["byteStride"] = 1000; })},
      {"stride below the element",
       [](ModelFiles& m) -> Verdict {
         const std::size_t positions = Victim(m).positions;
         m.json["bufferViews"][entry(m, "accessors", positions)["bufferView"].get<std::size_t>()]["byteStride"] = 8;
         return {{path_of("accessors", positions), "do not fit the stride of 8"}};
       }},
      {"missing buffer", on_file("buffers", "/uri", "no such file",
                                 [](ModelFiles& m, Json&, const std::string& uri) { m.files.erase(uri); })},
      {"buffer cut off", on_file("buffers", "/byteLength", "bytes are announced, the data has",
                                 [](ModelFiles& m, Json&, const std::string& uri) { m.files[uri].pop_back(); })},
      {"empty buffer", on_file("buffers", "/byteLength", "bytes are announced, the data has 0",
                               [](ModelFiles& m, Json&, const std::string& uri) { m.files[uri].clear(); })},
      {"buffer of 8 TB", on_file("buffers", "/byteLength", "8000000000000 bytes are announced",
                                 [](ModelFiles&, Json& b, const std::string&) { b["byteLength"] = 8e12; })},
      {"buffer of less than nothing", on_file("buffers", "/byteLength", "expected an integer of at least 1",
                                              [](ModelFiles&, Json& b, const std::string&) { b["byteLength"] = -1; })},
      {"buffer from the net", buffer_address("http://example.org/a.bin", "http: addresses are not fetched")},
      {"buffer from anywhere", buffer_address("/etc/passwd", "absolute paths are refused")},
      {"buffer from far above", buffer_address("../../../../etc/passwd", "more than two folders above")},
      {"buffer that is a folder", buffer_address(".", "no such file")},
      {"buffer without a name", buffer_address("", "expected the path of a file")},
      {"broken base64", buffer_address("data:application/octet-stream;base64,AA$=", "not proper base64")},
      {"data: URI without base64", buffer_address("data:,abc", "expected a data: URI in base64")},
      {"base64 cut off", on_file("buffers", "/byteLength", "the data has 2",
                                 [](ModelFiles&, Json& b, const std::string&) {
                                   b["uri"] = "data:application/octet-stream;base64,AAA=";
                                 })},
  };
}

std::vector<Damage> image_damages() {
  return {
      {"missing image", on_file("images", "/uri", "no such file",
                                [](ModelFiles& m, Json&, const std::string& uri) { m.files.erase(uri); })},
      {"empty image", on_file("images", "/uri", "holds no data",
                              [](ModelFiles& m, Json&, const std::string& uri) { m.files[uri].clear(); })},
      {"image cut off",
       on_file("images", "", "the image is broken",
               [](ModelFiles& m, Json&, const std::string& uri) { m.files[uri].resize(m.files[uri].size() / 2); })},
      {"image of something else",
       on_file("images", "", "neither PNG nor JPEG",
               [](ModelFiles& m, Json&, const std::string& uri) { m.files[uri] = std::string(5000, 'x'); })},
      {"image with a wrong bit", on_file("images", "", "a checksum does not match",
                                         [](ModelFiles& m, Json&, const std::string& uri) {
                                           std::string& bytes = m.files[uri];
                                           bytes[bytes.find("IDAT") + 40] ^= 1;
                                         })},
      {"image from two sources", on_file("images", "", "exactly one of uri and bufferView",
                                         [](ModelFiles&, Json& i, const std::string&) { i["bufferView"] = 0; })},
      {"image from nowhere", on_file("images", "", "exactly one of uri and bufferView",
                                     [](ModelFiles&, Json& i, const std::string&) { i.erase("uri"); })},
  };
}

}  // namespace

std::vector<Damage> data_damages() {
  std::vector<Damage> all;
  for (std::vector<Damage> some : {accessor_damages(), buffer_damages(), image_damages()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace carousel::scene
