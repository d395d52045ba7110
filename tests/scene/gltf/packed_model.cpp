#include "tests/scene/gltf/packed_model.h"

#include <cstring>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include "scene/builtin/mesh_shapes.h"

namespace carousel::scene {

namespace {

using Json = nlohmann::json;
using Packed = std::vector<unsigned char>;

Packed meshopt_packed(const Packed& data, std::size_t count, std::size_t stride, const std::string& mode) {
  Packed out;
  if (mode == "ATTRIBUTES") {
    meshopt_encodeVertexVersion(0);
    out.resize(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data.data(), count, stride));
    return out;
  }
  meshopt_encodeIndexVersion(1);
  std::vector<unsigned> indices(count);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&indices[i], &data[i * stride], stride);
  out.resize(meshopt_encodeIndexBufferBound(count, 65536) + meshopt_encodeIndexSequenceBound(count, 65536));
  out.resize(mode == "TRIANGLES" ? meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), count)
                                 : meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), count));
  return out;
}

/// All bytes of the layers' texture slots are the same texture 0.
Json layers() {
  const Json texture = {{"index", 0}, {"texCoord", 0}};
  return {{"KHR_materials_ior", {{"ior", 1.4}}},
          {"KHR_materials_transmission", {{"transmissionFactor", 0.5}, {"transmissionTexture", texture}}},
          {"KHR_materials_volume",
           {{"thicknessFactor", 2},
            {"thicknessTexture", texture},
            {"attenuationDistance", 3},
            {"attenuationColor", {0.5, 0.25, 1}}}},
          {"KHR_materials_specular",
           {{"specularFactor", 0.75},
            {"specularTexture", texture},
            {"specularColorFactor", {2, 0.5, 0}},
            {"specularColorTexture", texture}}},
          {"KHR_materials_clearcoat",
           {{"clearcoatFactor", 0.25},
            {"clearcoatTexture", texture},
            {"clearcoatRoughnessFactor", 0.125},
            {"clearcoatRoughnessTexture", texture},
            {"clearcoatNormalTexture", {{"index", 0}, {"scale", 0.5}}}}},
          {"KHR_materials_sheen",
           {{"sheenColorFactor", {0.5, 0, 0.25}},
            {"sheenColorTexture", texture},
            {"sheenRoughnessFactor", 0.625},
            {"sheenRoughnessTexture", texture}}},
          {"KHR_materials_iridescence",
           {{"iridescenceFactor", 0.875},
            {"iridescenceTexture", texture},
            {"iridescenceIor", 1.75},
            {"iridescenceThicknessMinimum", 50},
            {"iridescenceThicknessMaximum", 500},
            {"iridescenceThicknessTexture", texture}}},
          {"KHR_materials_anisotropy",
           {{"anisotropyStrength", 0.375}, {"anisotropyRotation", -1.5}, {"anisotropyTexture", texture}}}};
}

void add_meshopt_meshes(GltfBuilder& b) {
  Mesh ball;
  add_icosphere(ball, Vec3(0), 1, 1, MaterialId(0));
  const std::size_t vertices = ball.positions.size();
  const std::vector<std::uint16_t> indices(ball.indices.begin(), ball.indices.end());
  // A unit vector in the octahedral filter's format: x, y, one and a fourth component, 8 bits each.
  std::vector<float> quads;
  for (const Vec3& n : ball.normals) quads.insert(quads.end(), {n.x, n.y, n.z, 0});
  Packed octahedral(4 * vertices), exponents(12 * vertices);
  meshopt_encodeFilterOct(octahedral.data(), vertices, 4, 8, quads.data());
  meshopt_encodeFilterExp(exponents.data(), vertices, 12, 15, &ball.positions[0].x);
  const int normals =
      b.accessor(meshopt_view(b, octahedral, vertices, 4, "ATTRIBUTES", "OCTAHEDRAL"), 5120, vertices, "VEC3", true);
  b.json["bufferViews"].back()["byteStride"] = 4;
  const int coarse =
      b.accessor(meshopt_view(b, exponents, vertices, 12, "ATTRIBUTES", "EXPONENTIAL"), 5126, vertices, "VEC3");
  const int exact =
      b.accessor(meshopt_view(b, bytes_of(ball.positions), vertices, 12, "ATTRIBUTES"), 5126, vertices, "VEC3");
  const int list =
      b.accessor(meshopt_view(b, bytes_of(indices), indices.size(), 2, "TRIANGLES"), 5123, indices.size(), "SCALAR");
  const int sequence =
      b.accessor(meshopt_view(b, bytes_of(indices), indices.size(), 2, "INDICES"), 5123, indices.size(), "SCALAR");
  b.mesh({{"POSITION", coarse}, {"NORMAL", normals}}, list);
  b.mesh({{"POSITION", exact}}, sequence);
  std::vector<float> turns{0, 0, 0.6f, 0.8f, 0.5f, 0.5f, -0.5f, 0.5f};
  Packed quaternions(16);
  meshopt_encodeFilterQuat(quaternions.data(), 2, 8, 16, turns.data());
  const int rotations =
      b.accessor(meshopt_view(b, quaternions, 2, 8, "ATTRIBUTES", "QUATERNION"), 5122, 2, "VEC4", true);
  b.json["nodes"].back()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", rotations}};
}

}  // namespace

