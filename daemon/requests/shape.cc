// What the fingers have felt of the object's surface.

#include <algorithm>

#include "core/session/shape_judge.h"
#include "core/shape/felt_mesh.h"
#include "core/world/true_surface.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp::handlers {
namespace {

Json Vector(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

constexpr int kDivisions = 3;  // of the mesh: 642 vertices

Json TruthJson(const FeltSurface& felt, const TrueSurface& truth) {
  const ShapeErrors errors = JudgeShape(felt, truth);
  if (errors.cells == 0) return {};
  return {{"cells", errors.cells},
          {"rms_error_m", errors.rms_m},
          {"mean_error_m", errors.mean_m},
          {"normal_error_rad", errors.normal_rad}};
}

Json MeshJson(const FeltSurface& felt, const TrueSurface& truth) {
  const FeltMesh mesh = MeshOf(felt, kDivisions);
  Json vertices = Json::array(), normals = Json::array(), unknown = Json::array(),
       errors = Json::array(), triangles = Json::array();
  for (const SurfacePoint& point : mesh.vertices) {
    vertices.push_back(Vector(point.p_O));
    normals.push_back(Vector(point.normal_O));
    unknown.push_back(point.unknown);
    errors.push_back(truth.At(point.p_O).distance);
  }
  for (const Eigen::Vector3i& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  return {{"vertices_O_m", std::move(vertices)},
          {"normals_O", std::move(normals)},
          {"unknown_rad", std::move(unknown)},
          {"error_m", std::move(errors)},
          {"triangles", std::move(triangles)}};
}

}  // namespace

Outcome Shape(Service& service, const Params& params, Client&) {
  service.CheckNotFaulted();
  Outcome outcome;
  outcome.begin = [&service, with_mesh = params.Bool("mesh", false),
                   object = service.accepted().object](Done done) {
    service.Mark(
        ControlRequest::Part::kFelt, [&service, with_mesh, object, done](const JournalNews& mark) {
          const auto make = [felt = mark.felt, with_mesh, object, tick = mark.entry.tick,
                             dt = service.dt()]() -> Json {
            const TrueSurface truth(*object);
            Json json = {
                {"tick", tick},
                {"time_s", static_cast<double>(tick) * dt},
                {"object", object->name},
                {"touched_fraction", felt->touched_share()},
                {"touched_cells", felt->touched_cells()},
                {"cells", FeltSurface::kCells},
                {"mean_radius_m", felt->touched_cells() > 0 ? Json(felt->mean_radius()) : Json()},
                {"truth", TruthJson(*felt, truth)}};
            if (with_mesh) json["mesh"] = MeshJson(*felt, truth);
            return json;
          };
          try {
            Later(service, make).begin(done);
          } catch (const RpcException& e) {
            done({}, &e.error());
          }
        });
  };
  return outcome;
}

}  // namespace regrasp::handlers
