// The peer Embree: candidates by its `rtcCollide`, each decided by the exact predicates of CGAL.
//
// Embree has no test of two triangles for `rtcCollide`: triangles are a geometry of the user, with AABBs in single precision, here rounded
// outwards, and a callback gets the pairs whose AABBs overlap. One thread, as of all testers.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangle_3.h>
#include <CGAL/intersections.h>
#include <CGAL/version.h>
#include <embree3/rtcore.h>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct Mesh {
  const double *positions;    // 3 for each vertex; the caller keeps them
  const std::int64_t *faces;  // 3 for each triangle
  RTCDevice device;
  RTCScene scene;
  std::vector<std::int64_t> pairs;
  bool first_only;
};

const double *vertex(const Mesh &mesh, unsigned triangle, int corner) {
  return mesh.positions + 3 * mesh.faces[3 * std::size_t{triangle} + corner];
}

// A number of single precision that is not above x; by its negative, one that is not below.
float rounded_down(double x) {
  const auto near = static_cast<float>(x);
  return near <= x ? near : std::nextafter(near, -std::numeric_limits<float>::infinity());
}

void bounds(const RTCBoundsFunctionArguments *arguments) {
  const Mesh &mesh = *static_cast<const Mesh *>(arguments->geometryUserPtr);
  float lower[3], upper[3];
  for (int axis = 0; axis < 3; ++axis) {
    double least = vertex(mesh, arguments->primID, 0)[axis], most = least;
    for (int corner = 1; corner < 3; ++corner) {
      const double x = vertex(mesh, arguments->primID, corner)[axis];
      least = std::fmin(least, x);
      most = std::fmax(most, x);
    }
    lower[axis] = rounded_down(least);
    upper[axis] = -rounded_down(-most);
  }
  RTCBounds &box = *arguments->bounds_o;
  box.lower_x = lower[0], box.lower_y = lower[1], box.lower_z = lower[2];
  box.upper_x = upper[0], box.upper_y = upper[1], box.upper_z = upper[2];
}

bool have_common_vertex(const Mesh &mesh, unsigned a, unsigned b) {
  const std::int64_t *f = mesh.faces + 3 * std::size_t{a}, *g = mesh.faces + 3 * std::size_t{b};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (f[i] == g[j]) return true;
  return false;
}

Kernel::Triangle_3 triangle(const Mesh &mesh, unsigned t) {
  const auto point = [&](int corner) {
    const double *x = vertex(mesh, t, corner);
    return Kernel::Point_3(x[0], x[1], x[2]);
  };
  return {point(0), point(1), point(2)};
}

// The traversal cannot be stopped from here; once a pair is found that is enough, no further one is tested.
void collide(void *user, RTCCollision *collisions, unsigned count) {
  Mesh &mesh = *static_cast<Mesh *>(user);
  for (unsigned k = 0; k < count; ++k) {
    const unsigned a = collisions[k].primID0, b = collisions[k].primID1;
    if (a >= b || (mesh.first_only && !mesh.pairs.empty()) || have_common_vertex(mesh, a, b)) continue;
    if (CGAL::do_intersect(triangle(mesh, a), triangle(mesh, b))) {
      mesh.pairs.push_back(a);
      mesh.pairs.push_back(b);
    }
  }
}

}  // namespace

extern "C" {

int peer_embree_version() { return RTC_VERSION; }

int peer_cgal_version() { return CGAL_VERSION_NR; }

// A mesh with its hierarchy, at positions and faces that stay until it is freed.
void *peer_make(const double *positions, const std::int64_t *faces, std::int64_t triangles) {
  auto *mesh = new Mesh{positions, faces, rtcNewDevice("threads=1"), nullptr, {}, false};
  mesh->scene = rtcNewScene(mesh->device);
  RTCGeometry geometry = rtcNewGeometry(mesh->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles));
  rtcSetGeometryUserData(geometry, mesh);
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(mesh->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(mesh->scene);
  return mesh;
}

// The number of pairs found: all, or enough for yes or no. Negative: an error of Embree.
std::int64_t peer_collide(void *handle, int first_only) {
  Mesh &mesh = *static_cast<Mesh *>(handle);
  mesh.pairs.clear();
  mesh.first_only = first_only != 0;
  rtcCollide(mesh.scene, mesh.scene, collide, &mesh);
  const RTCError error = rtcGetDeviceError(mesh.device);
  return error == RTC_ERROR_NONE ? static_cast<std::int64_t>(mesh.pairs.size() / 2) : -static_cast<std::int64_t>(error);
}

// The pairs of the last answer, 2 triangles for each.
const std::int64_t *peer_pairs(void *handle) { return static_cast<Mesh *>(handle)->pairs.data(); }

void peer_free(void *handle) {
  auto *mesh = static_cast<Mesh *>(handle);
  rtcReleaseScene(mesh->scene);
  rtcReleaseDevice(mesh->device);
  delete mesh;
}
}
