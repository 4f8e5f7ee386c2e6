#include "core/quality/evaluate_json.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <vector>

#include "core/common/nearest_name.h"
#include "core/files/json_text.h"
#include "core/files/names.h"
#include "core/files/problem_list.h"
#include "core/quality/evaluate.h"

namespace regrasp {
namespace {

using Json = nlohmann::json;

constexpr int kMaxDepth = 32;

[[noreturn]] void Fail(const std::string& message) {
  throw std::invalid_argument(ShownText(message));
}

/// Parses strictly: bounded depth, finite numbers (the parser refuses overflow); a name that is
/// given twice is a problem.
Json Parse(const std::string& text, ProblemList* problems) {
  std::vector<std::set<std::string>> names;
  const auto check = [&](int depth, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    if ((event == Event::object_start || event == Event::array_start) && depth >= kMaxDepth)
      Fail("nested deeper than " + std::to_string(kMaxDepth) + " levels");
    if (event == Event::object_start) names.emplace_back();
    if (event == Event::object_end) names.pop_back();
    if (event == Event::key && !names.back().insert(parsed.get<std::string>()).second)
      problems->Add(parsed.get<std::string>() + ": given twice");
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

double MeanDistance(const std::vector<GraspContact>& contacts) {
  double sum = 0;
  for (const GraspContact& contact : contacts) sum += contact.position.norm();
  return contacts.empty() ? 0 : sum / static_cast<double>(contacts.size());
}

/// Numbers and names out of JSON. What is wrong with one is gathered, and in its place stands
/// `otherwise`, a value that is in range, so that nothing is blamed twice. `path` and `prefix`:
/// what messages call a value, and what stands before the name of a member.
class FieldReader {
 public:
  explicit FieldReader(ProblemList* problems) : problems_(problems) {}

  void Refuse(const std::string& path, const Json& value, const char* allowed) {
    problems_->Add(path + ": " + Quoted(value) + "; allowed: " + allowed);
  }

  bool IsObject(const Json& value, const std::string& path) {
    if (!value.is_object()) Refuse(path, value, "an object");
    return value.is_object();
  }

  void CheckNames(const Json& object, const std::string& prefix,
                  std::initializer_list<const char*> known) {
    for (const auto& item : object.items()) {
      const std::string name = item.key().substr(0, 64);
      if (std::ranges::find(known, item.key()) != known.end()) continue;
      const char* nearest = *std::ranges::min_element(
          known, {}, [&](const char* one) { return EditDistance(name, one); });
      problems_->Add(prefix + name + ": unknown name; nearest: " + nearest);
    }
  }

  /// Null, and a problem, where it is missing.
  const Json* Member(const Json& object, const std::string& prefix, const char* name) {
    const auto found = object.find(name);
    if (found != object.end()) return &*found;
    problems_->Add(prefix + name + ": missing");
    return nullptr;
  }

  double Number(const Json& value, const std::string& path, double otherwise) {
    if (value.is_number()) return value.get<double>();
    Refuse(path, value, "a number");
    return otherwise;
  }
  double Number(const Json& object, const std::string& prefix, const char* name, double otherwise) {
    const Json* value = Member(object, prefix, name);
    return value ? Number(*value, prefix + name, otherwise) : otherwise;
  }

  Vector3d Vector(const Json& value, const std::string& path, const Vector3d& otherwise) {
    if (!value.is_array() || value.size() != 3) {
      Refuse(path, value, "an array of 3 numbers");
      return otherwise;
    }
    Vector3d v;
    bool numbers = true;
    for (int k = 0; k < 3; ++k) {
      v(k) = Number(value[k], path + "[" + std::to_string(k) + "]", 0);
      numbers &= value[k].is_number();
    }
    return numbers ? v : otherwise;
  }
  Vector3d Vector(const Json& object, const std::string& prefix, const char* name,
                  const Vector3d& otherwise) {
    const Json* value = Member(object, prefix, name);
    return value ? Vector(*value, prefix + name, otherwise) : otherwise;
  }

 private:
  ProblemList* problems_;
};

const GraspContact kHarmless;  // stands where none can be read
constexpr double kHarmlessScale = 1;

/// +1 where normals point into the object, -1 where they point out of it.
double Sense(const Json& file, FieldReader* fields) {
  const auto normals = file.find("normals");
  if (normals == file.end() || *normals == "inward") return 1;
  if (*normals == "outward") return -1;
  fields->Refuse("normals", *normals, "\"inward\", \"outward\"");
  return 1;
}

int Edges(const Json& edges, FieldReader* fields) {
  const double number = edges.is_number() ? edges.get<double>() : 0.5;
  if (number == std::floor(number) && std::abs(number) <= 1e6) return static_cast<int>(number);
  fields->Refuse("cone_edges", edges, "an integer, 3 ... 1024");
  return EvaluateInput().cone_edges;
}

/// What both formats may have.
void ReadOptions(const Json& file, FieldReader* fields, EvaluateInput* input) {
  if (const auto edges = file.find("cone_edges"); edges != file.end())
    input->cone_edges = Edges(*edges, fields);
  if (const auto weight = file.find("weight_n"); weight != file.end())
    input->weight = fields->Vector(*weight, "weight_n", Vector3d::Zero());
  if (const auto force = file.find("max_force_n"); force != file.end())
    input->max_force = fields->Number(*force, "max_force_n", input->max_force);
}

/// A finger of `regrasp contacts --json` holds the object where it touches and is not free.
bool Holds(const Json& finger, const std::string& prefix, FieldReader* fields) {
  const Json* touches = fields->Member(finger, prefix, "in_contact");
  if (!touches || *touches != true) return false;
  const Json* role = fields->Member(finger, prefix, "role");
  return role && *role != "free";
}

/// What `regrasp contacts --json` prints: the fingers that hold, about the sensed centre of the
/// object. Measures of its own that this format does not know are passed over.
EvaluateInput FromContacts(const Json& file, ProblemList* problems, EvaluateNames* names) {
  FieldReader fields(problems);
  EvaluateInput input;
  Vector3d centre = Vector3d::Zero();
  if (const Json* object = fields.Member(file, "", "object");
      object && fields.IsObject(*object, "object"))
    centre = fields.Vector(*object, "object.", "p_WO_m", centre);
  const double mu = fields.Number(file, "", "friction", kHarmless.mu);
  const double sense = Sense(file, &fields);
  const Json& fingers = file["fingers"];
  names->torque_scale = "mean distance of p_WC_m from object.p_WO_m";
  const std::size_t before = problems->count();
  if (fields.IsObject(fingers, "fingers"))
    for (const auto& [name, finger] : fingers.items()) {
      const std::string path = "fingers." + name.substr(0, 64), prefix = path + ".";
      if (!fields.IsObject(finger, path) || !Holds(finger, prefix, &fields)) continue;
      input.contacts.push_back(
          {fields.Vector(finger, prefix, "p_WC_m", centre) - centre,
           sense * fields.Vector(finger, prefix, "normal_W", kHarmless.inward_normal), mu});
      // What all share is judged for each, and told once.
      names->contacts.push_back({prefix + "p_WC_m less object.p_WO_m", prefix + "normal_W",
                                 "friction", prefix + "torsional_mu"});
    }
  if (input.contacts.empty() && problems->count() == before)
    problems->Add("fingers: none holds the object");
  ReadOptions(file, &fields, &input);
  input.torque_scale = problems->empty() ? MeanDistance(input.contacts) : kHarmlessScale;
  if (input.contacts.empty()) input.contacts.push_back(kHarmless);
  return input;
}

GraspContact ReadContact(const Json& contact, const std::string& path, double sense,
                         FieldReader* fields) {
  if (!fields->IsObject(contact, path)) return kHarmless;
  const std::string prefix = path + ".";
  fields->CheckNames(contact, prefix, {"position_m", "normal", "mu", "torsional_mu"});
  const auto torsion = contact.find("torsional_mu");
  return {fields->Vector(contact, prefix, "position_m", kHarmless.position),
          sense * fields->Vector(contact, prefix, "normal", kHarmless.inward_normal),
          fields->Number(contact, prefix, "mu", kHarmless.mu),
          torsion == contact.end() ? 0.0 : fields->Number(*torsion, prefix + "torsional_mu", 0.0)};
}

/// A grasp file (evaluate_json.h).
EvaluateInput FromGrasp(const Json& file, ProblemList* problems) {
  FieldReader fields(problems);
  EvaluateInput input;
  input.contacts = {kHarmless};
  input.torque_scale = kHarmlessScale;
  if (!fields.IsObject(file, "the file")) return input;
  fields.CheckNames(
      file, "", {"contacts", "torque_scale_m", "cone_edges", "weight_n", "max_force_n", "normals"});
  const double sense = Sense(file, &fields);
  const Json* contacts = fields.Member(file, "", "contacts");
  if (contacts && !contacts->is_array()) {
    fields.Refuse("contacts", *contacts, "an array of objects");
  } else if (contacts) {
    input.contacts.clear();
    for (std::size_t i = 0; i < contacts->size(); ++i)
      input.contacts.push_back(
          ReadContact((*contacts)[i], "contacts[" + std::to_string(i) + "]", sense, &fields));
  }
  input.torque_scale = fields.Number(file, "", "torque_scale_m", kHarmlessScale);
  ReadOptions(file, &fields, &input);
  return input;
}

EvaluateInput ToInput(const std::string& text) {
  ProblemList problems;
  const Json file = Parse(text, &problems);
  EvaluateNames names;  // what the file calls what is read
  const bool from_contacts = file.is_object() && file.contains("fingers");
  const EvaluateInput input =
      from_contacts ? FromContacts(file, &problems, &names) : FromGrasp(file, &problems);
  for (const std::string& fault : Faults(input, names)) problems.Add(fault);
  if (!problems.empty()) throw std::invalid_argument(problems.Text());
  return input;
}

}  // namespace

std::string EvaluateJson(const std::string& text) {
  const EvaluateInput input = ToInput(text);
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
