#include "bench/common/embree_peer.h"

#include <atomic>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <embree3/rtcore.h>

#include "bench/common/batch_threads.h"
#include "bench/common/stopwatch.h"

namespace carousel::bench {

namespace {

RTCGeometry triangles(RTCDevice device, const scene::Mesh& mesh, const scene::Affine& place) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.positions.size()));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = place.linear * mesh.positions[i] + place.translation;
    for (std::size_t axis = 0; axis < 3; ++axis) vertices[3 * i + axis] = p[static_cast<int>(axis)];
  }
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), mesh.triangle_count());
  std::memcpy(indices, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCGeometry instance_of(RTCDevice device, RTCScene scene, const scene::Affine& place) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, scene);
  float columns[12];
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) columns[3 * c + r] = c < 3 ? place.linear[c][r] : place.translation[r];
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCRay start(const Ray& ray) {
  RTCRay out{};
  out.org_x = ray.origin.x, out.org_y = ray.origin.y, out.org_z = ray.origin.z;
  out.dir_x = ray.direction.x, out.dir_y = ray.direction.y, out.dir_z = ray.direction.z;
  out.tnear = ray.tmin, out.tfar = ray.tmax;
  out.mask = ~0u;
  return out;
}

constexpr float kOccluded = -std::numeric_limits<float>::infinity();

/// Sixteen rays of a batch from `first` on, and which of them exist.
void start16(const RayBatch& batch, std::size_t first, RTCRay16& out, int* valid) {
  for (std::size_t l = 0; l < 16; ++l) {
    valid[l] = first + l < batch.size() ? -1 : 0;
    const Ray& ray = batch[valid[l] ? first + l : first].ray;
    out.org_x[l] = ray.origin.x, out.org_y[l] = ray.origin.y, out.org_z[l] = ray.origin.z;
    out.dir_x[l] = ray.direction.x, out.dir_y[l] = ray.direction.y, out.dir_z[l] = ray.direction.z;
    out.tnear[l] = ray.tmin, out.tfar[l] = ray.tmax;
    out.time[l] = 0, out.mask[l] = ~0u, out.id[l] = 0, out.flags[l] = 0;
  }
}

// A mesh placed once has its own geometry ID, an instance its instID; both number the scene's instances.
Hit finish(float t, float u, float v, unsigned geometry, unsigned instance, unsigned primitive) {
  if (geometry == RTC_INVALID_GEOMETRY_ID) return {};
  return {t, u, v, instance != RTC_INVALID_GEOMETRY_ID ? instance : geometry, primitive};
}

Hit occlusion(float tfar) {
  Hit hit;
  if (tfar == kOccluded) hit.instance = 0;
  return hit;
}

}  // namespace

