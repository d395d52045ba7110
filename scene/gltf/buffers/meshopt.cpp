// EXT_meshopt_compression and KHR_meshopt_compression: the rules of their section "JSON schema updates". The bitstreams
// are read by meshoptimizer, except version 1 of attributes and the filter of colours, which came after its 0.18.
#include "scene/gltf/buffers/meshopt.h"

#include <span>
#include <string>

#include <meshoptimizer.h>

#include "scene/gltf/buffers/meshopt_attributes.h"

namespace carousel::scene {

namespace {

class MeshoptView {
 public:
  /// `extension` is one of kMeshoptExtensions.
  MeshoptView(const GltfDocument& document, const Json& view, const std::string& view_path, const char* extension)
      : document_(document),
        view_(view),
        path_(json_path(view_path + "/extensions", extension)),
        extension_(view["extensions"][extension]),
        may_be_v1_(extension == kMeshoptExtensions[1]),
        length_(view["byteLength"].get<std::uint64_t>()),
        count_(extension_["count"].get<std::uint64_t>()),
        stride_(extension_["byteStride"].get<std::uint64_t>()),
        mode_(extension_["mode"].get<std::string>()),
        filter_(extension_.value("filter", "NONE")) {}

  Bytes decode(const GltfModel& model, const ImportBudget& budget) const {
    check_parameters();
    const std::span<const unsigned char> packed = source(model);
    budget.take(length_, json_path(path_, "count"), std::to_string(count_) + " elements: the view");
    Bytes out(static_cast<std::size_t>(length_));
    const auto count = static_cast<std::size_t>(count_), stride = static_cast<std::size_t>(stride_);
    const bool attributes_v1 = mode_ == "ATTRIBUTES" && may_be_v1_ && is_attributes_v1(packed);
    const int failure =
        attributes_v1           ? decode_attributes_v1(out, stride, packed) ? 0 : 1
        : mode_ == "ATTRIBUTES" ? meshopt_decodeVertexBuffer(out.data(), count, stride, packed.data(), packed.size())
        : mode_ == "TRIANGLES"  ? meshopt_decodeIndexBuffer(out.data(), count, stride, packed.data(), packed.size())
                                : meshopt_decodeIndexSequence(out.data(), count, stride, packed.data(), packed.size());
    if (failure != 0) document_.fail(path_, "the compressed data is broken or ends early");
    if (filter_ == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
    if (filter_ == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count, stride);
    if (filter_ == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
    if (filter_ == "COLOR") decode_filter_color(out, stride);
    return out;
  }

 private:
  [[noreturn]] void fail(const char* key, const std::string& message) const {
    document_.fail(json_path(path_, key), message);
  }

  void check_parameters() const {
    const bool attributes = mode_ == "ATTRIBUTES";
    if (attributes ? stride_ % 4 != 0 : stride_ != 2 && stride_ != 4) {
      fail("byteStride", std::string(attributes ? "expected a multiple of 4" : "expected 2 or 4") + " in mode " +
                             mode_ + ", found " + std::to_string(stride_));
    }
    if (mode_ == "TRIANGLES" && count_ % 3 != 0) {
      fail("count", "expected a multiple of 3 in mode TRIANGLES, found " + std::to_string(count_));
    }
    if (filter_ != "NONE" && !attributes) fail("filter", "filters go with mode ATTRIBUTES only");
    const bool four_components = filter_ == "OCTAHEDRAL" || filter_ == "COLOR";
    if ((four_components && stride_ != 4 && stride_ != 8) || (filter_ == "QUATERNION" && stride_ != 8)) {
      fail("filter", "filter " + filter_ + " does not go with a byteStride of " + std::to_string(stride_));
    }
    if (length_ % stride_ != 0 || length_ / stride_ != count_) {  // a product might wrap
      fail("count", std::to_string(count_) + " elements of " + std::to_string(stride_) +
                        " bytes are not the buffer view's " + std::to_string(length_));
    }
    if (view_.value("byteStride", stride_) != stride_) {
      fail("byteStride", "the buffer view's own is " + view_["byteStride"].dump());
    }
  }

  std::span<const unsigned char> source(const GltfModel& model) const {
    const auto buffer = extension_["buffer"].get<std::size_t>();
    if (!model.buffer_has_data[buffer]) fail("buffer", "buffer " + std::to_string(buffer) + " holds no data");
    const auto offset = extension_.value("byteOffset", std::uint64_t{0});
    const auto size = extension_["byteLength"].get<std::uint64_t>();
    const auto announced = document_.json["buffers"][buffer]["byteLength"].get<std::uint64_t>();
    if (offset + size > announced) {  // all at most 2^53
      document_.fail(path_, "bytes " + std::to_string(offset) + " to " + std::to_string(offset + size) +
                                " lie outside buffer " + std::to_string(buffer) + ", which has " +
                                std::to_string(announced));
    }
    return std::span<const unsigned char>(model.model.buffers[buffer].data)
        .subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
  }

  const GltfDocument& document_;
  const Json& view_;
  const std::string path_;
  const Json& extension_;
  const bool may_be_v1_;
  const std::uint64_t length_, count_, stride_;
  const std::string mode_, filter_;
};

}  // namespace

std::map<std::size_t, Bytes> decode_meshopt_views(const GltfDocument& document, const GltfModel& model,
                                                  const ImportBudget& budget) {
  std::map<std::size_t, Bytes> out;
  if (!document.json.contains("bufferViews")) return out;
  const Json& views = document.json["bufferViews"];
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string path = json_path("/bufferViews", i);
    for (const char* extension : kMeshoptExtensions) {
      if (!views[i].contains("extensions") || !views[i]["extensions"].contains(extension)) continue;
      if (out.contains(i)) document.fail(json_path(path + "/extensions", extension), "the view has both names of it");
      out.emplace(i, MeshoptView(document, views[i], path, extension).decode(model, budget));
    }
  }
  return out;
}

}  // namespace carousel::scene
