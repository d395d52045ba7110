// Khronos glTF 2.0 specification, section 5 (properties reference), and the extensions' own schemas.
#include "scene/gltf/document/schema_table.h"

#include <utility>

namespace carousel::scene {

namespace {

using K = SchemaKind;

constexpr double kMostBytes = 9007199254740992.0;  // 2^53: exact in a double, far beyond any file
constexpr double kMostSparse = 2147483647.0;       // tinygltf keeps these in an int
constexpr double kHalfPi = 1.5707963705062866, kPi = 3.1415927410125732;  // rounded up to floats

SchemaRule flag(const char* key) {
  return {.key = key, .kind = K::kBoolean};
}
SchemaRule text(const char* key, bool required = false) {
  return {.key = key, .kind = K::kString, .required = required};
}
SchemaRule texts(const char* key) {
  return {.key = key, .kind = K::kStrings};
}
SchemaRule integer(const char* key, double min, double max, bool required = false) {
  return {.key = key, .kind = K::kInteger, .required = required, .min = min, .max = max};
}
SchemaRule choice(const char* key, std::vector<int> choices, bool required = false) {
  return {.key = key, .kind = K::kChoice, .required = required, .choices = std::move(choices)};
}
SchemaRule name_of(const char* key, std::vector<std::string> names, bool required = false) {
  return {.key = key, .kind = K::kName, .required = required, .names = std::move(names)};
}
SchemaRule number(const char* key) {
  return {.key = key, .kind = K::kNumber};
}
SchemaRule number(const char* key, double min, double max, bool required = false) {
  return {.key = key, .kind = K::kNumber, .required = required, .min = min, .max = max};
}
SchemaRule numbers(const char* key, std::size_t length) {
  return {.key = key, .kind = K::kNumbers, .length = length};
}
SchemaRule index(const char* key, const char* refers_to, bool required = false) {
  return {.key = key, .kind = K::kIndex, .required = required, .refers_to = refers_to};
}
SchemaRule indices(const char* key, const char* refers_to, bool required = false) {
  return {.key = key, .kind = K::kIndices, .required = required, .refers_to = refers_to};
}
SchemaRule index_map(const char* key, const char* refers_to) {
  return {.key = key, .kind = K::kIndexMap, .required = true, .refers_to = refers_to};
}
SchemaRule object(const char* key, const Schema& child, bool required = false) {
  return {.key = key, .kind = K::kObject, .required = required, .child = &child};
}
SchemaRule objects(const char* key, const Schema& child, bool required = false) {
  return {.key = key, .kind = K::kObjects, .required = required, .child = &child};
}

const double kLargest = SchemaRule{}.max;

const Schema kAsset{text("version", true), text("generator")};

// Buffers, buffer views, accessors.
const Schema kMeshoptBuffer{flag("fallback")};
const Schema kBufferExtensions{object("EXT_meshopt_compression", kMeshoptBuffer),
                               object("KHR_meshopt_compression", kMeshoptBuffer)};
const Schema kBuffer{text("name"), text("uri"), integer("byteLength", 1, kMostBytes, true),
                     object("extensions", kBufferExtensions)};
Schema meshopt_view(std::vector<std::string> filters) {
  return {index("buffer", "/buffers", true),          integer("byteOffset", 0, kMostBytes),
          integer("byteLength", 1, kMostBytes, true), integer("byteStride", 1, 256, true),
          integer("count", 1, kMostBytes, true),      name_of("mode", {"ATTRIBUTES", "TRIANGLES", "INDICES"}, true),
          name_of("filter", std::move(filters))};
}
const Schema kExtMeshoptView = meshopt_view({"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"});
const Schema kKhrMeshoptView = meshopt_view({"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"});
const Schema kViewExtensions{object("EXT_meshopt_compression", kExtMeshoptView),
                             object("KHR_meshopt_compression", kKhrMeshoptView)};
const Schema kBufferView{index("buffer", "/buffers", true), integer("byteOffset", 0, kMostBytes),
                         integer("byteLength", 1, kMostBytes, true), integer("byteStride", 4, 252),
                         object("extensions", kViewExtensions)};
const Schema kSparseIndices{index("bufferView", "/bufferViews", true), integer("byteOffset", 0, kMostSparse),
                            choice("componentType", {5121, 5123, 5125}, true)};
const Schema kSparseValues{index("bufferView", "/bufferViews", true), integer("byteOffset", 0, kMostSparse)};
const Schema kSparse{integer("count", 1, kMostSparse, true), object("indices", kSparseIndices, true),
                     object("values", kSparseValues, true)};
const Schema kAccessor{index("bufferView", "/bufferViews"),
                       integer("byteOffset", 0, kMostBytes),
                       choice("componentType", {5120, 5121, 5122, 5123, 5125, 5126}, true),
                       flag("normalized"),
                       integer("count", 1, kMostBytes, true),
                       name_of("type", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}, true),
                       object("sparse", kSparse)};

// Textures and materials.
const Schema kImage{text("name"), text("uri"), text("mimeType"), index("bufferView", "/bufferViews")};
const Schema kSampler{choice("magFilter", {9728, 9729}), choice("minFilter", {9728, 9729, 9984, 9985, 9986, 9987}),
                      choice("wrapS", {33071, 33648, 10497}), choice("wrapT", {33071, 33648, 10497})};
const Schema kOtherSource{index("source", "/images")};
const Schema kTextureExtensions{object("EXT_texture_webp", kOtherSource), object("KHR_texture_basisu", kOtherSource)};
const Schema kTexture{text("name"), index("sampler", "/samplers"), index("source", "/images"),
                      object("extensions", kTextureExtensions)};
const Schema kTextureTransform{numbers("offset", 2), number("rotation"), numbers("scale", 2),
                               integer("texCoord", 0, 255)};
const Schema kTextureInfoExtensions{object("KHR_texture_transform", kTextureTransform)};
const Schema kTextureInfo{index("index", "/textures", true), integer("texCoord", 0, 255), number("scale"),
                          number("strength"), object("extensions", kTextureInfoExtensions)};
const Schema kMetallicRoughness{numbers("baseColorFactor", 4), object("baseColorTexture", kTextureInfo),
                                number("metallicFactor"), number("roughnessFactor"),
                                object("metallicRoughnessTexture", kTextureInfo)};
const Schema kNothing{};
const Schema kEmissiveStrength{number("emissiveStrength", 0, kLargest)};
const Schema kIor{number("ior")};
const Schema kTransmission{number("transmissionFactor"), object("transmissionTexture", kTextureInfo)};
const Schema kVolume{number("thicknessFactor"), object("thicknessTexture", kTextureInfo), number("attenuationDistance"),
                     numbers("attenuationColor", 3)};
const Schema kSpecular{number("specularFactor"), object("specularTexture", kTextureInfo),
                       numbers("specularColorFactor", 3), object("specularColorTexture", kTextureInfo)};
const Schema kClearcoat{number("clearcoatFactor"), object("clearcoatTexture", kTextureInfo),
                        number("clearcoatRoughnessFactor"), object("clearcoatRoughnessTexture", kTextureInfo),
                        object("clearcoatNormalTexture", kTextureInfo)};
const Schema kSheen{numbers("sheenColorFactor", 3), object("sheenColorTexture", kTextureInfo),
                    number("sheenRoughnessFactor"), object("sheenRoughnessTexture", kTextureInfo)};
const Schema kIridescence{number("iridescenceFactor"),
                          object("iridescenceTexture", kTextureInfo),
                          number("iridescenceIor"),
                          number("iridescenceThicknessMinimum"),
                          number("iridescenceThicknessMaximum"),
                          object("iridescenceThicknessTexture", kTextureInfo)};
const Schema kAnisotropy{number("anisotropyStrength"), number("anisotropyRotation"),
                         object("anisotropyTexture", kTextureInfo)};
const Schema kMaterialExtensions{object("KHR_materials_unlit", kNothing),
                                 object("KHR_materials_emissive_strength", kEmissiveStrength),
                                 object("KHR_materials_ior", kIor),
                                 object("KHR_materials_transmission", kTransmission),
                                 object("KHR_materials_volume", kVolume),
                                 object("KHR_materials_specular", kSpecular),
                                 object("KHR_materials_clearcoat", kClearcoat),
                                 object("KHR_materials_sheen", kSheen),
                                 object("KHR_materials_iridescence", kIridescence),
                                 object("KHR_materials_anisotropy", kAnisotropy)};
const Schema kMaterial{text("name"),
                       object("pbrMetallicRoughness", kMetallicRoughness),
                       object("normalTexture", kTextureInfo),
                       object("occlusionTexture", kTextureInfo),
                       object("emissiveTexture", kTextureInfo),
                       numbers("emissiveFactor", 3),
                       name_of("alphaMode", {"OPAQUE", "MASK", "BLEND"}),
                       number("alphaCutoff", 0, kLargest),
                       flag("doubleSided"),
                       object("extensions", kMaterialExtensions)};

// Meshes.
const Schema kDracoPrimitive{
    index("bufferView", "/bufferViews", true),
    {.key = "attributes", .kind = K::kIntegerMap, .required = true, .min = 0, .max = kMostSparse}};
SchemaRule posed(SchemaRule rule) {
  rule.posed_only = true;
  return rule;
}
const SchemaRule kWeightList = posed(numbers("weights", 0));
const SchemaRule kTargetList = posed({.key = "targets", .kind = K::kIndexMaps, .refers_to = "/accessors"});
const Schema kGaussianSplatting{name_of("kernel", {"ellipse"}, true),
                                name_of("colorSpace", {"srgb_rec709_display", "lin_rec709_display"}, true),
                                name_of("projection", {"perspective"}), name_of("sortingMethod", {"cameraDistance"})};
const Schema kPrimitiveExtensions{object("KHR_draco_mesh_compression", kDracoPrimitive),
                                  object("KHR_gaussian_splatting", kGaussianSplatting)};
const Schema kPrimitive{index_map("attributes", "/accessors"),
                        index("indices", "/accessors"),
                        index("material", "/materials"),
                        integer("mode", 0, 6),
                        kTargetList,
                        object("extensions", kPrimitiveExtensions)};
const Schema kMesh{text("name"), objects("primitives", kPrimitive, true), kWeightList};

// Cameras and lights.
const Schema kPerspective{number("yfov", 1e-6, kPi, true), number("aspectRatio", 1e-6, 1e6),
                          number("znear", 0, kLargest, true), number("zfar", 0, kLargest)};
const Schema kOrthographic{number("xmag"), number("ymag"), number("znear", 0, kLargest, true),
                           number("zfar", 0, kLargest, true)};
const Schema kCamera{text("name"), name_of("type", {"perspective", "orthographic"}, true),
                     object("perspective", kPerspective), object("orthographic", kOrthographic)};
const Schema kSpot{number("innerConeAngle", 0, kHalfPi), number("outerConeAngle", 0, kHalfPi)};
const Schema kLight{text("name"),
                    name_of("type", {"directional", "point", "spot"}, true),
                    numbers("color", 3),
                    number("intensity", 0, kLargest),
                    number("range", 0, kLargest),
                    object("spot", kSpot)};
const Schema kLights{objects("lights", kLight, true)};
const Schema kRootExtensions{object("KHR_lights_punctual", kLights)};

// Nodes and scenes.
const Schema kNodeLight{index("light", "/extensions/KHR_lights_punctual/lights", true)};
const Schema kNodeInstancing{index_map("attributes", "/accessors")};
const Schema kNodeVisibility{flag("visible")};
const Schema kNodeExtensions{object("KHR_lights_punctual", kNodeLight),
                             object("EXT_mesh_gpu_instancing", kNodeInstancing),
                             object("KHR_node_visibility", kNodeVisibility)};
const Schema kSphere{number("radius", 1e-20, 1e18, true), index("material", "/materials")};
const Schema kNodeExtras{object("carousel_sphere", kSphere)};
const Schema kNode{text("name"),
                   indices("children", "/nodes"),
                   index("mesh", "/meshes"),
                   index("camera", "/cameras"),
                   index("skin", "/skins"),
                   numbers("matrix", 16),
                   numbers("translation", 3),
                   numbers("rotation", 4),
                   numbers("scale", 3),
                   kWeightList,
                   object("extensions", kNodeExtensions),
                   {.key = "extras", .kind = K::kExtras, .child = &kNodeExtras}};
const Schema kScene{text("name"), indices("nodes", "/nodes")};

// Skins and animations.
const Schema kSkin{index("inverseBindMatrices", "/accessors"), index("skeleton", "/nodes"),
                   indices("joints", "/nodes", true)};
const Schema kTarget{index("node", "/nodes"), text("path", true)};
const Schema kChannel{integer("sampler", 0, kMostSparse, true), object("target", kTarget, true)};
const Schema kAnimationSampler{index("input", "/accessors", true), index("output", "/accessors", true),
                               posed(name_of("interpolation", {"LINEAR", "STEP", "CUBICSPLINE"}))};
const Schema kAnimation{text("name"), objects("channels", kChannel, true),
                        objects("samplers", kAnimationSampler, true)};

// The order of the checks: extensions come before the nodes whose indices refer to them.
const Schema kRoot{object("asset", kAsset, true),
                   texts("extensionsUsed"),
                   texts("extensionsRequired"),
                   object("extensions", kRootExtensions),
                   index("scene", "/scenes"),
                   objects("scenes", kScene),
                   objects("nodes", kNode),
                   objects("meshes", kMesh),
                   objects("materials", kMaterial),
                   objects("textures", kTexture),
                   objects("images", kImage),
                   objects("samplers", kSampler),
                   objects("cameras", kCamera),
                   objects("accessors", kAccessor),
                   objects("bufferViews", kBufferView),
                   objects("buffers", kBuffer),
                   objects("skins", kSkin),
                   objects("animations", kAnimation)};

}  // namespace

const Schema& gltf_schema() {
  return kRoot;
}

}  // namespace carousel::scene