int meshopt_view(GltfBuilder& b, const std::vector<unsigned char>& data, std::size_t count, std::size_t stride,
                 const char* mode, const char* filter) {
  const Packed packed = meshopt_packed(data, count, stride, mode);
  const int source = b.view(packed);
  const Json at = b.json["bufferViews"][static_cast<std::size_t>(source)];
  b.json["bufferViews"].erase(static_cast<std::size_t>(source));
  const int view = b.view(Packed(data.size()));
  Json& extension = b.json["bufferViews"].back()["extensions"]["EXT_meshopt_compression"];
  extension = {{"buffer", 0},
               {"byteOffset", at["byteOffset"]},
               {"byteLength", packed.size()},
               {"byteStride", stride},
               {"count", count},
               {"mode", mode}};
  if (filter != nullptr) extension["filter"] = filter;
  return view;
}

int draco_mesh(GltfBuilder& b, const Mesh& shape, bool edgebreaker) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(shape.triangle_count()));
  const int positions = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normals = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  for (std::uint32_t t = 0; t < shape.triangle_count(); ++t) {
    const std::uint32_t* v = &shape.indices[3 * t];
    const auto set = [&](int attribute, const std::vector<Vec3>& values) {
      builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(t), &values[v[0]], &values[v[1]], &values[v[2]]);
    };
    set(positions, shape.positions);
    set(normals, shape.normals);
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetTrackEncodedProperties(true);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const int view = b.view(std::vector<char>(buffer.data(), buffer.data() + buffer.size()));
  const std::size_t points = encoder.num_encoded_points();
  const Json attributes = {{"POSITION", b.accessor(-1, 5126, points, "VEC3")},
                           {"NORMAL", b.accessor(-1, 5126, points, "VEC3")}};
  const int indices = b.accessor(-1, 5123, 3 * encoder.num_encoded_faces(), "SCALAR");
  return b.mesh(attributes, indices,
                {{"extensions",
                  {{"KHR_draco_mesh_compression",
                    {{"bufferView", view}, {"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}}}}}});
}

std::vector<unsigned char> webp(int width, int height, const std::vector<unsigned char>& rgba) {
  WebPConfig config;
  EXPECT_TRUE(WebPConfigPreset(&config, WEBP_PRESET_DEFAULT, 75));
  config.lossless = 1;
  config.exact = 1;  // colours where alpha is 0 are kept
  WebPPicture picture;
  EXPECT_TRUE(WebPPictureInit(&picture));
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  EXPECT_TRUE(WebPPictureImportRGBA(&picture, rgba.data(), 4 * width));
  EXPECT_TRUE(WebPEncode(&config, &picture));
  std::vector<unsigned char> out(writer.mem, writer.mem + writer.size);
  WebPMemoryWriterClear(&writer);
  WebPPictureFree(&picture);
  return out;
}

GltfBuilder every_extension() {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = {"EXT_meshopt_compression", "EXT_texture_webp", "KHR_draco_mesh_compression",
                              "KHR_mesh_quantization"};
  b.json["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_draco_mesh_compression"};
  b.push("images", {{"bufferView", b.view(webp(3, 2, Packed(24, 77)))}, {"mimeType", "image/webp"}});
  b.push("textures", {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
  b.push("materials", {{"name", "everything"}, {"extensions", layers()}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  Mesh ball;
  add_icosphere(ball, Vec3(1, 2, 3), 2, 1, MaterialId(0));
  draco_mesh(b, ball, true);
  draco_mesh(b, ball, false);
  add_meshopt_meshes(b);
  b.node({{"extras", {{"carousel_sphere", {{"radius", 0.5}, {"material", 0}}}}}, {"translation", {0, 3, 0}}});
  b.json["scene"] = 0;
  return b;
}

}  // namespace carousel::scene