class EmbreePeer::Impl {
 public:
  Impl(const scene::Scene& scene, const EmbreeSettings& settings) : settings_(settings) {
    device_ = rtcNewDevice(("set_affinity=0,threads=" + std::to_string(settings.build_threads) +
                            ",frequency_level=" + settings.frequency_level)
                               .c_str());
    if (device_ == nullptr) throw std::runtime_error("Embree gives no device for " + settings.frequency_level);
    rtcSetDeviceMemoryMonitorFunction(device_, &Impl::count_bytes, this);
    std::vector<int> uses(scene.meshes.size());
    for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh.value];
    std::vector<RTCScene> shared(scene.meshes.size());
    scene_ = new_scene();
    std::vector<std::pair<RTCGeometry, unsigned>> geometries;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const std::uint32_t mesh = scene.instances[i].mesh.value;
      if (uses[mesh] > 1 && shared[mesh] == nullptr) {
        shared[mesh] = new_scene();
        attach(shared[mesh], triangles(device_, scene.meshes[mesh], {}), 0);
        commit(shared[mesh]);
      }
      const scene::Affine& place = scene.instances[i].world_from_model;
      attach(scene_,
             uses[mesh] > 1 ? instance_of(device_, shared[mesh], place) : triangles(device_, scene.meshes[mesh], place),
             static_cast<unsigned>(i));
    }
    commit(scene_);
    for (const RTCScene one : shared)
      if (one != nullptr) rtcReleaseScene(one);  // the instances keep a reference to it
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
      throw std::runtime_error("Embree: error " + std::to_string(error) + " while building " + scene.name);
  }
  ~Impl() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  RTCIntersectContext context(const RaySet& rays) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = rays.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
  }

  EmbreeSettings settings_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  double build_seconds_ = 0;
  std::atomic<std::ptrdiff_t> bytes_{0};

 private:
  static bool count_bytes(void* self, ssize_t bytes, bool) {
    // Relaxed: a sum, read when no build runs.
    static_cast<Impl*>(self)->bytes_.fetch_add(bytes, std::memory_order_relaxed);
    return true;
  }
  RTCScene new_scene() {
    RTCScene scene = rtcNewScene(device_);
    if (settings_.robust) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(
        scene, settings_.quality == EmbreeQuality::kHigh ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    return scene;
  }
  static void attach(RTCScene scene, RTCGeometry geometry, unsigned id) {
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
  void commit(RTCScene scene) {
    const Stopwatch stopwatch;
    rtcCommitScene(scene);
    build_seconds_ += stopwatch.elapsed().wall;
  }
};

EmbreePeer::EmbreePeer(const scene::Scene& scene, const EmbreeSettings& settings)
    : impl_(std::make_unique<Impl>(scene, settings)) {}
EmbreePeer::~EmbreePeer() = default;
EmbreePeer::EmbreePeer(EmbreePeer&&) noexcept = default;
double EmbreePeer::build_seconds() const {
  return impl_->build_seconds_;
}
std::size_t EmbreePeer::size_bytes() const {
  return static_cast<std::size_t>(impl_->bytes_.load());
}

void EmbreePeer::trace_single(const RaySet& rays, int threads, HitList& hits) const {
  for_each_batch(rays, threads, [&] {
    return [&, context = impl_->context(rays)](const RayBatch& batch) mutable {
      for (const RayRequest& request : batch) {
        if (rays.any_hit) {
          RTCRay ray = start(request.ray);
          rtcOccluded1(impl_->scene_, &context, &ray);
          hits[request.tag.path] = occlusion(ray.tfar);
        } else {
          RTCRayHit rh{start(request.ray), {}};
          rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
          rtcIntersect1(impl_->scene_, &context, &rh);
          hits[request.tag.path] =
              finish(rh.ray.tfar, rh.hit.u, rh.hit.v, rh.hit.geomID, rh.hit.instID[0], rh.hit.primID);
        }
      }
    };
  });
}

void EmbreePeer::trace_sixteen(const RaySet& rays, int threads, HitList& hits) const {
  for_each_batch(rays, threads, [&] {
    return [&, context = impl_->context(rays)](const RayBatch& batch) mutable {
      alignas(64) int valid[16];
      alignas(64) RTCRayHit16 rh;
      for (std::size_t first = 0; first < batch.size(); first += 16) {
        start16(batch, first, rh.ray, valid);
        if (rays.any_hit) {
          rtcOccluded16(valid, impl_->scene_, &context, &rh.ray);
        } else {
          for (int l = 0; l < 16; ++l) rh.hit.geomID[l] = rh.hit.instID[0][l] = RTC_INVALID_GEOMETRY_ID;
          rtcIntersect16(valid, impl_->scene_, &context, &rh);
        }
        for (std::size_t l = 0; l < 16 && valid[l]; ++l)
          hits[batch[first + l].tag.path] = rays.any_hit
                                                ? occlusion(rh.ray.tfar[l])
                                                : finish(rh.ray.tfar[l], rh.hit.u[l], rh.hit.v[l], rh.hit.geomID[l],
                                                         rh.hit.instID[0][l], rh.hit.primID[l]);
      }
    };
  });
}

}  // namespace carousel::bench
