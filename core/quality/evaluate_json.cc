#include "core/quality/evaluate_json.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "core/common/nearest_name.h"
#include "core/files/json_text.h"
#include "core/quality/evaluate.h"

namespace regrasp {
namespace {

using Json = nlohmann::json;

constexpr int kMaxDepth = 32;

[[noreturn]] void Fail(const std::string& message) { throw std::invalid_argument(message); }

/// Parses strictly: no duplicate names, bounded depth, finite numbers (the parser refuses
/// overflow).
Json Parse(const std::string& text) {
  std::vector<std::set<std::string>> names;
  const auto check = [&](int depth, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    if ((event == Event::object_start || event == Event::array_start) && depth >= kMaxDepth)
      Fail("nested deeper than " + std::to_string(kMaxDepth) + " levels");
    if (event == Event::object_start) names.emplace_back();
    if (event == Event::object_end) names.pop_back();
    if (event == Event::key && !names.back().insert(parsed.get<std::string>()).second)
      Fail(parsed.get<std::string>() + ": given twice");
    return true;
  };
  try {
    return Json::parse(text, check);
  } catch (const Json::exception& error) {
    std::string message = error.what();
    if (const auto end = message.find("] "); end != std::string::npos) message.erase(0, end + 2);
    Fail(message);
  }
}

std::string Quoted(const Json& value) {
  std::string text = JsonText(value);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

void RequireObject(const Json& value, const std::string& path, const std::string& prefix,
                   std::initializer_list<const char*> known) {
  if (!value.is_object()) Fail(path + ": " + Quoted(value) + "; allowed: an object");
  for (const auto& item : value.items()) {
    const auto matches = [&](const char* name) { return item.key() == name; };
    if (std::any_of(known.begin(), known.end(), matches)) continue;
    const char* nearest = *std::min_element(known.begin(), known.end(), [&](auto a, auto b) {
      return EditDistance(item.key().substr(0, 64), a) < EditDistance(item.key().substr(0, 64), b);
    });
    Fail(prefix + item.key().substr(0, 64) + ": unknown name; nearest: " + nearest);
  }
}

const Json& Member(const Json& object, const std::string& prefix, const char* name) {
  const auto found = object.find(name);
  if (found == object.end()) Fail(prefix + name + ": missing");
  return *found;
}

double ToNumber(const Json& value, const std::string& path) {
  if (!value.is_number()) Fail(path + ": " + Quoted(value) + "; allowed: a number");
  return value.get<double>();
}

Vector3d ToVector(const Json& value, const std::string& path) {
  if (!value.is_array() || value.size() != 3)
    Fail(path + ": " + Quoted(value) + "; allowed: an array of 3 numbers");
  Vector3d v;
  for (int k = 0; k < 3; ++k) v(k) = ToNumber(value[k], path + "[" + std::to_string(k) + "]");
  return v;
}

int ToEdges(const Json& edges) {
  const double number = edges.is_number() ? edges.get<double>() : 0.5;
  if (number != std::floor(number) || std::abs(number) > 1e6)
    Fail("cone_edges: " + Quoted(edges) + "; allowed: an integer, 3 ... 1024");
  return static_cast<int>(number);
}

/// +1 where normals point into the object, -1 where they point out of it.
double Sense(const Json& file) {
  const auto normals = file.find("normals");
  if (normals == file.end() || *normals == "inward") return 1;
  if (*normals == "outward") return -1;
  Fail("normals: " + Quoted(*normals) + "; allowed: \"inward\", \"outward\"");
}

void ReadOptions(const Json& file, EvaluateInput* input) {
  if (const auto edges = file.find("cone_edges"); edges != file.end())
    input->cone_edges = ToEdges(*edges);
  if (const auto weight = file.find("weight_n"); weight != file.end())
    input->weight = ToVector(*weight, "weight_n");
  if (const auto force = file.find("max_force_n"); force != file.end())
    input->max_force = ToNumber(*force, "max_force_n");
}

double MeanDistance(const std::vector<GraspContact>& contacts) {
  double sum = 0;
  for (const GraspContact& contact : contacts) sum += contact.position.norm();
  return contacts.empty() ? 0 : sum / static_cast<double>(contacts.size());
}

/// What `regrasp contacts --json` prints: the fingers that hold, about the sensed centre of the
/// object. Measures of its own that this format does not know are passed over.
EvaluateInput FromContacts(const Json& file) {
  EvaluateInput input;
  const Json& fingers = Member(file, "", "fingers");
  const Json& object = Member(file, "", "object");
  if (!fingers.is_object()) Fail("fingers: " + Quoted(fingers) + "; allowed: an object");
  if (!object.is_object()) Fail("object: " + Quoted(object) + "; allowed: an object");
  const Vector3d centre = ToVector(Member(object, "object.", "p_WO_m"), "object.p_WO_m");
  const double mu = ToNumber(Member(file, "", "friction"), "friction");
  const double sense = Sense(file);
  for (const auto& [name, finger] : fingers.items()) {
    const std::string prefix = "fingers." + name.substr(0, 64) + ".";
    if (!finger.is_object()) Fail(prefix + ": " + Quoted(finger) + "; allowed: an object");
    if (Member(finger, prefix, "in_contact") != true) continue;
    if (Member(finger, prefix, "role") == "free") continue;
    input.contacts.push_back(
        {ToVector(Member(finger, prefix, "p_WC_m"), prefix + "p_WC_m") - centre,
         sense * ToVector(Member(finger, prefix, "normal_W"), prefix + "normal_W"), mu});
  }
  input.torque_scale = MeanDistance(input.contacts);
  if (input.contacts.empty()) Fail("fingers: none holds the object");
  ReadOptions(file, &input);
  return input;
}

EvaluateInput FromGrasp(const Json& file) {
  RequireObject(file, "the file", "",
                {"contacts", "torque_scale_m", "cone_edges", "weight_n", "max_force_n", "normals"});
  EvaluateInput input;
  const Json& contacts = Member(file, "", "contacts");
  if (!contacts.is_array())
    Fail("contacts: " + Quoted(contacts) + "; allowed: an array of objects");
  const double sense = Sense(file);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::string path = "contacts[" + std::to_string(i) + "]";
    const std::string prefix = path + ".";
    RequireObject(contacts[i], path, prefix, {"position_m", "normal", "mu", "torsional_mu"});
    const auto torsion = contacts[i].find("torsional_mu");
    input.contacts.push_back(
        {ToVector(Member(contacts[i], prefix, "position_m"), prefix + "position_m"),
         sense * ToVector(Member(contacts[i], prefix, "normal"), prefix + "normal"),
         ToNumber(Member(contacts[i], prefix, "mu"), prefix + "mu"),
         torsion == contacts[i].end() ? 0.0 : ToNumber(*torsion, prefix + "torsional_mu")});
  }
  input.torque_scale = ToNumber(Member(file, "", "torque_scale_m"), "torque_scale_m");
  ReadOptions(file, &input);
  return input;
}

EvaluateInput ToInput(const Json& file) {
  return file.is_object() && file.contains("fingers") ? FromContacts(file) : FromGrasp(file);
}

}  // namespace

std::string EvaluateJson(const std::string& text) {
  const EvaluateInput input = ToInput(Parse(text));
  const EvaluateOutput measures = Evaluate(input);
  nlohmann::ordered_json out;
  for (const MeasureInfo& info : kMeasureTable) {
    const std::optional<double>& value = measures.of(info.id);
    out[std::string(info.name)] = value ? nlohmann::ordered_json(*value) : nullptr;
  }
  out["force_closure"] = measures.force_closure;
  if (measures.load_margin) {
    const bool bounded = std::isfinite(*measures.load_margin);
    out["load_margin_n"] = nullptr;
    if (bounded) out["load_margin_n"] = *measures.load_margin + 0.0;  // 0, not -0
    out["load_margin_unbounded"] = !bounded;
  }
  if (NormalsPointAway(input))
    out["warnings"] = {
        "every normal points away from the centre: they must point into the object, or the file "
        "say "
        "\"normals\": \"outward\""};
  return out.dump();
}

}  // namespace regrasp
