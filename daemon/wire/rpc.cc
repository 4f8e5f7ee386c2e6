#include "daemon/wire/rpc.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>

#include "core/common/nearest_name.h"
#include "core/common/nesting_depth.h"
#include "core/files/json_text.h"
#include "core/protocol/methods.h"

namespace regrasp {
namespace {

/// Parses, and finds the first key that an object holds twice (the library keeps the last,
/// silently).
JsonIn Parse(std::string_view text, std::optional<std::string>* duplicate) {
  std::vector<std::set<std::string>> open;
  const auto watch = [&](int, JsonIn::parse_event_t event, JsonIn& value) {
    switch (event) {
      case JsonIn::parse_event_t::object_start:
        open.emplace_back();
        break;
      case JsonIn::parse_event_t::object_end:
        open.pop_back();
        break;
      case JsonIn::parse_event_t::key:
        if (!open.back().insert(value.get<std::string>()).second && !*duplicate)
          *duplicate = value.get<std::string>();
        break;
      default:
        break;
    }
    return true;
  };
  return JsonIn::parse(text.begin(), text.end(), watch);
}

/// The library's message without its tag: "[json.exception.parse_error.101] parse error at ...".
std::string Cause(const std::exception& e) {
  std::string text = e.what();
  if (const auto end = text.find("] "); text.starts_with('[') && end != std::string::npos)
    text.erase(0, end + 2);
  return text.substr(0, 300);
}

RpcRequest Refused(ErrorCode code, std::string message, std::string hint,
                   std::optional<RequestId> id = {}) {
  RpcRequest request;
  request.id = std::move(id);
  request.error = RpcError{code, std::move(message), std::move(hint), {}, {}};
  return request;
}

/// The id, or nothing when it is missing or not one we accept.
std::optional<RequestId> ReadId(const JsonIn& message) {
  const auto it = message.find("id");
  if (it == message.end()) return {};
  if (it->is_string() && it->get_ref<const std::string&>().size() <= kMaxIdBytes)
    return it->get<std::string>();
  constexpr auto kMax = static_cast<std::int64_t>(kMaxSafeInteger);
  if (it->is_number_unsigned() && it->get<std::uint64_t>() > static_cast<std::uint64_t>(kMax))
    return {};
  if (it->is_number_integer()) {
    const auto value = it->get<std::int64_t>();
    return value >= -kMax && value <= kMax ? std::optional<RequestId>(value) : std::nullopt;
  }
  if (it->is_number_float()) {
    const double value = it->get<double>();
    if (std::abs(value) <= kMaxSafeInteger && value == std::floor(value))
      return static_cast<std::int64_t>(value);
  }
  return {};
}

RpcRequest ReadRequest(const JsonIn& message) {
  constexpr std::array<std::string_view, 4> kMembers = {"jsonrpc", "id", "method", "params"};
  const auto invalid = [&](std::string text, std::string hint) {
    return Refused(ErrorCode::kInvalidRequest, std::move(text), std::move(hint),
                   message.is_object() ? ReadId(message) : std::nullopt);
  };
  if (!message.is_object())
    return invalid(fmt::format("a request is an object, not {}", message.type_name()),
                   R"(send {"jsonrpc":"2.0","id":1,"method":"status"})");
  for (const auto& [key, value] : message.items()) {
    if (std::ranges::find(kMembers, key) != kMembers.end()) continue;
    const std::string near = DidYouMean(key, kMembers);
    return invalid(fmt::format("unknown member '{}'", key.substr(0, 64)),
                   near.empty() ? "a request has jsonrpc, id, method and params" : near);
  }
  if (message.value("jsonrpc", JsonIn()) != "2.0")
    return invalid("jsonrpc is not \"2.0\"", R"(add "jsonrpc":"2.0")");

  RpcRequest request;
  request.id = ReadId(message);
  if (message.contains("id") && !request.id)
    return invalid("id is neither a string of at most 64 bytes nor an integer within 2^53",
                   "leave id out to send a notification");
  const auto method = message.find("method");
  if (method == message.end() || !method->is_string())
    return invalid("method is missing or not a string", "call describe for the methods");
  request.method = method->get<std::string>();
  if (const auto params = message.find("params"); params != message.end()) {
    if (params->is_object()) {
      request.params = *params;
    } else if (!params->is_array() || !params->empty()) {
      request.error = RpcError{ErrorCode::kInvalidParams,
                               "params is not an object",
                               "parameters are given by name",
                               {},
                               {}};
    }
  }
  return request;
}

}  // namespace

RpcLine ParseLine(std::string_view line) {
  RpcLine result;
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.find_first_not_of(" \t\r") == std::string_view::npos) return result;
  const auto refuse = [&](ErrorCode code, std::string message, std::string hint) {
    result.requests.push_back(Refused(code, std::move(message), std::move(hint)));
    return result;
  };
  if (line.size() > kMaxRequestBytes)
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("request line of more than {} bytes", kMaxRequestBytes),
                  "send less per line");
  if (const auto nul = line.find('\0'); nul != std::string_view::npos)
    return refuse(ErrorCode::kParse, fmt::format("a NUL byte at position {}", nul),
                  "send one JSON object per line, in UTF-8");
  if (const int depth = NestingDepth(line); depth > kMaxRequestDepth)
    return refuse(ErrorCode::kInvalidRequest,
                  fmt::format("nested {} levels deep; at most {}", depth, kMaxRequestDepth),
                  "no method takes deeply nested parameters");

  std::optional<std::string> duplicate;
  JsonIn document;
  try {
    document = Parse(line, &duplicate);
  } catch (const std::bad_alloc&) {
    throw;  // the line is not at fault
  } catch (const std::exception& e) {
    return refuse(ErrorCode::kParse, Cause(e), "send one JSON object per line, in UTF-8");
  }
  if (duplicate) {
    result.requests.push_back(
        Refused(ErrorCode::kInvalidRequest,
                fmt::format("duplicate key '{}'", duplicate->substr(0, 64)), "give every key once",
                document.is_object() && *duplicate != "id" ? ReadId(document) : std::nullopt));
    return result;
  }
  if (!document.is_array()) {
    result.requests.push_back(ReadRequest(document));
    return result;
  }
  if (document.empty() || document.size() > kMaxBatch)
    return refuse(
        ErrorCode::kInvalidRequest,
        fmt::format("batch of {} requests; allowed are 1 to {}", document.size(), kMaxBatch),
        "split the batch");
  result.batch = true;
  for (const JsonIn& message : document) result.requests.push_back(ReadRequest(message));
  return result;
}

