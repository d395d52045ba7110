#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include <embree3/rtcore.h>

#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// A scene in Embree, robust: a tracer that shares nothing with ours.
class EmbreePeer {
 public:
  explicit EmbreePeer(const scene::Scene& scene) : device_(rtcNewDevice("threads=1")), scene_(new_scene()) {
    for (const scene::Mesh& mesh : scene.meshes) meshes_.push_back(mesh_scene(mesh));
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Affine& m = scene.instances[i].world_from_model;
      Geometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
      rtcSetGeometryInstancedScene(geometry.get(), meshes_[scene.instances[i].mesh.value].get());
      float columns[12];
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) columns[3 * c + r] = m.linear[c][r];
      for (int r = 0; r < 3; ++r) columns[9 + r] = m.translation[r];
      rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
      rtcCommitGeometry(geometry.get());
      rtcAttachGeometryByID(scene_.get(), geometry.get(), i);
    }
    rtcCommitScene(scene_.get());
    if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::runtime_error("Embree refused the scene");
  }

  Hit closest(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit q{};
    q.ray = {ray.origin.x,
             ray.origin.y,
             ray.origin.z,
             ray.tmin,
             ray.direction.x,
             ray.direction.y,
             ray.direction.z,
             0,
             ray.tmax,
             ~0u,
             0,
             0};
    q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &q);
    if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {q.ray.tfar, q.hit.u, q.hit.v, q.hit.instID[0], q.hit.primID};
  }

 private:
  struct Release {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
    void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
  };
  using Device = std::unique_ptr<RTCDeviceTy, Release>;
  using Scene = std::unique_ptr<RTCSceneTy, Release>;
  using Geometry = std::unique_ptr<RTCGeometryTy, Release>;

  Scene new_scene() const {
    Scene s(rtcNewScene(device_.get()));
    rtcSetSceneFlags(s.get(), RTC_SCENE_FLAG_ROBUST);
    return s;
  }
  Scene mesh_scene(const scene::Mesh& mesh) const {
    Scene s = new_scene();
    Geometry g(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (const Vec3& p : mesh.positions)
      for (int a = 0; a < 3; ++a) *vertices++ = p[a];
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangle_count()));
    std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
    rtcCommitGeometry(g.get());
    rtcAttachGeometryByID(s.get(), g.get(), 0);
    rtcCommitScene(s.get());
    return s;
  }

  Device device_;
  Scene scene_;
  std::vector<Scene> meshes_;
};

}  // namespace carousel::accel
