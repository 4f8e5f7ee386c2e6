#include "core/journal/run_scene.h"

#include <cmath>

#include "core/hand/kinematics.h"

namespace regrasp::scene {
namespace {

constexpr const char* kWorld = "W";
constexpr const char* kObject = "O";
constexpr double kContactDiameter = 0.004, kShaftDiameter = 0.0015, kHeadDiameter = 0.004;  // [m]
constexpr double kHeadShare = 0.25;  // of an arrow's length

double Round(double x) { return std::round(x * 1e10) / 1e10 + 0.0; }  // no -0

Json Xyz(const Vector3d& v) {
  return {{"x", Round(v.x())}, {"y", Round(v.y())}, {"z", Round(v.z())}};
}
Json Xyzw(const Quaterniond& q) {
  return {{"x", Round(q.x())}, {"y", Round(q.y())}, {"z", Round(q.z())}, {"w", Round(q.w())}};
}
Json Pose(const Vector3d& position, const Quaterniond& orientation) {
  return {{"position", Xyz(position)}, {"orientation", Xyzw(orientation)}};
}
Json Colour(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

// Schemas.

Json Type(const char* type) { return {{"type", type}}; }
Json Object(std::initializer_list<std::pair<const char*, Json>> members) {
  Json properties = Json::object();
  for (const auto& [name, schema] : members) properties[name] = schema;
  return {{"type", "object"}, {"properties", std::move(properties)}};
}
Json ListOf(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }
Json XyzSchema() {
  return Object({{"x", Type("number")}, {"y", Type("number")}, {"z", Type("number")}});
}
Json XyzwSchema() {
  return Object(
      {{"x", Type("number")}, {"y", Type("number")}, {"z", Type("number")}, {"w", Type("number")}});
}
Json PoseSchema() { return Object({{"position", XyzSchema()}, {"orientation", XyzwSchema()}}); }
Json ColourSchema() {
  return Object(
      {{"r", Type("number")}, {"g", Type("number")}, {"b", Type("number")}, {"a", Type("number")}});
}

/// The lists of primitives that an entity has, each with the members of its items.
Json PrimitiveSchemas() {
  const Json number = Type("number"), text = Type("string"), truth = Type("boolean");
  const Json pose = PoseSchema(), size = XyzSchema(), colour = ColourSchema();
  return {{"arrows", ListOf(Object({{"pose", pose},
                                    {"shaft_length", number},
                                    {"shaft_diameter", number},
                                    {"head_length", number},
                                    {"head_diameter", number},
                                    {"color", colour}}))},
          {"cubes", ListOf(Object({{"pose", pose}, {"size", size}, {"color", colour}}))},
          {"spheres", ListOf(Object({{"pose", pose}, {"size", size}, {"color", colour}}))},
          {"cylinders", ListOf(Object({{"pose", pose},
                                       {"size", size},
                                       {"bottom_scale", number},
                                       {"top_scale", number},
                                       {"color", colour}}))},
          {"lines", ListOf(Object({{"type", Type("integer")},
                                   {"pose", pose},
                                   {"thickness", number},
                                   {"scale_invariant", truth},
                                   {"points", ListOf(XyzSchema())},
                                   {"color", colour},
                                   {"colors", ListOf(colour)},
                                   {"indices", ListOf(Type("integer"))}}))},
          {"triangles", ListOf(Object({{"pose", pose},
                                       {"points", ListOf(XyzSchema())},
                                       {"color", colour},
                                       {"colors", ListOf(colour)},
                                       {"indices", ListOf(Type("integer"))}}))},
          {"texts", ListOf(Object({{"pose", pose},
                                   {"billboard", truth},
                                   {"font_size", number},
                                   {"scale_invariant", truth},
                                   {"color", colour},
                                   {"text", text}}))},
          {"models", ListOf(Object({{"pose", pose},
                                    {"scale", size},
                                    {"color", colour},
                                    {"override_color", truth},
                                    {"url", text},
                                    {"media_type", text}}))}};
}

// Entities.

Json Entity(const std::string& id, const std::string& frame, std::uint64_t time_ns) {
  Json entity = {{"timestamp", Time(time_ns)}, {"frame_id", frame},        {"id", id},
                 {"lifetime", Time(0)},  // until it is replaced
                 {"frame_locked", true},       {"metadata", Json::array()}};
  for (const char* primitive :
       {"arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
    entity[primitive] = Json::array();
  return entity;
}

void AddSphere(const Vector3d& centre, double diameter, const Json& colour, Json* entity) {
  (*entity)["spheres"].push_back({{"pose", Pose(centre, Quaterniond::Identity())},
                                  {"size", Xyz(Vector3d::Constant(diameter))},
                                  {"color", colour}});
}

void AddCapsule(const Vector3d& a, const Vector3d& b, double radius, const Json& colour,
                Json* entity) {
  AddSphere(a, 2 * radius, colour, entity);
  const double length = (b - a).norm();
  if (length < 1e-9) return;
  AddSphere(b, 2 * radius, colour, entity);
  const auto q = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), b - a);
  (*entity)["cylinders"].push_back({{"pose", Pose((a + b) / 2, q)},
                                    {"size", Xyz({2 * radius, 2 * radius, length})},
                                    {"bottom_scale", 1.0},
                                    {"top_scale", 1.0},
                                    {"color", colour}});
}

void AddBox(const Isometry3d& X, const Vector3d& half_extents, const Json& colour, Json* entity) {
  (*entity)["cubes"].push_back({{"pose", Pose(X.translation(), Quaterniond(X.linear()))},
                                {"size", Xyz(2 * half_extents)},
                                {"color", colour}});
}

Json LinkEntity(const Link& link, std::uint64_t time_ns) {
  const Json colour = Colour(0.72, 0.74, 0.78, 1.0);
  Json entity = Entity("link " + link.name, link.name, time_ns);
  for (const Shape& shape : link.shapes) {
    if (shape.kind == Shape::Kind::kBox)
      AddBox(shape.X_LB, shape.half_extents, colour, &entity);
    else
      AddCapsule(shape.a_L, shape.b_L, shape.radius, colour, &entity);
  }
  return entity;
}

Json ObjectEntity(const ObjectModel& object, std::uint64_t time_ns) {
  using Kind = ObjectModel::Kind;
  const Json colour = Colour(0.93, 0.60, 0.20, 0.7);
  Json entity = Entity("object", kObject, time_ns);
  if (object.kind == Kind::kSphere) AddSphere(Vector3d::Zero(), 2 * object.radius, colour, &entity);
  if (object.kind == Kind::kBox)
    AddBox(Isometry3d::Identity(), object.half_extents, colour, &entity);
  if (object.kind != Kind::kMesh) return entity;
  Json points = Json::array(), indices = Json::array();
  for (const Vector3d& vertex : object.vertices_O) points.push_back(Xyz(vertex));
  for (const Eigen::Vector3i& triangle : object.triangles)
    for (int i = 0; i < 3; ++i) indices.push_back(triangle[i]);
  entity["triangles"].push_back({{"pose", Pose(Vector3d::Zero(), Quaterniond::Identity())},
                                 {"points", std::move(points)},
                                 {"color", colour},
                                 {"colors", Json::array()},
                                 {"indices", std::move(indices)}});
  return entity;
}

Json Transform(const std::string& child, const Vector3d& p, const Quaterniond& q,
               std::uint64_t time_ns) {
  return {{"timestamp", Time(time_ns)},
          {"parent_frame_id", kWorld},
          {"child_frame_id", child},
          {"translation", Xyz(p)},
          {"rotation", Xyzw(q)}};
}

}  // namespace

Json Time(std::uint64_t time_ns) {
  return {{"sec", time_ns / 1'000'000'000}, {"nsec", time_ns % 1'000'000'000}};
}

Json TimeSchema() { return Object({{"sec", Type("integer")}, {"nsec", Type("integer")}}); }

Json TransformsSchema() {
  return Object({{"transforms", ListOf(Object({{"timestamp", TimeSchema()},
                                               {"parent_frame_id", Type("string")},
                                               {"child_frame_id", Type("string")},
                                               {"translation", XyzSchema()},
                                               {"rotation", XyzwSchema()}}))}});
}

Json SceneSchema() {
  Json entity =
      Object({{"timestamp", TimeSchema()},
              {"frame_id", Type("string")},
              {"id", Type("string")},
              {"lifetime", TimeSchema()},
              {"frame_locked", Type("boolean")},
              {"metadata", ListOf(Object({{"key", Type("string")}, {"value", Type("string")}}))}});
  entity["properties"].update(PrimitiveSchemas());
  return Object({{"deletions", ListOf(Object({{"timestamp", TimeSchema()},
                                              {"type", Type("integer")},
                                              {"id", Type("string")}}))},
                 {"entities", ListOf(std::move(entity))}});
}

Json Transforms(const Frame& frame, const RunPlace& place) {
  const HandModel& hand = place.config.model.hand;
  KinematicsData kinematics;
  ForwardKinematics(hand, frame.q, &kinematics);
  Json list = Json::array();
  for (std::size_t i = 0; i < hand.links.size(); ++i) {
    const Isometry3d& X_WL = kinematics.X_WL[i];
    list.push_back(Transform(hand.links[i].name, X_WL.translation(), Quaterniond(X_WL.linear()),
                             place.time_ns));
  }
  list.push_back(Transform(kObject, frame.p_WO, frame.q_WO, place.time_ns));
  return {{"transforms", std::move(list)}};
}

Json Shapes(const RunPlace& place) {
  Json entities = Json::array();
  for (const Link& link : place.config.model.hand.links)
    entities.push_back(LinkEntity(link, place.time_ns));
  entities.push_back(ObjectEntity(place.config.model.object, place.time_ns));
  return {{"deletions", Json::array()}, {"entities", std::move(entities)}};
}

Json Contacts(const Frame& frame, const RunPlace& place) {
  const Json point = Colour(0.10, 0.55, 0.25, 1.0), force = Colour(0.80, 0.15, 0.15, 1.0);
  Json entity = Entity("contacts", kWorld, place.time_ns);
  entity["metadata"].push_back({{"key", "arrow_m_per_n"}, {"value", Json(kArrowPerNewton).dump()}});
  for (const Frame::Contact& contact : frame.contacts) {
    AddSphere(contact.p_WC, kContactDiameter, point, &entity);
    const double length = kArrowPerNewton * contact.force_W.norm();
    if (length < 1e-9) continue;
    const auto q = Quaterniond::FromTwoVectors(Vector3d::UnitX(), contact.force_W);
    entity["arrows"].push_back({{"pose", Pose(contact.p_WC, q)},
                                {"shaft_length", Round((1 - kHeadShare) * length)},
                                {"shaft_diameter", kShaftDiameter},
                                {"head_length", Round(kHeadShare * length)},
                                {"head_diameter", kHeadDiameter},
                                {"color", force}});
  }
  return {{"deletions", Json::array()}, {"entities", Json::array({std::move(entity)})}};
}

}  // namespace regrasp::scene
