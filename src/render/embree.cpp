#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include "core/error.h"
#include "render/module_doors.h"

namespace chromeball::render::embree {
namespace {

struct Built {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    Built() = default;
    Built(const Built&) = delete;
    Built& operator=(const Built&) = delete;
    ~Built() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

template <class T>
T* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride,
              std::size_t count) {
    void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
    if (!memory)
        throw Error(Error::Kind::failed,
                    "not enough memory for the scene's triangles; use a simpler mesh");
    return static_cast<T*>(memory);
}

/// Of a geometry that is made and then handed to a scene.
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Geometry = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

Geometry ball_geometry(RTCDevice device, const Ball& ball) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT));
    auto* at = new_buffer<float>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 16, 1);
    const V3f center(ball.center);
    std::copy_n(&center.x, 3, at);
    at[3] = static_cast<float>(ball.radius);
    return geometry;
}

Geometry mesh_geometry(RTCDevice device, const Mesh& mesh) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* positions = new_buffer<V3f>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                                      sizeof(V3f), mesh.positions.size());
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    auto* triangles = new_buffer<std::array<std::uint32_t, 3>>(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 12, mesh.triangles.size());
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    return geometry;
}

const Built& of(void* built) { return *static_cast<const Built*>(built); }

}  // namespace

void* build(const Scene& scene) {
    auto built = std::make_unique<Built>();
    built->device = rtcNewDevice("set_affinity=0");
    if (!built->device)
        throw Error(Error::Kind::failed, "the ray tracer cannot be started on this processor");
    built->scene = rtcNewScene(built->device);
    rtcSetSceneFlags(built->scene, RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        const Geometry geometry = object.ball ? ball_geometry(built->device, *object.ball)
                                              : mesh_geometry(built->device, object.mesh);
        rtcCommitGeometry(geometry.get());
        rtcAttachGeometryByID(built->scene, geometry.get(), static_cast<unsigned>(i));
    }
    rtcCommitScene(built->scene);
    if (const RTCError error = rtcGetDeviceError(built->device); error != RTC_ERROR_NONE)
        throw Error(Error::Kind::failed,
                    error == RTC_ERROR_OUT_OF_MEMORY
                        ? "not enough memory for the scene's triangles; use a simpler mesh"
                        : fmt::format("the ray tracer refuses the scene (its error {})",
                                      static_cast<int>(error)));
    return built.release();
}

void destroy(void* built) { delete static_cast<Built*>(built); }

void intersect_packet(void* built, const RayPacket& rays, Hit* hits) {
    constexpr int n = RayPacket::kRays;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit16 all;
    static_assert(sizeof(all.ray.org_x) == sizeof(rays.ox));
    std::memcpy(all.ray.org_x, rays.ox, sizeof rays.ox);
    std::memcpy(all.ray.org_y, rays.oy, sizeof rays.oy);
    std::memcpy(all.ray.org_z, rays.oz, sizeof rays.oz);
    std::memcpy(all.ray.tnear, rays.from, sizeof rays.from);
    std::memcpy(all.ray.dir_x, rays.dx, sizeof rays.dx);
    std::memcpy(all.ray.dir_y, rays.dy, sizeof rays.dy);
    std::memcpy(all.ray.dir_z, rays.dz, sizeof rays.dz);
    std::fill_n(all.ray.tfar, n, std::numeric_limits<float>::infinity());
    std::fill_n(all.ray.time, n, 0.0F);
    std::fill_n(all.ray.mask, n, ~0U);
    std::fill_n(all.ray.flags, n, 0U);
    std::fill_n(all.hit.geomID, n, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(all.hit.instID[0], n, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect16(rays.valid, of(built).scene, &context, &all);
    for (int i = 0; i < n; ++i)
        hits[i] = {rays.valid[i] != 0 ? all.hit.geomID[i] : Hit::kNothing, all.hit.primID[i],
                   all.ray.tfar[i], all.hit.u[i], all.hit.v[i]};
}

Hit intersect(void* built, const V3f& origin, const V3f& direction, float from) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit one{};
    one.ray.org_x = origin.x;
    one.ray.org_y = origin.y;
    one.ray.org_z = origin.z;
    one.ray.dir_x = direction.x;
    one.ray.dir_y = direction.y;
    one.ray.dir_z = direction.z;
    one.ray.tnear = from;
    one.ray.tfar = std::numeric_limits<float>::infinity();
    one.ray.mask = ~0U;
    one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(of(built).scene, &context, &one);
    return {one.hit.geomID, one.hit.primID, one.ray.tfar, one.hit.u, one.hit.v};
}

}  // namespace chromeball::render::embree