namespace {

Json IdJson(const std::optional<RequestId>& id) {
  if (!id) return nullptr;
  return std::visit([](const auto& value) { return Json(value); }, *id);
}

Json ErrorJson(const RpcError& error) {
  Json data = Json::object();
  if (!error.hint.empty()) data["hint"] = error.hint;
  if (!error.param.empty()) data["param"] = error.param;
  if (!error.allowed.empty()) data["allowed"] = error.allowed;
  for (const RpcError& one : error.errors) data["errors"].push_back(ErrorJson(one));
  if (error.more > 0) data["more"] = error.more;
  return {{"code", static_cast<int>(error.code)}, {"message", error.message}, {"data", data}};
}

}  // namespace

RpcError InternalError(const std::exception& e) {
  return {ErrorCode::kInternal, e.what(), "report this as a defect of regraspd", {}, {}};
}

std::string ResultText(const std::optional<RequestId>& id, std::string_view result) {
  const auto* number = id ? std::get_if<std::int64_t>(&*id) : nullptr;
  return fmt::format(R"({{"jsonrpc":"2.0","id":{},"result":{}}})",
                     number ? std::to_string(*number) : ToText(IdJson(id)), result);
}

Json ErrorMessage(const std::optional<RequestId>& id, const RpcError& error) {
  return {{"jsonrpc", "2.0"}, {"id", IdJson(id)}, {"error", ErrorJson(error)}};
}

std::string ToText(const Json& message) { return JsonText(message); }

std::string ToLine(const Json& message) { return ToText(message) + '\n'; }

}  // namespace regrasp
